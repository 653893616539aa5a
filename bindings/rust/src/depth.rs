// SPDX-License-Identifier: MIT
//! Meshes cut into clusters, and the triangles that a picture of them needs, without a World.
use crate::error::{check, slice};
use crate::jobs::with_jobs;
use crate::shape::raw_mesh;
use crate::views::raw_picture;
use crate::{sys, ClusterBox, Clusters, Executor, PictureView, Result, VisibleCluster};
use std::{mem::size_of, ptr, sync::Arc};

/// A mesh cut into clusters. [`MeshData::precut`](crate::MeshData) gives it to a World.
#[derive(Debug)]
pub struct ClusteredMesh {
    pub(crate) raw: *mut sys::ClusteredMesh,
    lent: Option<(Arc<[[f32; 3]]>, Arc<[u32]>)>,
}

/// The order of indices that are lent to a [`ClusteredMesh`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IndexOrder {
    /// Permuted by [`Clusters::permute`](crate::Clusters::permute), as you draw them.
    Permuted = 0,
    /// As the mesh was cut.
    Original = 1,
}

// Calls that take a pointer to const may run at the same time; lend() takes &mut.
unsafe impl Send for ClusteredMesh {}
unsafe impl Sync for ClusteredMesh {}

impl Drop for ClusteredMesh {
    fn drop(&mut self) {
        unsafe { sys::crofton_clustered_mesh_destroy(self.raw) };
    }
}

impl ClusteredMesh {
    /// Cuts a mesh into clusters of up to `max_triangles`, at most 64; 0 chooses by the size of the mesh.
    pub fn new(positions: &[[f32; 3]], indices: &[u32], max_triangles: u32) -> Result<ClusteredMesh> {
        let mut raw = ptr::null_mut();
        let mesh = raw_mesh(positions, indices);
        check(unsafe { sys::crofton_clustered_mesh_create(&mesh, max_triangles, &mut raw) })?;
        Ok(ClusteredMesh::of(raw))
    }
    pub(crate) fn of(raw: *mut sys::ClusteredMesh) -> ClusteredMesh {
        ClusteredMesh { raw, lent: None }
    }
    /// Makes an equal one of what [`to_bytes`](Self::to_bytes) returned, without cutting again.
    pub fn from_bytes(bytes: &[u8]) -> Result<ClusteredMesh> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_clustered_mesh_deserialise(bytes.as_ptr(), bytes.len(), &mut raw) })?;
        Ok(ClusteredMesh::of(raw))
    }
    /// Reads your arrays from now on in place of copies: the mesh then needs a tenth to a seventh of their memory. With
    /// permuted indices the order of triangles is released, too, and [`clusters`](Self::clusters) returns an empty one. Error:
    /// another mesh than was cut, with the index as item; nothing has changed.
    pub fn lend(&mut self, positions: Arc<[[f32; 3]]>, indices: Arc<[u32]>, order: IndexOrder) -> Result<()> {
        let mesh = raw_mesh(&positions, &indices);
        check(unsafe { sys::crofton_clustered_mesh_lend(self.raw, &mesh, order as u32) })?;
        self.lent = Some((positions, indices));
        Ok(())
    }
    /// Returns a copy, to store; for machines of the same byte order.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let mut count = 0;
        check(unsafe { sys::crofton_clustered_mesh_serialise(self.raw, ptr::null_mut(), 0, &mut count) })?;
        let mut bytes = vec![0; count];
        check(unsafe { sys::crofton_clustered_mesh_serialise(self.raw, bytes.as_mut_ptr(), count, &mut count) })?;
        Ok(bytes)
    }
    /// Returns the clusters.
    pub fn clusters(&self) -> Result<Clusters<'_>> {
        let mut raw: sys::Clusters = unsafe { std::mem::zeroed() };
        check(unsafe { sys::crofton_clustered_mesh_get(self.raw, &mut raw) })?;
        Ok(unsafe { Clusters::of(&raw) })
    }
    /// Returns a box that contains the triangles of a cluster, in the mesh's coordinates.
    pub fn box_of(&self, cluster: usize) -> Result<ClusterBox> {
        let mut found = ClusterBox { center: [0.0; 3], half_edges: [[0.0; 3]; 3] };
        check(unsafe { sys::crofton_clustered_mesh_box(self.raw, cluster, &mut found) })?;
        Ok(found)
    }
}

/// A mesh to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct DepthObject<'a> {
    /// The mesh.
    pub mesh: &'a ClusteredMesh,
    /// Column-major; takes positions of the mesh to clip space, as the vertex shader does in float. If it is not finite,
    /// the whole object is listed and hides nothing.
    pub to_clip: [f32; 16],
    /// Back faces are not drawn.
    pub one_sided: bool,
    /// False for alpha-tested and transparent objects: hides nothing.
    pub hides: bool,
    /// By how much drawn vertices may be off, in units of the mesh, besides the rounding of `to_clip` times vertex.
    pub position_error: f32,
}

impl<'a> DepthObject<'a> {
    /// Returns an opaque object with two sides.
    pub fn new(mesh: &'a ClusteredMesh, to_clip: [f32; 16]) -> Self {
        DepthObject { mesh, to_clip, one_sided: false, hides: true, position_error: 0.0 }
    }
    fn raw(&self) -> sys::DepthObject {
        sys::DepthObject {
            mesh: self.mesh.raw,
            to_clip: self.to_clip,
            one_sided: self.one_sided as u32,
            hides: self.hides as u32,
            position_error: self.position_error,
            ..unsafe { sys::crofton_default_depth_object() }
        }
    }
}

/// Where an object of a camera's picture lies in a light's shadow map.
#[derive(Debug, Clone, Copy)]
pub struct DepthReceiver<'a> {
    /// That of the picture.
    pub mesh: &'a ClusteredMesh,
    /// Column-major; takes positions of the mesh to clip space of the map, as the shader does.
    pub to_map: [f32; 16],
    /// Anything within the mesh's bound may be seen, and not its triangles only.
    pub solid: bool,
}

/// Finds the triangles of pictures; keeps its buffers from picture to picture.
pub struct DepthCuller {
    raw: *mut sys::DepthCuller,
}

unsafe impl Send for DepthCuller {}
unsafe impl Sync for DepthCuller {}

impl Drop for DepthCuller {
    fn drop(&mut self) {
        unsafe { sys::crofton_depth_culler_destroy(self.raw) };
    }
}

impl DepthCuller {
    /// Returns a culler without a picture.
    pub fn new() -> Result<DepthCuller> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_depth_culler_create(&mut raw) })?;
        Ok(DepthCuller { raw })
    }
    /// Lists the triangles that the picture needs, by object, then by cluster. Drawn in the order in which you would draw
    /// all, they give the same picture, bit by bit.
    pub fn find_visible(
        &mut self, executor: Option<&dyn Executor>, objects: &[DepthObject], picture: &PictureView,
    ) -> Result<&[VisibleCluster]> {
        let raw: Vec<sys::DepthObject> = objects.iter().map(DepthObject::raw).collect();
        let (mut clusters, mut count, picture) = (ptr::null(), 0, raw_picture(picture));
        let (first, of, none) = (raw.as_ptr(), raw.len(), ptr::null_mut());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_depth_culler_find_visible(self.raw, first, of, &picture, jobs, &mut clusters, &mut count, none)
        }))?;
        Ok(unsafe { slice(clusters, count) })
    }
    /// Lists the triangles without which a shadow on what a camera sees would change. The casters' matrices take them
    /// to the shadow map. `seen` has found the camera's picture; there is one receiver for each object of that.
    /// `radius`: as in [`ShadowReceivers`](crate::ShadowReceivers).
    pub fn find_casters(
        &mut self, executor: Option<&dyn Executor>, casters: &[DepthObject], map: &PictureView, seen: &DepthCuller,
        receivers: &[DepthReceiver], radius: f64,
    ) -> Result<&[VisibleCluster]> {
        let raw: Vec<sys::DepthObject> = casters.iter().map(DepthObject::raw).collect();
        let objects: Vec<sys::DepthReceiver> = receivers
            .iter()
            .map(|r| sys::DepthReceiver { mesh: r.mesh.raw, to_map: r.to_map, solid: r.solid as u32 })
            .collect();
        let lookup = sys::DepthReceivers {
            size: size_of::<sys::DepthReceivers>(),
            seen: seen.raw,
            objects: objects.as_ptr(),
            object_count: objects.len(),
            radius,
        };
        let (mut clusters, mut count, map) = (ptr::null(), 0, raw_picture(map));
        let (first, of, none) = (raw.as_ptr(), raw.len(), ptr::null_mut());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_depth_culler_find_casters(
                self.raw,
                first,
                of,
                &map,
                &lookup,
                jobs,
                &mut clusters,
                &mut count,
                none,
            )
        }))?;
        Ok(unsafe { slice(clusters, count) })
    }
    /// Returns a lower bound of the nearness of the listed triangles at a pixel of the last picture: the depth, negated
    /// unless reversed, or minus infinity where nothing is proved to be. Row 0 is at the bottom.
    pub fn nearness(&self, x: u32, y: u32) -> Result<f32> {
        let mut nearness = 0.0;
        check(unsafe { sys::crofton_depth_culler_nearness(self.raw, x, y, &mut nearness) })?;
        Ok(nearness)
    }
}
