// SPDX-License-Identifier: MIT
//! Parts of a large world that come and go.
use crate::error::check;
use crate::jobs::with_jobs;
use crate::{sys, Bound, Clusters, Executor, MeshData, Object, Result, Shape, Status, Transform, World};
use std::{mem::size_of, ptr};

/// An object of a [`Region`]. Get it from [`RegionObject::bound`], [`RegionObject::mesh`] or [`RegionObject::shape`] and
/// change its members.
#[derive(Debug, Clone, Copy)]
pub struct RegionObject<'a> {
    /// A bound, relative to the region's origin; none for an object with a mesh.
    pub bound: Option<Bound>,
    /// The place of its mesh in [`RegionOptions::meshes`].
    pub mesh: Option<u32>,
    /// Places the mesh or the shape, relative to the region's origin.
    pub transform: Transform,
    /// A number that is returned with every answer.
    pub user: u64,
    /// The layers that the object is in.
    pub layers: u32,
    /// The layers that the object collides with.
    pub collides_with: u32,
    /// False: the object's mesh does not hide others.
    pub occludes: bool,
    /// False: answers contain the object. True, with a mesh: it only hides others.
    pub only_occludes: bool,
    /// Rays, casts and contacts use it in place of the mesh or the bound. Not infinite ground.
    pub shape: Option<&'a Shape>,
}

impl<'a> RegionObject<'a> {
    fn new(bound: Option<Bound>, mesh: Option<u32>, transform: Transform) -> Self {
        RegionObject {
            bound,
            mesh,
            transform,
            user: 0,
            layers: u32::MAX,
            collides_with: u32::MAX,
            occludes: true,
            only_occludes: false,
            shape: None,
        }
    }
    /// Describes an object with only a bound.
    pub fn bound(bound: Bound) -> Self {
        RegionObject::new(Some(bound), None, Transform::default())
    }
    /// Describes an object with the mesh at that place in [`RegionOptions::meshes`].
    pub fn mesh(place: u32, transform: Transform) -> Self {
        RegionObject::new(None, Some(place), transform)
    }
    /// Describes an object with only a shape.
    pub fn shape(shape: &'a Shape, transform: Transform) -> Self {
        RegionObject { shape: Some(shape), ..RegionObject::new(None, None, transform) }
    }
    fn raw(&self) -> sys::RegionObject {
        let mut raw = unsafe { sys::crofton_default_region_object() };
        if let Some(bound) = &self.bound {
            raw.bound = bound.raw();
        }
        if let Some(mesh) = self.mesh {
            raw.mesh = mesh;
        }
        if self.bound.is_none() {
            raw.transform = &self.transform;
        }
        raw.shape = self.shape.map_or(ptr::null(), |s| s.raw as *const _);
        raw.only_occludes = self.only_occludes as u32;
        (raw.user, raw.layers, raw.collides_with) = (self.user, self.layers, self.collides_with);
        raw.occludes = self.occludes as u32;
        raw
    }
}

/// Options of [`Region::prepare`].
#[derive(Debug, Clone, Copy)]
pub struct RegionOptions<'a> {
    /// The meshes that the objects share.
    pub meshes: &'a [MeshData<'a>],
    /// Searches the meshes for occluders, as [`World::find_occluders`] does.
    pub find_occluders: bool,
    /// A region with more is refused.
    pub max_objects: u64,
    /// No coordinate of an origin may be larger if an object has a mesh.
    pub max_origin: f64,
}

impl Default for RegionOptions<'_> {
    fn default() -> Self {
        let raw = unsafe { sys::crofton_default_region_options() };
        RegionOptions { meshes: &[], find_occluders: false, max_objects: raw.max_objects, max_origin: raw.max_origin }
    }
}

/// Many objects that do not move. Prepare it on any thread and attach it to a [`World`], where that takes microseconds.
///
/// ```
/// use crofton::{Bound, Obb, Region, RegionObject, RegionOptions, World};
/// # fn main() -> Result<(), crofton::Error> {
/// let trees: Vec<_> = (0..100)
///     .map(|i| RegionObject::bound(Bound::Box(Obb::aligned([3.0 * i as f64, 0.0, 0.0], [1.0; 3]))))
///     .collect();
/// let forest = Region::prepare(&trees, &RegionOptions::default())?; // on a thread that loads
/// let mut world = World::new()?;
/// let east = world.attach(&forest, [1000.0, 0.0, 0.0])?;
/// world.update()?; // from here on, answers contain the trees
/// let tree = world.object_in(east, 7)?;
/// assert_eq!(world.obb(tree)?.center, [1021.0, 0.0, 0.0]);
/// world.detach(east)?;
/// # Ok(()) }
/// ```
pub struct Region {
    raw: *mut sys::Region,
}

// A region never changes.
unsafe impl Send for Region {}
unsafe impl Sync for Region {}

impl Drop for Region {
    fn drop(&mut self) {
        unsafe { sys::crofton_region_destroy(self.raw) };
    }
}

impl Region {
    /// Prepares a region. If an object or a mesh is refused, [`Error::item`](crate::Error) is its place.
    pub fn prepare(objects: &[RegionObject], options: &RegionOptions) -> Result<Region> {
        Region::prepare_on(None, objects, options)
    }

    /// Does the same on the executor's threads.
    pub fn prepare_on(
        executor: Option<&dyn Executor>, objects: &[RegionObject], options: &RegionOptions,
    ) -> Result<Region> {
        let meshes = options.meshes.iter().map(|mesh| mesh.raw()).collect::<Result<Vec<_>>>()?;
        let objects: Vec<_> = objects.iter().map(|object| object.raw()).collect();
        let mut raw_options = unsafe { sys::crofton_default_region_options() };
        raw_options.meshes = meshes.as_ptr();
        raw_options.mesh_count = meshes.len();
        raw_options.find_occluders = options.find_occluders as u32;
        raw_options.max_objects = options.max_objects;
        raw_options.max_origin = options.max_origin;
        let mut raw = ptr::null_mut();
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_region_prepare(objects.as_ptr(), objects.len(), &raw_options, jobs, &mut raw)
        }))?;
        Ok(Region { raw })
    }
}

/// What a [`Region`] holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionInfo {
    /// The number of objects.
    pub object_count: u64,
    /// Bytes of memory; occluders and clusters are not counted.
    pub bytes: u64,
    /// The minimum corner of a box around all objects, relative to the origin; infinite without objects.
    pub min: [f64; 3],
    /// The maximum corner.
    pub max: [f64; 3],
}

impl Region {
    pub(crate) fn of(raw: *mut sys::Region) -> Region {
        Region { raw }
    }
    /// Returns what the region holds.
    pub fn info(&self) -> Result<RegionInfo> {
        let mut i: sys::RegionInfo = unsafe { std::mem::zeroed() };
        i.size = size_of::<sys::RegionInfo>();
        check(unsafe { sys::crofton_region_get_info(self.raw, &mut i) })?;
        Ok(RegionInfo { object_count: i.object_count, bytes: i.bytes, min: i.min, max: i.max })
    }
    /// Returns the mesh of the object at a place, as its number in [`RegionOptions::meshes`] or in the file; `None`: it
    /// has none.
    pub fn mesh_of(&self, place: u32) -> Result<Option<u32>> {
        let mut mesh = 0;
        check(unsafe { sys::crofton_region_mesh_of(self.raw, place, &mut mesh) })?;
        Ok((mesh != u32::MAX).then_some(mesh))
    }
    /// Returns the clusters of a mesh, to which a view's triangles refer; `None`: there is no such mesh, or it has none.
    pub fn clusters_of(&self, mesh: u32) -> Result<Option<Clusters<'_>>> {
        let mut raw: sys::Clusters = unsafe { std::mem::zeroed() };
        match check(unsafe { sys::crofton_region_clusters_of(self.raw, mesh, &mut raw) }) {
            Err(error) if error.status == Status::Empty => Ok(None),
            result => result.map(|()| Some(unsafe { Clusters::of(&raw) })),
        }
    }
}

/// A region that is attached to a [`World`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct AttachedRegion {
    /// Reused after the region was detached.
    pub index: u32,
    /// Tells apart those that have used the index.
    pub generation: u32,
}

impl World {
    /// Attaches a region: from the next update on, answers contain its objects, moved by `origin`. The world keeps what
    /// it needs of the region.
    pub fn attach(&mut self, region: &Region, origin: [f64; 3]) -> Result<AttachedRegion> {
        let mut attached = AttachedRegion { index: 0, generation: 0 };
        check(unsafe { sys::crofton_world_attach(self.raw, region.raw, origin.as_ptr(), &mut attached) })?;
        Ok(attached)
    }

    /// Detaches a region. Handles of its objects are stale at once; views follow with the next update.
    pub fn detach(&mut self, region: AttachedRegion) -> Result<()> {
        check(unsafe { sys::crofton_world_detach(self.raw, region) })
    }

    /// Returns the object at `place` in the slice that the region was prepared from. [`World::set_hidden`] can hide it;
    /// other changes are errors.
    pub fn object_in(&self, region: AttachedRegion, place: u32) -> Result<Object> {
        let mut object = Object { index: 0, generation: 0 };
        check(unsafe { sys::crofton_world_object_in(self.raw, region, place, &mut object) })?;
        Ok(object)
    }

    /// Returns the region and place of an object. Error: the object was added by [`World::add`].
    pub fn place_of(&self, object: Object) -> Result<(AttachedRegion, u32)> {
        let (mut region, mut place) = (AttachedRegion { index: 0, generation: 0 }, 0);
        check(unsafe { sys::crofton_world_place_of(self.raw, object, &mut region, &mut place) })?;
        Ok((region, place))
    }
}
