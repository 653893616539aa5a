// SPDX-License-Identifier: MIT
//! Rays, shapes, pairs and contacts.
use crate::error::{check, slice};
use crate::{
    sys, CastOptions, ContactPoint, Motion, Obb, Object, ObjectRef, Part, Placed, Ray, Result, ShapeContact, World,
    ALL_LAYERS,
};
use std::{mem::size_of, ptr};

const NONE: u32 = u32::MAX;

/// Where a ray hits an object.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectHit {
    /// The object.
    pub object: Object,
    /// The object's user number.
    pub user: u64,
    /// The parameter along the ray.
    pub t: f64,
    /// In world coordinates.
    pub point: [f64; 3],
    triangle: u32,
    /// The child of a compound shape; else 0.
    pub child: u32,
    /// The surface's unit normal, towards the ray's origin; 0 if the ray began inside.
    pub normal: [f64; 3],
    started_inside: u8,
}

impl ObjectHit {
    /// True if the ray began in the shape, box or sphere; `t` is then 0.
    pub fn started_inside(&self) -> bool {
        self.started_inside != 0
    }
    /// The triangle of the object's mesh or its shape's surface.
    pub fn triangle(&self) -> Option<u32> {
        (self.triangle != NONE).then_some(self.triangle)
    }
}

/// The shape of a query, in world coordinates.
#[derive(Debug, Clone, Copy)]
pub enum QueryShape<'a> {
    /// An oriented box.
    Box(Obb),
    /// A sphere.
    Sphere {
        /// The center.
        center: [f64; 3],
        /// At least 0.
        radius: f64,
    },
    /// All points no farther than `radius` from a segment.
    Capsule {
        /// One end of the segment.
        begin: [f64; 3],
        /// The other end.
        end: [f64; 3],
        /// At least 0.
        radius: f64,
    },
    /// Any shape but a half-space.
    Shape(Placed<'a>),
}

impl QueryShape<'_> {
    fn raw(&self) -> sys::QueryShape {
        let mut raw: sys::QueryShape = unsafe { std::mem::zeroed() };
        match self {
            &QueryShape::Box(b) => {
                raw.kind = sys::QUERY_SHAPE_BOX;
                raw.bounding_box = b;
            }
            &QueryShape::Sphere { center, radius } => {
                raw.kind = sys::QUERY_SHAPE_SPHERE;
                raw.begin = center;
                raw.radius = radius;
            }
            &QueryShape::Capsule { begin, end, radius } => {
                raw.kind = sys::QUERY_SHAPE_CAPSULE;
                raw.begin = begin;
                raw.end = end;
                raw.radius = radius;
            }
            QueryShape::Shape(placed) => (raw.kind, raw.shape) = (sys::QUERY_SHAPE_SHAPE, placed.raw()),
        }
        raw
    }
}

/// The object nearest to a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// The object.
    pub object: Object,
    /// The object's user number.
    pub user: u64,
    /// 0 if they overlap.
    pub distance: f64,
    /// The nearest point of the shape.
    pub on_shape: [f64; 3],
    /// The nearest point of the object.
    pub on_object: [f64; 3],
    /// The triangle there, of the object's mesh or its shape's surface; `u32::MAX` where there is none.
    pub triangle: u32,
    /// The child there, of a compound shape; else 0.
    pub child: u32,
}

/// Two objects whose boxes or spheres overlap.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObjectPair {
    /// The one with the lower index.
    pub first: ObjectRef,
    /// The other.
    pub second: ObjectRef,
}

/// The phase of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Began in this update.
    Began,
    /// Began in an earlier update.
    Stayed,
    /// Ended in this update.
    Ended,
}

/// Which of two objects lies inside the other, if their surfaces do not overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Containment {
    /// Neither, or the surfaces overlap.
    Nothing,
    /// The first lies inside the second.
    FirstInside,
    /// The second lies inside the first.
    SecondInside,
    /// Some pieces of a mesh are inside, but not all.
    Partly,
}

/// The contact of two triangles.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshContact {
    /// The triangle of the first mesh.
    pub first_triangle: u32,
    /// The triangle of the second mesh.
    pub second_triangle: u32,
    /// One end of their common segment.
    pub begin: [f64; 3],
    /// The other end.
    pub end: [f64; 3],
    /// The unit normal of the second mesh's triangle.
    pub normal: [f64; 3],
}

/// A vertex, an edge or a face of a shape.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feature {
    /// 0: a vertex, 1: an edge, 2: a face.
    pub kind: u8,
    unused: u8,
    /// Its number in the shape.
    pub index: u16,
}

/// A contact point of two shapes, for a physics engine. Features and parts are its id, which stays the same while the same
/// features touch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackedPoint {
    /// Midway between the surfaces, in the world.
    pub position: [f64; 3],
    /// Along the normal; negative: a gap.
    pub depth: f64,
    /// On the first shape.
    pub on_a: Feature,
    /// On the second.
    pub on_b: Feature,
    /// Of the first shape.
    pub part_a: Part,
    /// Of the second.
    pub part_b: Part,
    /// Unit, from first to second.
    pub normal: [f64; 3],
    began: u8,
    unused: [u8; 3],
    /// Yours: 0 when the point begins, kept while it stays. [`World::visit_shape_points`] lets you write it.
    pub memory: [f32; 4],
}

impl TrackedPoint {
    /// True if no point of the last update has its id.
    pub fn began(&self) -> bool {
        self.began != 0
    }
}

/// The first object that a moving shape meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeHit {
    /// The object.
    pub object: Object,
    /// The object's user number.
    pub user: u64,
    /// When they are within the tolerance and about to touch.
    pub time: f64,
    /// Unit, from the shape to the object.
    pub normal: [f64; 3],
    /// On the object's surface.
    pub point: [f64; 3],
    /// The triangle of the object's mesh or its shape's surface; `u32::MAX` where there is none.
    pub triangle: u32,
    /// The child of a compound shape; else 0.
    pub child: u32,
    /// The gap at that time; negative: how deep they overlap, from the start.
    pub distance: f64,
    /// True if [`CastOptions::max_steps`] was too small: the shape meets nothing before `time`.
    pub unresolved: bool,
}

/// Where a shape touches an object, in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectManifold {
    /// The object.
    pub object: Object,
    /// The object's user number.
    pub user: u64,
    /// Its normal leads from the shape to the object.
    pub contact: ShapeContact,
}

/// Two objects that touch, or that have ended touching in this update.
#[derive(Debug, Clone, Copy)]
pub struct Contact<'a> {
    /// The one with the lower index.
    pub first: ObjectRef,
    /// The other.
    pub second: ObjectRef,
    /// Whether the contact began, stayed or ended.
    pub phase: Phase,
    /// Whether one object is inside the other.
    pub inside: Containment,
    /// Unit, from first to second; 0 if no direction is known.
    pub normal: [f64; 3],
    /// Moving the second by `depth * normal` ends the contact; between meshes it is the deepest point's depth
    /// unless [`WorldOptions::mesh_depth`](crate::WorldOptions) is set.
    pub depth: f64,
    /// At most four.
    pub points: &'a [ContactPoint],
    /// The contacts of triangles, for two meshes, or for a mesh and a box.
    pub triangles: &'a [MeshContact],
    /// For two shapes.
    pub shape_points: &'a [TrackedPoint],
}

/// A list of objects or hits that keeps its memory; reuse it from frame to frame.
pub struct Found {
    raw: *mut sys::Found,
}

unsafe impl Send for Found {}
unsafe impl Sync for Found {}

impl Found {
    /// Returns an empty list.
    pub fn new() -> Result<Found> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_found_create(&mut raw) })?;
        Ok(Found { raw })
    }
}

impl Drop for Found {
    fn drop(&mut self) {
        unsafe { sys::crofton_found_destroy(self.raw) };
    }
}

/// Limits rays, overlaps, nearest objects and casts to some of the objects. A layer mask converts to one.
#[derive(Debug, Clone, Copy)]
pub struct QueryFilter<'a> {
    /// Finds objects that share a layer with this mask; all.
    pub layers: u32,
    /// Finds none of these, for example the object that asks and what it carries. Pass a few, and use layers for many.
    pub ignored: &'a [Object],
}

impl Default for QueryFilter<'_> {
    fn default() -> Self {
        ALL_LAYERS.into()
    }
}

impl From<u32> for QueryFilter<'_> {
    fn from(layers: u32) -> Self {
        QueryFilter { layers, ignored: &[] }
    }
}

impl QueryFilter<'_> {
    fn raw(&self) -> sys::QueryFilter {
        sys::QueryFilter {
            size: size_of::<sys::QueryFilter>(),
            layers: self.layers,
            ignored: self.ignored.as_ptr(),
            ignored_count: self.ignored.len(),
        }
    }
}

impl World {
    /// Returns the nearest hit of the objects that the filter accepts: shapes, triangles of meshes, boxes and spheres.
    pub fn raycast<'f>(&self, ray: &Ray, filter: impl Into<QueryFilter<'f>>) -> Result<Option<ObjectHit>> {
        Ok(self.raycasts(std::slice::from_ref(ray), filter)?.pop().flatten())
    }

    /// Returns the nearest hit of each ray.
    pub fn raycasts<'f>(&self, rays: &[Ray], filter: impl Into<QueryFilter<'f>>) -> Result<Vec<Option<ObjectHit>>> {
        let mut hits = vec![no_hit(); rays.len()];
        check(unsafe {
            sys::crofton_world_raycast(self.raw, rays.as_ptr(), rays.len(), &filter.into().raw(), hits.as_mut_ptr())
        })?;
        Ok(hits.into_iter().map(|hit| (hit.object.index != NONE).then_some(hit)).collect())
    }

    /// Tests whether the ray hits anything; faster than [`World::raycast`].
    pub fn raycast_any<'f>(&self, ray: &Ray, filter: impl Into<QueryFilter<'f>>) -> Result<bool> {
        let mut hit = 0;
        check(unsafe { sys::crofton_world_raycast_any(self.raw, ray, &filter.into().raw(), &mut hit) })?;
        Ok(hit != 0)
    }

    /// Lists the nearest hit of each object that the ray hits, in order of t, then of index.
    pub fn raycast_all<'a, 'f>(
        &self, ray: &Ray, filter: impl Into<QueryFilter<'f>>, found: &'a mut Found,
    ) -> Result<&'a [ObjectHit]> {
        let (mut hits, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_world_raycast_all(self.raw, ray, &filter.into().raw(), found.raw) })?;
        check(unsafe { sys::crofton_found_hits(found.raw, &mut hits, &mut count) })?;
        Ok(unsafe { slice(hits, count) })
    }

    /// The objects that overlap the shape, by index: their shapes, triangles, spheres or boxes.
    pub fn overlap<'a, 'f>(
        &self, shape: &QueryShape, filter: impl Into<QueryFilter<'f>>, found: &'a mut Found,
    ) -> Result<&'a [ObjectRef]> {
        check(unsafe { sys::crofton_world_overlap(self.raw, &shape.raw(), &filter.into().raw(), found.raw) })?;
        let (mut objects, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_found_objects(found.raw, &mut objects, &mut count) })?;
        Ok(unsafe { slice(objects, count) })
    }

    /// The object nearest to the shape, no farther than `max_distance`, which may be infinite.
    pub fn closest<'f>(
        &self, shape: &QueryShape, max_distance: f64, filter: impl Into<QueryFilter<'f>>,
    ) -> Result<Option<Closest>> {
        let mut c: sys::ClosestObject = unsafe { std::mem::zeroed() };
        c.size = size_of::<sys::ClosestObject>();
        check(unsafe {
            sys::crofton_world_closest(self.raw, &shape.raw(), max_distance, &filter.into().raw(), &mut c)
        })?;
        let (object, user, distance) = (c.object, c.user, c.distance);
        let (on_shape, on_object, triangle, child) = (c.on_shape, c.on_object, c.triangle, c.child);
        let closest = Closest { object, user, distance, on_shape, on_object, triangle, child };
        Ok((object.index != NONE).then_some(closest))
    }

    /// Returns the pairs of objects whose boxes or spheres overlap, in order.
    ///
    /// ```compile_fail
    /// # let mut world = crofton::World::new().unwrap();
    /// let pairs = world.pairs().unwrap();
    /// world.update().unwrap(); // the pairs are the world's
    /// assert!(pairs.is_empty());
    /// ```
    pub fn pairs(&self) -> Result<&[ObjectPair]> {
        let (mut pairs, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_world_pairs(self.raw, &mut pairs, &mut count) })?;
        Ok(unsafe { slice(pairs, count) })
    }

    /// Returns the contacts, and those that have ended, in the order of the pairs.
    pub fn contacts(&self) -> Result<Vec<Contact<'_>>> {
        Ok(self.raw_contacts()?.iter().map(|c| contact(c)).collect())
    }
    fn raw_contacts(&self) -> Result<&[sys::ObjectContact]> {
        let (mut contacts, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_world_contacts(self.raw, &mut contacts, &mut count) })?;
        Ok(unsafe { slice(contacts, count) })
    }
    /// Visits the contact points of all pairs of shapes, with their memory to write, such as impulses for a warm start.
    pub fn visit_shape_points(
        &mut self, mut visit: impl FnMut(ObjectRef, ObjectRef, &TrackedPoint, &mut [f32; 4]),
    ) -> Result<()> {
        for c in self.raw_contacts()? {
            for i in 0..c.shape_point_count {
                // The world is borrowed mutably, so nothing else reads the point.
                let (point, memory) = unsafe { (*c.shape_points.add(i), &mut (*c.shape_points.add(i)).memory) };
                visit(c.first, c.second, &point, memory);
            }
        }
        Ok(())
    }

    /// Finds the first object that a moving shape meets; the objects are at rest. A shape inside a closed mesh meets it from
    /// inside.
    pub fn cast<'f>(
        &self, shape: &Placed, motion: &Motion, options: &CastOptions, filter: impl Into<QueryFilter<'f>>,
    ) -> Result<Option<ShapeHit>> {
        let mut h: sys::ShapeHit = unsafe { std::mem::zeroed() };
        h.size = size_of::<sys::ShapeHit>();
        check(unsafe {
            sys::crofton_world_cast(self.raw, &shape.raw(), motion, &options.raw(), &filter.into().raw(), &mut h)
        })?;
        Ok((h.object.index != NONE).then(|| shape_hit(&h)))
    }
    /// Lists the first hit of each object that a moving shape meets, in order of time, then of index.
    pub fn cast_all<'f>(
        &self, shape: &Placed, motion: &Motion, options: &CastOptions, filter: impl Into<QueryFilter<'f>>,
    ) -> Result<Vec<ShapeHit>> {
        let found = Found::new()?;
        let (mut hits, mut count) = (ptr::null(), 0);
        let filter = filter.into();
        check(unsafe {
            sys::crofton_world_cast_all(self.raw, &shape.raw(), motion, &options.raw(), &filter.raw(), found.raw)
        })?;
        check(unsafe { sys::crofton_found_shape_hits(found.raw, &mut hits, &mut count) })?;
        Ok(unsafe { slice(hits, count) }.iter().map(shape_hit).collect())
    }
    /// Lists where a shape, which need not be an object, touches the objects, up to a margin, in order of index: up to
    /// `max_points` points a direction, at most 8.
    pub fn contact_manifolds<'f>(
        &self, shape: &Placed, margin: f64, max_points: u32, filter: impl Into<QueryFilter<'f>>,
    ) -> Result<Vec<ObjectManifold>> {
        let options = sys::ManifoldOptions { size: size_of::<sys::ManifoldOptions>(), margin, max_points };
        let found = Found::new()?;
        let (mut manifolds, mut count) = (ptr::null(), 0);
        let filter = filter.into();
        check(unsafe { sys::crofton_world_manifolds(self.raw, &shape.raw(), &options, &filter.raw(), found.raw) })?;
        check(unsafe { sys::crofton_found_manifolds(found.raw, &mut manifolds, &mut count) })?;
        Ok(unsafe { slice(manifolds, count) }
            .iter()
            .map(|m: &sys::ObjectManifold| ObjectManifold {
                object: m.object,
                user: m.user,
                contact: ShapeContact {
                    normal: m.normal,
                    depth: m.depth,
                    points: m.points[..m.point_count as usize].to_vec(),
                },
            })
            .collect())
    }
}

fn shape_hit(h: &sys::ShapeHit) -> ShapeHit {
    ShapeHit {
        object: h.object,
        user: h.user,
        time: h.time,
        normal: h.normal,
        point: h.point,
        triangle: h.triangle,
        child: h.child,
        distance: h.distance,
        unresolved: h.result == sys::CAST_UNRESOLVED,
    }
}

// The arrays are the world's: they live until its next change.
fn contact<'a>(c: &sys::ObjectContact) -> Contact<'a> {
    Contact {
        first: c.first,
        second: c.second,
        phase: [Phase::Began, Phase::Stayed, Phase::Ended][c.phase.min(2) as usize],
        inside: match c.inside {
            1 => Containment::FirstInside,
            2 => Containment::SecondInside,
            3 => Containment::Partly,
            _ => Containment::Nothing,
        },
        normal: c.normal,
        depth: c.depth,
        points: unsafe { slice(c.points, c.point_count) },
        triangles: unsafe { slice(c.triangles, c.triangle_count) },
        shape_points: unsafe { slice(c.shape_points, c.shape_point_count) },
    }
}

fn no_hit() -> ObjectHit {
    ObjectHit {
        object: Object { index: NONE, generation: 0 },
        user: 0,
        t: 0.0,
        point: [0.0; 3],
        triangle: NONE,
        child: 0,
        normal: [0.0; 3],
        started_inside: 0,
    }
}
