// SPDX-License-Identifier: MIT
//! Meshes cut into clusters, and the triangles that a picture of them needs, without a World.
use crate::error::{check, slice};
use crate::jobs::with_jobs;
use crate::shape::raw_mesh;
use crate::views::raw_picture;
use crate::{sys, ClusterBox, Clusters, Executor, PictureView, Result, VisibleCluster};
use std::ptr;

/// A mesh cut into clusters. It never changes. [`MeshData::precut`](crate::MeshData) gives it to a World.
#[derive(Debug)]
pub struct ClusteredMesh {
    pub(crate) raw: *mut sys::ClusteredMesh,
}

// It never changes.
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
        Ok(ClusteredMesh { raw })
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
        let raw: Vec<sys::DepthObject> = objects
            .iter()
            .map(|object| sys::DepthObject {
                mesh: object.mesh.raw,
                to_clip: object.to_clip,
                one_sided: object.one_sided as u32,
                hides: object.hides as u32,
                ..unsafe { sys::crofton_default_depth_object() }
            })
            .collect();
        let (mut clusters, mut count, picture) = (ptr::null(), 0, raw_picture(picture));
        let (first, of, none) = (raw.as_ptr(), raw.len(), ptr::null_mut());
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_depth_culler_find_visible(self.raw, first, of, &picture, jobs, &mut clusters, &mut count, none)
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
