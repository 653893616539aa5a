// SPDX-License-Identifier: MIT
//! World holds a game's objects and answers queries about them.
use crate::error::{check, wrong};
use crate::jobs::with_jobs;
use crate::{
    sys, Bound, Description, Error, Executor, Indices, MeshData, Obb, Result, Shape, Status, Transform, Vertices,
};
use std::{mem::size_of, ptr};

macro_rules! handle {
    ($name:ident, $text:literal) => {
        #[doc = $text]
        ///
        /// An index, which is reused after removal, and a generation, which tells apart those that have used it. Calls
        /// fail with
        /// [`Status::StaleHandle`](crate::Status::StaleHandle) for a handle whose owner was removed.
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub struct $name {
            /// The index that views list.
            pub index: u32,
            /// Tells apart the users of an index.
            pub generation: u32,
        }
    };
}
handle!(Object, "An object of a [`World`].");
handle!(Node, "A node of a [`World`]: what moves it moves all below it.");
handle!(Mesh, "A mesh of a [`World`].");

/// An object and its user number.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObjectRef {
    /// The object.
    pub object: Object,
    /// Your number, from [`Description::user`].
    pub user: u64,
}

/// Options of a [`World`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldOptions {
    /// True: updates find pairs and contacts; false: neither.
    pub pairs: bool,
    /// False: updates find pairs only.
    pub contacts: bool,
    /// True: an object inside a closed mesh counts as a contact.
    pub containment: bool,
    /// True: computes depths of contacts between meshes; takes longer than finding them.
    pub mesh_depth: bool,
    /// 2^24; an update with more pairs fails.
    pub max_pairs: u64,
    /// 0; gaps up to this between shapes are contacts.
    pub contact_margin: f64,
    /// 16; updates without motion after which an object rests again.
    pub updates_to_rest: u32,
    /// Items' worth of background work on the tree in each update; 0: none, and no allocation. `u64::MAX`: as many as
    /// are good.
    pub rebuild_budget: u64,
}

impl Default for WorldOptions {
    fn default() -> WorldOptions {
        let raw = unsafe { sys::crofton_default_world_options() };
        WorldOptions {
            pairs: raw.pairs != 0,
            contacts: raw.contacts != 0,
            containment: raw.containment != 0,
            mesh_depth: raw.mesh_depth != 0,
            max_pairs: raw.max_pairs,
            contact_margin: raw.contact_margin,
            updates_to_rest: raw.updates_to_rest,
            rebuild_budget: raw.rebuild_budget,
        }
    }
}

/// As of the last update.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Statistics {
    /// All objects.
    pub objects: u64,
    /// Resting objects, hidden ones not counted.
    pub resting: u64,
    /// Moving objects, hidden ones not counted.
    pub moving: u64,
    /// Boxes that the last update changed.
    pub boxes_changed: u32,
    /// Objects whose product of transforms is out of range: hidden until it is valid.
    pub out_of_range: u32,
    /// Pairs of boxes that the last update tested.
    pub box_pairs_tested: u64,
    /// Pairs whose shapes or triangles it tested.
    pub contact_pairs_tested: u64,
    /// Objects of regions whose occluders are not placed yet; they hide nothing until then.
    pub occluders_waiting: u64,
}

/// Owns nodes, meshes and objects. Changes take effect in [`World::update`]; queries answer as of the last one.
pub struct World {
    pub(crate) raw: *mut sys::World,
}

// Calls that take a pointer to const may run at the same time; all others take &mut here.
unsafe impl Send for World {}
unsafe impl Sync for World {}

impl Drop for World {
    fn drop(&mut self) {
        unsafe { sys::crofton_world_destroy(self.raw) };
    }
}

impl World {
    /// Returns an empty world with the default options.
    pub fn new() -> Result<World> {
        World::with(WorldOptions::default())
    }

    /// Returns an empty world.
    pub fn with(options: WorldOptions) -> Result<World> {
        if unsafe { sys::crofton_api_version() } != sys::API_VERSION {
            return Err(wrong(
                "this crate and the library that was loaded have different API versions: build both anew",
            ));
        }
        let mut given = unsafe { sys::crofton_default_world_options() };
        given.pairs = options.pairs as u32;
        given.contacts = options.contacts as u32;
        given.containment = options.containment as u32;
        given.mesh_depth = options.mesh_depth as u32;
        given.max_pairs = options.max_pairs;
        given.contact_margin = options.contact_margin;
        given.updates_to_rest = options.updates_to_rest;
        given.rebuild_budget = options.rebuild_budget;
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_world_create(&given, &mut raw) })?;
        Ok(World { raw })
    }

    /// Adds a mesh; copies what it needs of `data`.
    pub fn add_mesh(&mut self, data: &MeshData) -> Result<Mesh> {
        let mut mesh = Mesh { index: 0, generation: 0 };
        check(unsafe { sys::crofton_world_add_mesh(self.raw, &data.raw()?, &mut mesh) })?;
        Ok(mesh)
    }
    /// Replaces a mesh in all objects that use it.
    pub fn replace_mesh(&mut self, mesh: Mesh, data: &MeshData) -> Result<()> {
        check(unsafe { sys::crofton_world_replace_mesh(self.raw, mesh, &data.raw()?) })
    }
    /// Moves the vertices of a mesh that deforms: as many as before.
    pub fn set_vertices(&mut self, mesh: Mesh, vertices: Vertices) -> Result<()> {
        let data = MeshData { vertices, indices: Indices::None, ..MeshData::new(&[], &[]) };
        check(unsafe { sys::crofton_world_set_vertices(self.raw, mesh, &data.raw()?) })
    }
    /// Removes a mesh. Error: objects use it.
    pub fn remove_mesh(&mut self, mesh: Mesh) -> Result<()> {
        check(unsafe { sys::crofton_world_remove_mesh(self.raw, mesh) })
    }

    /// Adds a node. Objects below have only those of their layers that are also in `layers`.
    pub fn add_node(&mut self, parent: Option<Node>, transform: &Transform, layers: u32) -> Result<Node> {
        let mut node = Node { index: 0, generation: 0 };
        check(unsafe { sys::crofton_world_add_node(self.raw, as_pointer(&parent), transform, layers, &mut node) })?;
        Ok(node)
    }
    /// Removes the node with all nodes and objects below it.
    pub fn remove_node(&mut self, node: Node) -> Result<()> {
        check(unsafe { sys::crofton_world_remove_node(self.raw, node) })
    }
    /// Moves the node below another. Error: `parent` is the node itself or one below it.
    pub fn set_parent(&mut self, node: Node, parent: Option<Node>) -> Result<()> {
        check(unsafe { sys::crofton_world_set_parent(self.raw, node, as_pointer(&parent)) })
    }
    /// Sets the node's layers. Objects below have only those of their layers that are also in these.
    pub fn set_node_layers(&mut self, node: Node, layers: u32) -> Result<()> {
        check(unsafe { sys::crofton_world_set_node_layers(self.raw, node, layers) })
    }
    /// Applies all valid items and leaves the others unchanged; the error names the first invalid one.
    pub fn set_node_transforms(&mut self, nodes: &[Node], transforms: &[Transform]) -> Result<()> {
        same_length(nodes.len(), transforms.len())?;
        let (n, t) = (nodes.as_ptr(), transforms.as_ptr());
        check(unsafe { sys::crofton_world_set_node_transforms(self.raw, n, 0, t, 0, nodes.len()) })
    }

    /// Adds an object; queries find it from the next update on.
    pub fn add(&mut self, description: &Description) -> Result<Object> {
        let bound = description.bound.map(|b| b.raw());
        let mut object = Object { index: 0, generation: 0 };
        check(unsafe { sys::crofton_world_add(self.raw, &description.raw(as_pointer(&bound)), &mut object) })?;
        Ok(object)
    }
    /// Adds many objects in one call; `objects[i]` becomes the handle of `descriptions[i]`. Adds all valid ones: the
    /// error names the first of the others, whose handles are stale from the start.
    pub fn add_many(&mut self, descriptions: &[Description], objects: &mut Vec<Object>) -> Result<()> {
        let bounds: Vec<_> = descriptions.iter().map(|d| d.bound.map(|b| b.raw())).collect();
        let raw: Vec<_> = descriptions.iter().zip(&bounds).map(|(d, bound)| d.raw(as_pointer(bound))).collect();
        objects.clear();
        objects.resize(descriptions.len(), Object { index: 0, generation: 0 });
        check(unsafe { sys::crofton_world_add_many(self.raw, raw.as_ptr(), raw.len(), objects.as_mut_ptr()) })
    }
    /// Takes memory for so many objects in all, so that no later call has to copy what the world knows of each.
    pub fn reserve(&mut self, objects: usize) -> Result<()> {
        check(unsafe { sys::crofton_world_reserve(self.raw, objects) })
    }
    /// Removes an object; its handle becomes stale.
    pub fn remove(&mut self, object: Object) -> Result<()> {
        check(unsafe { sys::crofton_world_remove(self.raw, object) })
    }
    /// Moves objects with meshes or only shapes. Applies all valid items; the error names the first invalid one.
    pub fn set_transforms(&mut self, objects: &[Object], transforms: &[Transform]) -> Result<()> {
        same_length(objects.len(), transforms.len())?;
        let (o, t) = (objects.as_ptr(), transforms.as_ptr());
        check(unsafe { sys::crofton_world_set_transforms(self.raw, o, 0, t, 0, objects.len()) })
    }
    /// Moves objects that were added with a bound; it becomes a box. Errors as in [`World::set_transforms`].
    pub fn set_boxes(&mut self, objects: &[Object], boxes: &[Obb]) -> Result<()> {
        same_length(objects.len(), boxes.len())?;
        let (o, b) = (objects.as_ptr(), boxes.as_ptr());
        check(unsafe { sys::crofton_world_set_boxes(self.raw, o, 0, b, 0, objects.len()) })
    }
    // Sets one member of an object.
    pub(crate) fn set(
        &mut self, object: Object, member: u32, fill: impl FnOnce(&mut sys::ObjectDescription),
    ) -> Result<()> {
        let mut description = unsafe { sys::crofton_default_object_description() };
        fill(&mut description);
        check(unsafe { sys::crofton_world_set(self.raw, object, member, &description) })
    }
    /// Sets the bound of an object that was added with one.
    pub fn set_bound(&mut self, object: Object, bound: Bound) -> Result<()> {
        let raw = bound.raw();
        self.set(object, sys::SET_BOUND, |d| d.bound = &raw)
    }
    /// Sets the mesh of an object that has one.
    pub fn set_mesh(&mut self, object: Object, mesh: Mesh) -> Result<()> {
        self.set(object, sys::SET_MESH, |d| (d.has_mesh, d.mesh) = (1, mesh))
    }
    /// Sets the shape of an object, or removes it; not of one that was added with only a shape.
    pub fn set_shape(&mut self, object: Object, shape: Option<&Shape>) -> Result<()> {
        self.set(object, sys::SET_SHAPE, |d| d.shape = shape.map_or(ptr::null(), |s| s.raw as *const _))
    }
    /// Hides or shows an object; no answer contains a hidden one.
    pub fn set_hidden(&mut self, object: Object, hidden: bool) -> Result<()> {
        self.set(object, sys::SET_HIDDEN, |d| d.hidden = hidden as u32)
    }
    /// Sets the layers that the object is in.
    pub fn set_layers(&mut self, object: Object, layers: u32) -> Result<()> {
        self.set(object, sys::SET_LAYERS, |d| d.layers = layers)
    }
    /// Sets the layers that the object collides with.
    pub fn set_collides_with(&mut self, object: Object, layers: u32) -> Result<()> {
        self.set(object, sys::SET_COLLIDES_WITH, |d| d.collides_with = layers)
    }
    /// Sets the number that answers return with the object.
    pub fn set_user(&mut self, object: Object, user: u64) -> Result<()> {
        self.set(object, sys::SET_USER, |d| d.user = user)
    }

    /// Applies the changes and finds pairs and contacts. Call it once a frame. Error: more than
    /// [`WorldOptions::max_pairs`]
    /// pairs; all pairs are dropped, everything else is up to date.
    pub fn update(&mut self) -> Result<()> {
        check(unsafe { sys::crofton_world_update(self.raw, ptr::null()) })
    }
    /// Does the same on several threads, with the same result.
    pub fn update_on(&mut self, executor: &dyn Executor) -> Result<()> {
        check(with_jobs(Some(executor), |jobs| unsafe { sys::crofton_world_update(self.raw, jobs) }))
    }
    /// Returns the statistics of the last update.
    pub fn statistics(&self) -> Result<Statistics> {
        let s = self.raw_statistics()?;
        Ok(Statistics {
            objects: s.objects,
            resting: s.resting,
            moving: s.moving,
            boxes_changed: s.boxes_changed,
            out_of_range: s.out_of_range,
            box_pairs_tested: s.box_pairs_tested,
            contact_pairs_tested: s.contact_pairs_tested,
            occluders_waiting: s.occluders_waiting,
        })
    }
    fn raw_statistics(&self) -> Result<sys::WorldStatistics> {
        let mut s: sys::WorldStatistics = unsafe { std::mem::zeroed() };
        s.size = size_of::<sys::WorldStatistics>();
        check(unsafe { sys::crofton_world_get_statistics(self.raw, &mut s) })?;
        Ok(s)
    }

    /// Returns the number of objects.
    pub fn object_count(&self) -> usize {
        self.raw_statistics().map_or(0, |s| s.object_count as usize)
    }
    fn info(&self, object: Object) -> Result<sys::ObjectInfo> {
        let mut info: sys::ObjectInfo = unsafe { std::mem::zeroed() };
        info.size = size_of::<sys::ObjectInfo>();
        check(unsafe { sys::crofton_world_get_object(self.raw, object, &mut info) })?;
        Ok(info)
    }
    pub(crate) fn mesh_info(&self, mesh: Mesh) -> Result<sys::MeshInfo> {
        let mut info: sys::MeshInfo = unsafe { std::mem::zeroed() };
        info.size = size_of::<sys::MeshInfo>();
        check(unsafe { sys::crofton_world_get_mesh(self.raw, mesh, &mut info) })?;
        Ok(info)
    }
    /// Tests whether the world contains the object.
    pub fn contains(&self, object: Object) -> bool {
        self.info(object).is_ok()
    }
    /// Tests whether the world contains the node.
    pub fn contains_node(&self, node: Node) -> bool {
        let mut contains = 0;
        unsafe { sys::crofton_world_contains_node(self.raw, node, &mut contains) == 0 && contains != 0 }
    }
    /// Tests whether the world contains the mesh.
    pub fn contains_mesh(&self, mesh: Mesh) -> bool {
        self.mesh_info(mesh).is_ok()
    }
    /// Returns the object's user number.
    pub fn user(&self, object: Object) -> Result<u64> {
        Ok(self.info(object)?.user)
    }
    /// Returns the object's box. Error: there was no update since the object was added.
    pub fn obb(&self, object: Object) -> Result<Obb> {
        let info = self.info(object)?;
        if info.has_box == 0 {
            return Err(not_yet("the object has no box before the next update", object));
        }
        Ok(info.bounding_box)
    }
    /// Returns the transform of an object with a mesh, to the world.
    pub fn transform(&self, object: Object) -> Result<Transform> {
        let info = self.info(object)?;
        if info.has_transform == 0 {
            return Err(not_yet("the object is a bound, or there was no update since it was added", object));
        }
        Ok(info.transform)
    }
}

fn not_yet(message: &str, object: Object) -> Error {
    Error { status: Status::Empty, message: message.to_owned(), item: Some(object.index as u64) }
}

pub(crate) fn as_pointer<T>(value: &Option<T>) -> *const T {
    value.as_ref().map_or(ptr::null(), |v| v as *const T)
}

fn same_length(a: usize, b: usize) -> Result<()> {
    if a == b {
        return Ok(());
    }
    Err(wrong("the two slices are to be of one length"))
}
