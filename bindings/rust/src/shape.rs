// SPDX-License-Identifier: MIT
//! Shapes, convex or of convex parts: by themselves, on objects, and as probes of a World.
use crate::error::check;
use crate::{sys, Feature, Ray, Result, Separation, Transform};
use std::{mem::size_of, ptr};

/// A solid or a surface. It never changes; what uses it keeps what it needs of it. Solids of revolution have y as axis,
/// with the origin half way up.
///
/// ```
/// use crofton::{CastOptions, Description, Motion, Shape, Transform, World, ALL_LAYERS};
/// # fn main() -> Result<(), crofton::Error> {
/// let (floor, ball) = (Shape::half_space([0.0, -1.0, 0.0], 0.0)?, Shape::sphere(0.5)?);
/// let mut world = World::new()?;
/// world.add(&Description::shape(&floor).user(1))?;
/// world.update()?;
/// let fall = Motion { velocity: [0.0, -1.0, 0.0], ..Default::default() };
/// let options = CastOptions { duration: 10.0, ..Default::default() };
/// let hit = world.cast(&ball.at(Transform::at([0.0, 3.0, 0.0])), &fall, &options, ALL_LAYERS)?.unwrap();
/// assert!((hit.time - 2.5).abs() < 1e-5);
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Shape {
    pub(crate) raw: *mut sys::Shape,
}

// A shape never changes.
unsafe impl Send for Shape {}
unsafe impl Sync for Shape {}

impl Drop for Shape {
    fn drop(&mut self) {
        unsafe { sys::crofton_shape_destroy(self.raw) };
    }
}

/// A shape at a pose: a rotation and a translation.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Where it is.
    pub pose: Transform,
}

/// A grid of heights: corner (i, j) is at `(i * spacing[0], heights[j * columns + i], j * spacing[1])`.
#[derive(Debug, Clone, Copy)]
pub struct HeightField<'a> {
    /// Corners along x, 2 to 32,768.
    pub columns: u32,
    /// `columns` for each of the rows along z.
    pub heights: &'a [f32],
    /// Of the cells, row by row; 255 is a hole; empty: all 0.
    pub materials: &'a [u8],
    /// Between corners, along x and along z.
    pub spacing: [f64; 2],
}

/// A convex part of a shape.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// The child of a compound.
    pub child: u32,
    /// The triangle of a mesh or a height field.
    pub triangle: u32,
}

/// Mass properties for density 1, in the shape's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// The volume.
    pub volume: f64,
    /// The center of mass.
    pub center: [f64; 3],
    /// About the center of mass, symmetric.
    pub inertia: [f64; 9],
}

/// How deep two shapes overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penetration {
    /// Moving the second by `depth * normal` ends the overlap.
    pub depth: f64,
    /// Unit, from the first to the second.
    pub normal: [f64; 3],
}

/// A contact point of two shapes. Features and parts stay the same while the same features touch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapePoint {
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
}

/// Where two shapes touch: their deepest contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeContact {
    /// Unit, from the first to the second.
    pub normal: [f64; 3],
    /// Of the deepest point.
    pub depth: f64,
    /// None if the shapes are farther apart than the margin.
    pub points: Vec<ShapePoint>,
}

/// The point of a shape that is nearest to another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// 0 inside a solid.
    pub distance: f64,
    /// Of the shape.
    pub point: [f64; 3],
    /// The part that it lies on.
    pub part: Part,
}

/// A motion: `pivot`, in the shape's frame, moves by `velocity * t`, and the shape turns about it by `|spin| * t` radians
/// around `spin`, in world axes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Units of length a unit of time.
    pub velocity: [f64; 3],
    /// Radians a unit of time.
    pub spin: [f64; 3],
    /// The point about which the shape turns.
    pub pivot: [f64; 3],
}

/// Options of a cast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CastOptions {
    /// 1; at least 0.
    pub duration: f64,
    /// How far apart the shapes may still be at the time of a hit; 0: 1e-6.
    pub tolerance: f64,
    /// 0: 500.
    pub max_steps: u32,
    /// Skips what overlaps, or is within the tolerance, at time 0.
    pub ignore_initial_overlaps: bool,
}

impl Default for CastOptions {
    fn default() -> CastOptions {
        CastOptions { duration: 1.0, tolerance: 0.0, max_steps: 0, ignore_initial_overlaps: false }
    }
}

impl CastOptions {
    pub(crate) fn raw(&self) -> sys::CastOptions {
        sys::CastOptions {
            size: size_of::<sys::CastOptions>(),
            duration: self.duration,
            tolerance: self.tolerance,
            max_steps: self.max_steps,
            ignore_initial_overlaps: self.ignore_initial_overlaps as u32,
        }
    }
}

/// When and where two moving shapes meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// When they are within the tolerance and about to touch.
    pub time: f64,
    /// The gap then; negative: how deep they overlap, from the start.
    pub distance: f64,
    /// On the first shape.
    pub on_a: [f64; 3],
    /// On the second.
    pub on_b: [f64; 3],
    /// Unit, from the first to the second.
    pub normal: [f64; 3],
    /// True if [`CastOptions::max_steps`] was too small: they do not touch before `time`.
    pub unresolved: bool,
}

/// The first point of a shape on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeRayHit {
    /// The parameter along the ray.
    pub t: f64,
    /// In world coordinates.
    pub point: [f64; 3],
    /// Unit, towards the ray's origin; 0 if the ray began inside.
    pub normal: [f64; 3],
    /// The part that was hit.
    pub part: Part,
    /// True if the ray began in a solid shape; `t` is then 0.
    pub started_inside: bool,
}

impl Shape {
    fn new(kind: u32, fill: impl FnOnce(&mut sys::ShapeDescription)) -> Result<Shape> {
        let mut description = unsafe { sys::crofton_default_shape_description() };
        description.kind = kind;
        fill(&mut description);
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_shape_create(&description, &mut raw) })?;
        Ok(Shape { raw })
    }
    fn round(kind: u32, radius: f32, half_height: f32) -> Result<Shape> {
        Shape::new(kind, |d| (d.radius, d.half_height) = (radius, half_height))
    }
    /// A sphere.
    pub fn sphere(radius: f32) -> Result<Shape> {
        Shape::round(sys::SHAPE_SPHERE, radius, 0.0)
    }
    /// A capsule; `half_height` is without its caps.
    pub fn capsule(radius: f32, half_height: f32) -> Result<Shape> {
        Shape::round(sys::SHAPE_CAPSULE, radius, half_height)
    }
    /// A cylinder.
    pub fn cylinder(radius: f32, half_height: f32) -> Result<Shape> {
        Shape::round(sys::SHAPE_CYLINDER, radius, half_height)
    }
    /// A cone, its tip up.
    pub fn cone(radius: f32, half_height: f32) -> Result<Shape> {
        Shape::round(sys::SHAPE_CONE, radius, half_height)
    }
    /// A box.
    pub fn cuboid(half_extents: [f32; 3]) -> Result<Shape> {
        Shape::new(sys::SHAPE_BOX, |d| d.half_extents = half_extents)
    }
    /// A triangle with the corners a, b, c, counter-clockwise seen from the front.
    pub fn triangle([a, b, c]: [[f32; 3]; 3]) -> Result<Shape> {
        let corners = [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]];
        Shape::new(sys::SHAPE_TRIANGLE, |d| d.corners = corners)
    }
    /// The convex hull of points. One with more than `max_vertices`, 4 to 256, is replaced by a larger one.
    pub fn hull(points: &[[f32; 3]], max_vertices: u32) -> Result<Shape> {
        Shape::new(sys::SHAPE_HULL, |d| {
            (d.points, d.point_count, d.max_vertices) = (points.as_ptr().cast(), points.len(), max_vertices)
        })
    }
    /// The points x with `dot(normal, x) + offset >= 0`.
    pub fn half_space(normal: [f64; 3], offset: f64) -> Result<Shape> {
        Shape::new(sys::SHAPE_HALF_SPACE, |d| d.plane = sys::Plane { normal, offset })
    }
    /// The surface of triangles, three indices each. `front_only`: contacts push to the front only, and casts from behind
    /// pass.
    pub fn mesh(positions: &[[f32; 3]], indices: &[u32], front_only: bool) -> Result<Shape> {
        let mesh = raw_mesh(positions, indices);
        Shape::new(sys::SHAPE_MESH, |d| (d.mesh, d.front_only) = (&mesh, front_only as u32))
    }
    /// A height field. `front_only`, for up, as in [`Shape::mesh`].
    pub fn height_field(field: &HeightField, front_only: bool) -> Result<Shape> {
        let columns = field.columns as usize;
        let rows = field.heights.len() / columns.max(1);
        let cells = columns.saturating_sub(1) * rows.saturating_sub(1);
        if rows * columns != field.heights.len() || !(field.materials.is_empty() || field.materials.len() == cells) {
            let message = "`heights` is to hold whole rows, and `materials` one for each cell, or none";
            return Err(crate::error::wrong(message));
        }
        let raw = sys::HeightField {
            size: size_of::<sys::HeightField>(),
            columns: field.columns,
            rows: rows.min(u32::MAX as usize) as u32,
            heights: field.heights.as_ptr(),
            materials: if field.materials.is_empty() { ptr::null() } else { field.materials.as_ptr() },
            spacing: field.spacing,
        };
        Shape::new(sys::SHAPE_HEIGHT_FIELD, |d| (d.height_field, d.front_only) = (&raw, front_only as u32))
    }
    /// The points no farther than `radius` from a convex shape other than a half-space.
    pub fn rounded(core: &Shape, radius: f32) -> Result<Shape> {
        Shape::new(sys::SHAPE_ROUNDED, |d| (d.core, d.radius) = (core.raw, radius))
    }
    /// Several shapes as one.
    pub fn compound(children: &[Placed]) -> Result<Shape> {
        let shapes: Vec<*const sys::Shape> = children.iter().map(|c| c.shape.raw as *const _).collect();
        let poses: Vec<Transform> = children.iter().map(|c| c.pose).collect();
        Shape::new(sys::SHAPE_COMPOUND, |d| {
            (d.children, d.poses, d.child_count) = (shapes.as_ptr(), poses.as_ptr(), shapes.len())
        })
    }

    /// Returns the shape at a pose, for queries.
    pub fn at(&self, pose: Transform) -> Placed<'_> {
        Placed { shape: self, pose }
    }
    /// Returns the corners of the box along the axes that contains the shape in its frame; infinite for half-spaces.
    pub fn bounds(&self) -> Result<([f64; 3], [f64; 3])> {
        let mut info: sys::ShapeInfo = unsafe { std::mem::zeroed() };
        info.size = size_of::<sys::ShapeInfo>();
        check(unsafe { sys::crofton_shape_get_info(self.raw, &mut info) })?;
        Ok((info.min, info.max))
    }
    /// Returns the mass properties. Error: surfaces have no mass.
    pub fn mass(&self) -> Result<MassProperties> {
        let mut m: sys::MassProperties = unsafe { std::mem::zeroed() };
        m.size = size_of::<sys::MassProperties>();
        check(unsafe { sys::crofton_shape_get_mass(self.raw, &mut m) })?;
        Ok(MassProperties { volume: m.volume, center: m.center, inertia: m.inertia })
    }
}

impl Placed<'_> {
    // Points to the pose: valid as long as this.
    pub(crate) fn raw(&self) -> sys::Placed {
        sys::Placed { shape: self.shape.raw, pose: &self.pose }
    }
    /// Tests whether the shapes share a point.
    pub fn touches(&self, other: &Placed) -> Result<bool> {
        let mut meet = 0;
        check(unsafe { sys::crofton_shapes_meet(&self.raw(), &other.raw(), ptr::null_mut(), &mut meet) })?;
        Ok(meet != 0)
    }
    /// Returns the distance, 0 if the shapes overlap, and the nearest points.
    pub fn distance(&self, other: &Placed) -> Result<Separation> {
        let mut d: sys::ShapeDistance = unsafe { std::mem::zeroed() };
        d.size = size_of::<sys::ShapeDistance>();
        check(unsafe { sys::crofton_shapes_distance(&self.raw(), &other.raw(), ptr::null_mut(), &mut d) })?;
        Ok(Separation { distance: d.distance, on_a: d.on_a, on_b: d.on_b })
    }
    /// Returns how deep the shapes overlap, if they do.
    pub fn penetration(&self, other: &Placed) -> Result<Option<Penetration>> {
        let mut p: sys::ShapePenetration = unsafe { std::mem::zeroed() };
        p.size = size_of::<sys::ShapePenetration>();
        check(unsafe { sys::crofton_shapes_penetration(&self.raw(), &other.raw(), ptr::null_mut(), &mut p) })?;
        Ok((p.overlapping != 0).then_some(Penetration { depth: p.depth, normal: p.normal }))
    }
    /// Returns where the shapes touch: up to `max_points` points, 1 to 8. Gaps of up to `margin` count.
    ///
    /// ```
    /// # use crofton::{Shape, Transform};
    /// # fn main() -> Result<(), crofton::Error> {
    /// let (floor, cube) = (Shape::half_space([0.0, -1.0, 0.0], 0.0)?, Shape::cuboid([1.0; 3])?);
    /// let standing = cube.at(Transform::at([0.0, 0.75, 0.0]));
    /// let contact = floor.at(Transform::default()).contacts(&standing, 0.0, 4)?;
    /// assert!(contact.points.len() == 4 && (contact.depth - 0.25).abs() < 1e-6);
    /// # Ok(()) }
    /// ```
    pub fn contacts(&self, other: &Placed, margin: f64, max_points: u32) -> Result<ShapeContact> {
        let options = sys::ManifoldOptions { size: size_of::<sys::ManifoldOptions>(), margin, max_points };
        let mut m: sys::ShapeManifold = unsafe { std::mem::zeroed() };
        m.size = size_of::<sys::ShapeManifold>();
        check(unsafe { sys::crofton_shapes_manifold(&self.raw(), &other.raw(), &options, ptr::null_mut(), &mut m) })?;
        let points = m.points[..m.point_count as usize].to_vec();
        Ok(ShapeContact { normal: m.normal, depth: m.depth, points })
    }
    /// Returns the point of the shape that is nearest to `point`.
    pub fn closest_point(&self, point: [f64; 3]) -> Result<NearestPoint> {
        let mut d: sys::ShapeDistance = unsafe { std::mem::zeroed() };
        d.size = size_of::<sys::ShapeDistance>();
        check(unsafe { sys::crofton_shape_closest_point(&self.raw(), point.as_ptr(), &mut d) })?;
        // a is the point
        Ok(NearestPoint { distance: d.distance, point: d.on_b, part: d.part_b })
    }
    /// Returns when this shape, moving, first touches another, if it does in that time.
    pub fn cast(
        &self, motion: &Motion, other: &Placed, other_motion: &Motion, options: &CastOptions,
    ) -> Result<Option<Impact>> {
        let mut i: sys::Impact = unsafe { std::mem::zeroed() };
        i.size = size_of::<sys::Impact>();
        let (a, b, options) = (self.raw(), other.raw(), options.raw());
        check(unsafe { sys::crofton_shapes_cast(&a, motion, &b, other_motion, &options, &mut i) })?;
        Ok((i.result != sys::CAST_MISS).then_some(Impact {
            time: i.time,
            distance: i.distance,
            on_a: i.on_a,
            on_b: i.on_b,
            normal: i.normal,
            unresolved: i.result == sys::CAST_UNRESOLVED,
        }))
    }
    /// Returns the first hit of a ray. Triangles, meshes and height fields have no inside.
    pub fn raycast(&self, ray: &Ray) -> Result<Option<ShapeRayHit>> {
        let mut h: sys::ShapeRayHit = unsafe { std::mem::zeroed() };
        h.size = size_of::<sys::ShapeRayHit>();
        check(unsafe { sys::crofton_shape_raycast(&self.raw(), ray, &mut h) })?;
        Ok(h.t.is_finite().then_some(ShapeRayHit {
            t: h.t,
            point: h.point,
            normal: h.normal,
            part: h.part,
            started_inside: h.started_inside != 0,
        }))
    }
}

// Points to the arrays: valid as long as they.
pub(crate) fn raw_mesh(positions: &[[f32; 3]], indices: &[u32]) -> sys::Mesh {
    sys::Mesh {
        size: size_of::<sys::Mesh>(),
        positions: positions.as_ptr().cast(),
        vertex_count: positions.len(),
        indices: indices.as_ptr(),
        index_count: indices.len(),
        name: ptr::null(),
    }
}
