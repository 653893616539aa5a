// SPDX-License-Identifier: MIT
//! Files that `crofton bake` and `crofton pvs` wrote: scenes, regions, visible sets.
use crate::error::{check, slice, wrong};
use crate::jobs::with_jobs;
use crate::{sys, ClusteredMesh, Executor, Obb, Region, Result, Status, Transform};
use std::{ffi::CStr, ffi::CString, mem::size_of, path::Path, ptr};

#[cfg(unix)]
fn c_path(path: &Path) -> Result<CString> {
    use std::os::unix::ffi::OsStrExt;
    CString::new(path.as_os_str().as_bytes()).map_err(|_| wrong("a path has a 0 within"))
}
#[cfg(not(unix))]
fn c_path(path: &Path) -> Result<CString> {
    let text = path.to_str().ok_or_else(|| wrong("a path is not Unicode"))?;
    CString::new(text).map_err(|_| wrong("a path has a 0 within"))
}

/// A scene from a file: its meshes, where they stand, and their clusters.
pub struct BakedScene {
    raw: *mut sys::BakedScene,
}

// It never changes.
unsafe impl Send for BakedScene {}
unsafe impl Sync for BakedScene {}

impl Drop for BakedScene {
    fn drop(&mut self) {
        unsafe { sys::crofton_baked_scene_destroy(self.raw) };
    }
}

/// A mesh of a [`BakedScene`].
#[derive(Debug, Clone, Copy)]
pub struct BakedMesh<'a> {
    /// Its name.
    pub name: &'a str,
    /// x, y, z of each vertex.
    pub positions: &'a [[f32; 3]],
    /// Linear r, g, b of each vertex; empty: none.
    pub colors: &'a [[f32; 3]],
    /// Three per triangle.
    pub indices: &'a [u32],
    /// In the mesh's own frame.
    pub obb: Obb,
    /// Back faces are not drawn.
    pub one_sided: bool,
    /// Each face has its own normal.
    pub flat: bool,
    /// Colours are not lit.
    pub unlit: bool,
}

/// An instance of a [`BakedScene`]: a mesh at a node. One that was removed has `u32::MAX` in both.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BakedInstance {
    /// The mesh's number.
    pub mesh: u32,
    /// The node's number.
    pub node: u32,
}

/// A node of a [`BakedScene`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakedNode {
    /// To the world.
    pub world: Transform,
    /// The node above, or `u32::MAX`.
    pub parent: u32,
    reserved: u32,
}

impl BakedScene {
    /// Reads a file and checks all of it.
    pub fn open(path: impl AsRef<Path>) -> Result<BakedScene> {
        let (mut raw, mut tree) = (ptr::null_mut(), ptr::null_mut());
        let path = c_path(path.as_ref())?;
        check(unsafe { sys::crofton_baked_scene_read(path.as_ptr(), ptr::null(), &mut raw, &mut tree) })?;
        unsafe { sys::crofton_tree_destroy(tree) };
        Ok(BakedScene { raw })
    }
    /// Returns the number of meshes.
    pub fn mesh_count(&self) -> usize {
        let mut count = 0;
        unsafe { sys::crofton_baked_scene_mesh_count(self.raw, &mut count) };
        count
    }
    /// Returns a mesh. Error: there is no such mesh.
    pub fn mesh(&self, mesh: u32) -> Result<BakedMesh<'_>> {
        let mut m: sys::BakedMesh = unsafe { std::mem::zeroed() };
        m.size = size_of::<sys::BakedMesh>();
        check(unsafe { sys::crofton_baked_scene_mesh(self.raw, mesh, &mut m) })?;
        let colored = if m.colors.is_null() { 0 } else { m.vertex_count };
        let name = unsafe { slice(m.name, m.name_length) };
        Ok(BakedMesh {
            name: std::str::from_utf8(name).map_err(|_| wrong("the mesh's name is not UTF-8"))?,
            positions: unsafe { slice(m.positions, m.vertex_count) },
            colors: unsafe { slice(m.colors, colored) },
            indices: unsafe { slice(m.indices, m.index_count) },
            obb: m.bounding_box,
            one_sided: m.one_sided != 0,
            flat: m.flat != 0,
            unlit: m.unlit != 0,
        })
    }
    /// Returns a mesh's clusters, for [`MeshData::precut`](crate::MeshData::precut); `None`: it was baked without.
    pub fn clusters(&self, mesh: u32) -> Result<Option<ClusteredMesh>> {
        let mut raw = ptr::null_mut();
        match check(unsafe { sys::crofton_baked_scene_clusters(self.raw, mesh, &mut raw) }) {
            Err(error) if error.status == Status::Empty => Ok(None),
            result => result.map(|()| Some(ClusteredMesh::of(raw))),
        }
    }
    /// Returns the instances.
    pub fn instances(&self) -> Result<&[BakedInstance]> {
        let (mut first, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_baked_scene_instances(self.raw, &mut first, &mut count) })?;
        Ok(unsafe { slice(first, count) })
    }
    /// Returns the nodes.
    pub fn nodes(&self) -> Result<&[BakedNode]> {
        let (mut first, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_baked_scene_nodes(self.raw, &mut first, &mut count) })?;
        Ok(unsafe { slice(first, count) })
    }
}

/// Options of regions from files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakedRegionOptions {
    /// True: rays, probes and contacts test the triangles; false: the meshes' boxes.
    pub triangles: bool,
    /// Objects hide others by the occluders of the file; false saves half of the time.
    pub occluders: bool,
    /// The layers that all objects collide with.
    pub collides_with: u32,
    /// Does not check that the bounds in the file contain what is below them. Only for files of your own: wrong bounds
    /// would lose objects later.
    pub trust_contents: bool,
    /// A region with more is refused.
    pub max_objects: u64,
    /// As in [`RegionOptions`](crate::RegionOptions); for another value than 1e9 the file's tree is built anew.
    pub max_origin: f64,
}

impl Default for BakedRegionOptions {
    fn default() -> Self {
        let raw = unsafe { sys::crofton_default_baked_region_options() };
        BakedRegionOptions {
            triangles: raw.triangles != 0,
            occluders: raw.occluders != 0,
            collides_with: raw.collides_with,
            trust_contents: raw.trust_contents != 0,
            max_objects: raw.max_objects,
            max_origin: raw.max_origin,
        }
    }
}

impl BakedRegionOptions {
    fn raw(&self) -> sys::BakedRegionOptions {
        sys::BakedRegionOptions {
            size: size_of::<sys::BakedRegionOptions>(),
            triangles: self.triangles as u32,
            occluders: self.occluders as u32,
            collides_with: self.collides_with,
            trust_contents: self.trust_contents as u32,
            max_objects: self.max_objects,
            max_origin: self.max_origin,
        }
    }
}

impl Region {
    /// Opens a baked file, checks all of it and prepares a region. The object at place i is instance i of the file, with
    /// the user number i; meshes have the numbers of the file.
    pub fn open(
        executor: Option<&dyn Executor>, path: impl AsRef<Path>, options: &BakedRegionOptions,
    ) -> Result<Region> {
        let (path, options, mut raw) = (c_path(path.as_ref())?, options.raw(), ptr::null_mut());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_baked_region_open(path.as_ptr(), &options, jobs, &mut raw)
        }))?;
        Ok(Region::of(raw))
    }
}

/// The index of a world that `crofton bake --regions` has split into a folder of files.
pub struct RegionIndex {
    raw: *mut sys::RegionIndex,
}

// It never changes.
unsafe impl Send for RegionIndex {}
unsafe impl Sync for RegionIndex {}

impl Drop for RegionIndex {
    fn drop(&mut self) {
        unsafe { sys::crofton_region_index_destroy(self.raw) };
    }
}

/// A region of a [`RegionIndex`].
#[derive(Debug, Clone, PartialEq)]
pub struct RegionFile {
    /// Of the file, in the index's folder.
    pub name: String,
    /// Where to attach it.
    pub origin: [f64; 3],
    /// The minimum corner of a box around its objects, relative to the origin.
    pub min: [f64; 3],
    /// The maximum corner.
    pub max: [f64; 3],
    /// How many objects it holds.
    pub objects: u64,
    /// The file's size.
    pub bytes: u64,
}

impl RegionIndex {
    /// Reads the index of a folder.
    pub fn open(folder: impl AsRef<Path>) -> Result<RegionIndex> {
        let (folder, mut raw) = (c_path(folder.as_ref())?, ptr::null_mut());
        check(unsafe { sys::crofton_region_index_open(folder.as_ptr(), &mut raw) })?;
        Ok(RegionIndex { raw })
    }
    /// Returns where the regions are.
    pub fn files(&self) -> Vec<RegionFile> {
        let (mut first, mut count) = (ptr::null(), 0);
        let raw = unsafe {
            sys::crofton_region_index_files(self.raw, &mut first, &mut count);
            slice(first, count)
        };
        raw.iter()
            .map(|file| RegionFile {
                name: unsafe { CStr::from_ptr(file.name) }.to_string_lossy().into_owned(),
                origin: file.origin,
                min: file.min,
                max: file.max,
                objects: file.objects,
                bytes: file.bytes,
            })
            .collect()
    }
    /// Does the same as [`Region::open`] for the region at a place in [`files`](Self::files). Also an error: the file has
    /// another size or other objects than the index says.
    pub fn prepare(
        &self, executor: Option<&dyn Executor>, place: usize, options: &BakedRegionOptions,
    ) -> Result<Region> {
        let (options, mut raw) = (options.raw(), ptr::null_mut());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_region_index_prepare(self.raw, place, &options, jobs, &mut raw)
        }))?;
        Ok(Region::of(raw))
    }
}

/// Visible sets: which objects of a scene may be seen from where. `crofton pvs --out FILE` bakes them.
pub struct Pvs {
    raw: *mut sys::Pvs,
}

// They never change.
unsafe impl Send for Pvs {}
unsafe impl Sync for Pvs {}

impl Drop for Pvs {
    fn drop(&mut self) {
        unsafe { sys::crofton_pvs_destroy(self.raw) };
    }
}

/// How sure [`Pvs::visible`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PvsMode {
    /// Everything that is not proved to be hidden.
    Conservative = 0,
    /// What random lines have seen.
    Statistical = 1,
}

impl Pvs {
    /// Reads a file.
    pub fn open(path: impl AsRef<Path>) -> Result<Pvs> {
        let (path, mut raw) = (c_path(path.as_ref())?, ptr::null_mut());
        check(unsafe { sys::crofton_pvs_open(path.as_ptr(), &mut raw) })?;
        Ok(Pvs { raw })
    }
    /// Copies what a file in memory holds.
    pub fn from_bytes(bytes: &[u8]) -> Result<Pvs> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_pvs_read(bytes.as_ptr(), bytes.len(), &mut raw) })?;
        Ok(Pvs { raw })
    }
    fn counts(&self) -> (usize, usize) {
        let (mut cells, mut objects) = (0, 0);
        unsafe { sys::crofton_pvs_counts(self.raw, &mut cells, &mut objects) };
        (cells, objects)
    }
    /// Returns the number of cells.
    pub fn cell_count(&self) -> usize {
        self.counts().0
    }
    /// Returns the number of objects.
    pub fn object_count(&self) -> usize {
        self.counts().1
    }
    /// Returns the cell of an eye; `None`: it is in none, or in a solid one.
    pub fn find_cell(&self, eye: [f64; 3]) -> Result<Option<u32>> {
        let mut cell = 0;
        check(unsafe { sys::crofton_pvs_find_cell(self.raw, eye.as_ptr(), &mut cell) })?;
        Ok((cell != u32::MAX).then_some(cell))
    }
    /// Returns what an eye may see, for [`ViewRequest::candidate_mask`](crate::ViewRequest::candidate_mask): bit i % 64 of
    /// word i / 64 for object i. Empty if the eye is in no cell, which stands for everything.
    pub fn visible(&self, eye: [f64; 3], mode: PvsMode) -> Result<&[u64]> {
        let (mut words, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_pvs_visible(self.raw, eye.as_ptr(), mode as u32, &mut words, &mut count) })?;
        Ok(unsafe { slice(words, count) })
    }
}
