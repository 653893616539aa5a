// SPDX-License-Identifier: MIT
//! Views of a [`World`].
use crate::error::{check, slice, wrong};
use crate::geometry::to_verdict;
use crate::jobs::with_jobs;
use crate::occlusion::{raw_occlusion, statistics_of};
use crate::{sys, Camera, DepthRange, Executor, Frustum, Mesh, Obb, Object, ObjectRef};
use crate::{OcclusionOptions, OcclusionStatistics, Result, Verdict, World};
use std::{mem::size_of, ptr};

/// Your engine's matrix, from positions relative to `origin` to clip space, for column vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewMatrix {
    /// Column-major.
    pub to_clip: [f64; 16],
    /// The depth range of the matrix.
    pub depth: DepthRange,
    /// The point that positions are relative to.
    pub origin: [f64; 3],
}

/// The request of a view.
#[derive(Clone)]
pub struct ViewRequest<'a> {
    /// Set a camera,
    pub camera: Option<Camera>,
    /// your engine's matrix,
    pub matrix: Option<ViewMatrix>,
    /// or any convex volume. For occlusion also set a camera or a matrix; objects are then tested against the volume
    /// instead of its frustum.
    pub volume: Option<Frustum>,
    /// Lists objects that share a layer with these.
    pub layers: u32,
    /// If set, leaves out objects that others hide.
    pub occlusion: Option<OcclusionOptions>,
    /// If set, lists the triangles that this picture needs: [`Seen::triangles`]. Use it instead of
    /// `occlusion`.
    pub picture: Option<PictureView>,
    /// If set, `picture` is the shadow map of a light, and only the triangles are listed without which a shadow on what
    /// a camera sees would change.
    pub receivers: Option<ShadowReceivers<'a>>,
    /// If set, leaves out objects that are too small or too far away.
    pub limits: Option<&'a DrawLimits<'a>>,
    /// If not empty, bit i % 64 of word i / 64 says whether the object with index i may be seen. Objects that have
    /// moved since
    /// their first update may always be seen.
    pub candidate_mask: &'a [u64],
    /// Tests planes only, which keeps some boxes near the volume's corners.
    pub conservative: bool,
    /// Lists objects in the order of the tree in memory instead of ascending; faster where much is seen.
    pub tree_order: bool,
}

/// The picture that you draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureView {
    /// In pixels, 1 to 16,384.
    pub width: u32,
    /// In pixels, 1 to 16,384.
    pub height: u32,
    /// The depth range of the projection; with a [`ViewMatrix`], the same as its.
    pub depth: DepthRange,
    /// 1 in each pixel, at its centre; 2, 4 or 8: for multisampling, at Vulkan's standard locations.
    pub samples: u32,
    /// 0 for no limit. Otherwise a number of clusters that are tested and of triangles that are drawn, together; what is
    /// left after that is listed whole unless its box is hidden.
    pub work_limit: u64,
}

/// What a camera sees, for the view of a light.
///
/// ```no_run
/// # use crofton::*;
/// # fn draw(_: VisibleCluster) {}
/// # fn draw_shadows(world: &World, camera: Camera, sun: Camera) -> Result<()> {
/// let size = |width, height| PictureView { width, height, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 };
/// let (mut visible, mut casters) = (ViewResult::new()?, ViewResult::new()?); // kept from frame to frame
/// let request = ViewRequest { picture: Some(size(1280, 720)), ..camera.into() };
/// let seen = world.view(&request, &mut visible)?;
/// let receivers = Some(ShadowReceivers { seen: &seen, radius: 2.0 });
/// let request = ViewRequest { picture: Some(size(2048, 2048)), receivers, ..sun.into() };
/// world.view(&request, &mut casters)?.triangles()?.iter().for_each(|&cluster| draw(cluster));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy)]
pub struct ShadowReceivers<'a> {
    /// The answer to the camera's view, which had a picture.
    pub seen: &'a Seen<'a>,
    /// 0.5 to 1024: a lookup reads texels whose centres are at most this far from its point along each axis. 0.5 for the
    /// nearest texel, 1 for a bilinear comparison, r + 1 for one in each of (2 r + 1)^2 texels.
    pub radius: f64,
}

/// Limits that leave out objects that are too small or too far away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawLimits<'a> {
    /// The point that distances are measured from.
    pub eye: [f64; 3],
    /// Leaves out what is farther than this times its radius; infinite: no limit.
    pub max_distance_in_radii: f64,
    /// Leaves out what is smaller.
    pub least_radius: f64,
    /// By layer: leaves out what is farther than the distances of all its layers.
    pub layer_distances: Option<&'a [f32; 32]>,
    /// By object index: leaves out what is farther.
    pub item_distances: &'a [f32],
    /// Bit i % 64 of word i / 64 says whether the object with index i was drawn before.
    pub drawn_before: &'a [u64],
    /// Limits of objects that were drawn before are this many times as long; at least 1.
    pub hysteresis: f64,
}

impl DrawLimits<'_> {
    /// Returns limits that leave out nothing.
    pub fn new(eye: [f64; 3]) -> Self {
        DrawLimits {
            eye,
            max_distance_in_radii: f64::INFINITY,
            least_radius: 0.0,
            layer_distances: None,
            item_distances: &[],
            drawn_before: &[],
            hysteresis: 1.0,
        }
    }
    /// Returns limits that leave out what is less than `pixels` wide in a picture `picture_height` pixels high.
    pub fn of_camera(camera: &Camera, picture_height: f64, pixels: f64) -> Result<Self> {
        let mut raw = unsafe { sys::crofton_default_draw_limits() };
        check(unsafe { sys::crofton_draw_limits_of_camera(&camera.raw(), picture_height, pixels, &mut raw) })?;
        Ok(DrawLimits {
            max_distance_in_radii: raw.max_distance_in_radii,
            least_radius: raw.least_radius,
            ..DrawLimits::new(raw.eye)
        })
    }
    fn raw(&self) -> sys::DrawLimits {
        let mut raw = unsafe { sys::crofton_default_draw_limits() };
        raw.eye = self.eye;
        if self.max_distance_in_radii.is_finite() {
            raw.max_distance_in_radii = self.max_distance_in_radii;
        }
        raw.least_radius = self.least_radius;
        raw.layer_distances = self.layer_distances.map_or(ptr::null(), |d| d.as_ptr());
        raw.item_distances = self.item_distances.as_ptr();
        raw.item_count = self.item_distances.len();
        raw.drawn_before = self.drawn_before.as_ptr();
        raw.drawn_word_count = self.drawn_before.len();
        raw.hysteresis = self.hysteresis;
        raw
    }
}

/// A cluster with triangles to draw. Bit k of `triangles` stands for triangle `first_triangle + k` of the cluster.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VisibleCluster {
    /// The object's index.
    pub object: u32,
    /// The index in [`Clusters::clusters`].
    pub cluster: u32,
    /// At least one bit is set.
    pub triangles: u64,
}

/// Contains a cluster's triangles, in the mesh's coordinates.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterBox {
    /// The center of the box.
    pub center: [f32; 3],
    /// The corners of the box are the center plus or minus each of the three.
    pub half_edges: [[f32; 3]; 3],
}

/// A group of neighbouring triangles.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster {
    /// The first triangle in [`Clusters::triangle_order`].
    pub first_triangle: u32,
    /// 1 to 64.
    pub triangle_count: u32,
}

/// A mesh cut into clusters.
#[derive(Debug, Clone, Copy)]
pub struct Clusters<'a> {
    /// Each is one range of the order.
    pub clusters: &'a [Cluster],
    /// Permute the index buffer that you draw by this order: its k-th triangle is triangle `triangle_order[k]` of the
    /// mesh.
    pub triangle_order: &'a [u32],
}

impl Clusters<'_> {
    /// Returns a mesh's indices in the order of its clusters, so that each cluster is one range of an index buffer.
    pub fn permute(&self, indices: &[u32]) -> Result<Vec<u32>> {
        let raw = sys::Clusters {
            clusters: self.clusters.as_ptr(),
            cluster_count: self.clusters.len(),
            triangle_order: self.triangle_order.as_ptr(),
            triangle_count: self.triangle_order.len(),
        };
        let mut permuted = vec![0; indices.len()];
        let (from, count) = (indices.as_ptr(), indices.len());
        check(unsafe { sys::crofton_permute_triangles(&raw, from, count, permuted.as_mut_ptr()) })?;
        Ok(permuted)
    }
    /// # Safety
    /// The arrays live as long as the result.
    pub(crate) unsafe fn of(raw: &sys::Clusters) -> Self {
        Clusters {
            clusters: slice(raw.clusters, raw.cluster_count),
            triangle_order: slice(raw.triangle_order, raw.triangle_count),
        }
    }
}

impl Default for ViewRequest<'_> {
    /// Returns a request for all layers without occlusion; set camera, matrix or volume.
    fn default() -> Self {
        ViewRequest {
            camera: None,
            matrix: None,
            volume: None,
            layers: u32::MAX,
            occlusion: None,
            picture: None,
            receivers: None,
            limits: None,
            candidate_mask: &[],
            conservative: false,
            tree_order: false,
        }
    }
}
impl From<Camera> for ViewRequest<'_> {
    fn from(camera: Camera) -> Self {
        ViewRequest { camera: Some(camera), ..Default::default() }
    }
}
impl From<Frustum> for ViewRequest<'_> {
    fn from(volume: Frustum) -> Self {
        ViewRequest { volume: Some(volume), ..Default::default() }
    }
}

// What a request points to, while a call looks at it.
struct Asked<'a> {
    request: &'a ViewRequest<'a>,
    camera: Option<sys::Camera>,
    matrix: Option<sys::ViewMatrix>,
    occlusion: Option<sys::OcclusionOptions>,
    picture: Option<sys::PictureView>,
    receivers: Option<sys::ShadowReceivers>,
    limits: Option<sys::DrawLimits>,
}

impl<'a> Asked<'a> {
    fn new(request: &'a ViewRequest<'a>) -> Asked<'a> {
        Asked {
            request,
            camera: request.camera.as_ref().map(|c| c.raw()),
            matrix: request.matrix.as_ref().map(|m| sys::ViewMatrix {
                size: size_of::<sys::ViewMatrix>(),
                doubles: m.to_clip.as_ptr(),
                floats: ptr::null(),
                is_row_major: 0,
                depth: m.depth as u32,
                origin: m.origin,
            }),
            occlusion: request.occlusion.as_ref().map(raw_occlusion),
            picture: request.picture.as_ref().map(raw_picture),
            receivers: request.receivers.map(|r| sys::ShadowReceivers {
                size: size_of::<sys::ShadowReceivers>(),
                seen: r.seen.result.raw,
                radius: r.radius,
            }),
            limits: request.limits.map(|l| l.raw()),
        }
    }
    fn raw(&self) -> sys::ViewRequest {
        let mut raw = unsafe { sys::crofton_default_view_request() };
        raw.camera = pointer(&self.camera);
        raw.matrix = pointer(&self.matrix);
        raw.volume = self.request.volume.as_ref().map_or(ptr::null(), |v| &v.raw);
        raw.layers = self.request.layers;
        raw.occlusion = pointer(&self.occlusion);
        raw.candidate_mask = self.request.candidate_mask.as_ptr();
        raw.candidate_words = self.request.candidate_mask.len();
        raw.picture = pointer(&self.picture);
        raw.receivers = pointer(&self.receivers);
        raw.limits = pointer(&self.limits);
        raw.conservative = self.request.conservative as u32;
        raw.tree_order = self.request.tree_order as u32;
        raw
    }
}

/// The answer to one view or many. Reuse it from frame to frame: nothing is allocated once it is
/// large enough.
pub struct ViewResult {
    pub(crate) raw: *mut sys::ViewResult,
}

unsafe impl Send for ViewResult {}
unsafe impl Sync for ViewResult {}

impl ViewResult {
    /// Returns an empty answer.
    pub fn new() -> Result<ViewResult> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_view_result_create(&mut raw) })?;
        Ok(ViewResult { raw })
    }
}

impl Drop for ViewResult {
    fn drop(&mut self) {
        unsafe { sys::crofton_view_result_destroy(self.raw) };
    }
}

/// The answer of one view. It borrows the world and the memory of the result.
///
/// ```compile_fail
/// # use crofton::{Camera, ViewResult, World};
/// # let mut world = World::new().unwrap();
/// # let mut result = ViewResult::new().unwrap();
/// let seen = world.view(&Camera::default().into(), &mut result).unwrap();
/// world.update().unwrap(); // the world is borrowed
/// seen.ids();
/// ```
pub struct Seen<'a> {
    pub(crate) world: &'a World,
    pub(crate) result: &'a ViewResult,
}

impl<'a> Seen<'a> {
    fn arrays(&self) -> (&'a [u32], Option<&'a [u8]>) {
        let (mut ids, mut count, mut verdicts) = (ptr::null(), 0, ptr::null());
        unsafe {
            sys::crofton_view_result_ids(self.result.raw, &mut ids, &mut count, &mut verdicts, ptr::null_mut());
            (slice(ids, count), (!verdicts.is_null()).then(|| slice(verdicts, count)))
        }
    }
    pub(crate) fn info(&self) -> Result<sys::ViewInfo> {
        view_info(self.result, 0)
    }
    /// Returns the triangles to draw, by object, then by cluster, for a view with a picture.
    pub fn triangles(&self) -> Result<&'a [VisibleCluster]> {
        let info = self.info()?;
        Ok(unsafe { slice(info.triangles, info.triangle_cluster_count) })
    }
    /// Returns the objects' indices, ascending unless tree order was requested.
    pub fn ids(&self) -> &'a [u32] {
        self.arrays().0
    }
    /// Returns how many of [`Seen::ids`] lie inside the view as a whole. In tree order they are the first.
    pub fn inside_count(&self) -> usize {
        let (mut ids, mut count, mut inside) = (ptr::null(), 0, 0);
        unsafe {
            sys::crofton_view_result_ids(self.result.raw, &mut ids, &mut count, ptr::null_mut(), &mut inside);
        }
        inside
    }
    /// Returns a verdict, straddling or inside, for each of [`Seen::ids`].
    pub fn verdicts(&self) -> Vec<Verdict> {
        self.arrays().1.unwrap_or(&[]).iter().map(|&v| to_verdict(v)).collect()
    }
    /// Returns handles and user numbers in the order of [`Seen::ids`].
    pub fn objects(&self) -> Result<Vec<ObjectRef>> {
        let mut objects = vec![no_object(); self.ids().len()];
        let (o, masks, count) = (objects.as_mut_ptr(), ptr::null_mut(), objects.len());
        check(unsafe { sys::crofton_view_result_list(self.result.raw, self.world.raw, 0, o, masks, count) })?;
        Ok(objects)
    }
}

/// The answer of several views, each object once.
pub struct SeenByMany<'a> {
    world: &'a World,
    pub(crate) result: &'a ViewResult,
}

impl<'a> SeenByMany<'a> {
    /// Returns the triangles to draw in one view, as [`Seen::triangles`].
    pub fn triangles(&self, view: usize) -> Result<&'a [VisibleCluster]> {
        let info = view_info(self.result, view)?;
        Ok(unsafe { slice(info.triangles, info.triangle_cluster_count) })
    }
    /// The same as [`Seen::occluded_ids`], of one view.
    pub fn occluded_ids(&self, view: usize) -> Result<&'a [u32]> {
        let info = view_info(self.result, view)?;
        Ok(unsafe { slice(info.occluded_ids, info.occluded_count) })
    }
    /// The same as [`Seen::occlusion_statistics`], of one view.
    pub fn occlusion_statistics(&self, view: usize) -> Result<OcclusionStatistics> {
        Ok(statistics_of(&view_info(self.result, view)?))
    }
    /// Returns the objects, and for each the views that see it: bit v for view v.
    pub fn objects(&self) -> Result<Vec<(ObjectRef, u32)>> {
        let (mut ids, mut count) = (ptr::null(), 0);
        check(unsafe {
            let raw = self.result.raw;
            sys::crofton_view_result_ids(raw, &mut ids, &mut count, ptr::null_mut(), ptr::null_mut())
        })?;
        let mut objects = vec![no_object(); count];
        let mut masks = vec![0u32; count];
        let (o, m) = (objects.as_mut_ptr(), masks.as_mut_ptr());
        check(unsafe { sys::crofton_view_result_list(self.result.raw, self.world.raw, 0, o, m, count) })?;
        Ok(objects.into_iter().zip(masks).collect())
    }
}

/// Lists the boxes of a slice that a view sees, exactly, without a World; `layers`: one mask for each, or none. Error: a request with
/// occlusion or a picture. Allocates nothing once `result` has held as many.
///
/// ```
/// use crofton::{view_boxes, Camera, Obb, ViewResult};
/// # fn main() -> Result<(), crofton::Error> {
/// let boxes = [[0.0, 0.0, -5.0], [0.0, 0.0, 5.0]].map(|center| Obb::aligned(center, [1.0; 3]));
/// assert_eq!(view_boxes(&boxes, None, &Camera::default().into(), &mut ViewResult::new()?)?, [0]);
/// # Ok(()) }
/// ```
pub fn view_boxes<'a>(
    boxes: &[Obb], layers: Option<&[u32]>, request: &ViewRequest, result: &'a mut ViewResult,
) -> Result<&'a [u32]> {
    if layers.map_or(false, |l| l.len() != boxes.len()) {
        return Err(wrong("the two slices are to be of one length"));
    }
    let asked = Asked::new(request);
    let (layers, count, raw) = (layers.map_or(ptr::null(), |l| l.as_ptr()), boxes.len(), asked.raw());
    check(unsafe { sys::crofton_view_boxes(boxes.as_ptr(), layers, count, &raw, ptr::null(), result.raw) })?;
    let (mut ids, mut count) = (ptr::null(), 0);
    check(unsafe { sys::crofton_view_result_ids(result.raw, &mut ids, &mut count, ptr::null_mut(), ptr::null_mut()) })?;
    Ok(unsafe { slice(ids, count) })
}

impl World {
    /// Lists the objects whose boxes a view sees, exactly: no visible box is left out.
    pub fn view<'a>(&'a self, request: &ViewRequest, result: &'a mut ViewResult) -> Result<Seen<'a>> {
        self.view_on(None, request, result)
    }

    /// Does the same on the executor's threads.
    pub fn view_on<'a>(
        &'a self, executor: Option<&dyn Executor>, request: &ViewRequest, result: &'a mut ViewResult,
    ) -> Result<Seen<'a>> {
        let raw = Asked::new(request);
        let raw = raw.raw();
        check(with_jobs(executor, |jobs| unsafe { sys::crofton_world_view(self.raw, &raw, 1, jobs, result.raw) }))?;
        Ok(Seen { world: self, result })
    }

    /// Answers up to 32 views, each with its own options.
    pub fn view_many<'a>(
        &'a self, executor: Option<&dyn Executor>, requests: &[ViewRequest], result: &'a mut ViewResult,
    ) -> Result<SeenByMany<'a>> {
        let asked: Vec<Asked> = requests.iter().map(Asked::new).collect();
        let raw: Vec<sys::ViewRequest> = asked.iter().map(|a| a.raw()).collect();
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_world_view(self.raw, raw.as_ptr(), raw.len(), jobs, result.raw)
        }))?;
        Ok(SeenByMany { world: self, result })
    }
}

impl World {
    /// Returns the clusters of a mesh with [`MeshData::clusters`](crate::MeshData::clusters), as of the last update.
    pub fn clusters_of(&self, mesh: Mesh) -> Result<Option<Clusters<'_>>> {
        let raw = self.mesh_info(mesh)?.clusters;
        Ok((raw.cluster_count > 0).then(|| unsafe { Clusters::of(&raw) }))
    }
}

pub(crate) fn raw_picture(p: &PictureView) -> sys::PictureView {
    sys::PictureView {
        size: size_of::<sys::PictureView>(),
        width: p.width,
        height: p.height,
        depth: p.depth as u32,
        samples: p.samples,
        work_limit: p.work_limit,
    }
}

pub(crate) fn view_info(result: &ViewResult, view: usize) -> Result<sys::ViewInfo> {
    let mut info: sys::ViewInfo = unsafe { std::mem::zeroed() };
    info.size = size_of::<sys::ViewInfo>();
    check(unsafe { sys::crofton_view_result_get_view(result.raw, view, &mut info) })?;
    Ok(info)
}

fn pointer<T>(value: &Option<T>) -> *const T {
    value.as_ref().map_or(ptr::null(), |v| v)
}

fn no_object() -> ObjectRef {
    ObjectRef { object: Object { index: u32::MAX, generation: 0 }, user: 0 }
}
