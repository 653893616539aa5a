// SPDX-License-Identifier: MIT
//! What views see of a [`World`].
use crate::error::{check, slice};
use crate::geometry::to_verdict;
use crate::jobs::with_jobs;
use crate::occlusion::raw_occlusion;
use crate::{sys, Camera, DepthRange, Executor, Frustum, Object, ObjectRef, OcclusionOptions, Result, Verdict, World};
use std::{mem::size_of, ptr};

/// An engine's own matrix, from positions relative to `origin` to clip space, for column vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewMatrix {
    /// Column by column.
    pub to_clip: [f64; 16],
    /// Which depths it gives.
    pub depth: DepthRange,
    /// What positions are relative to.
    pub origin: [f64; 3],
}

/// What a view asks: where it looks from, and what it lists.
#[derive(Clone)]
pub struct ViewRequest<'a> {
    /// Set a camera,
    pub camera: Option<Camera>,
    /// an engine's own matrix,
    pub matrix: Option<ViewMatrix>,
    /// or any convex volume. For occlusion set a camera or a matrix as well: objects are tested against the volume
    /// instead of theirs.
    pub volume: Option<Frustum>,
    /// Lists objects that share a layer with these.
    pub layers: u32,
    /// If set, leaves out objects that others hide; never one that is seen.
    pub occlusion: Option<OcclusionOptions>,
    /// If not empty, bit i % 64 of word i / 64: may the object with index i be seen?
    pub candidate_mask: &'a [u64],
}

impl Default for ViewRequest<'_> {
    /// All layers, no occlusion; where the view looks from is to be set.
    fn default() -> Self {
        ViewRequest { camera: None, matrix: None, volume: None, layers: u32::MAX, occlusion: None, candidate_mask: &[] }
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
        raw
    }
}

/// Memory for the answer to one view or to many; keep it from frame to frame, and nothing is allocated once it is
/// large enough.
pub struct ViewResult {
    pub(crate) raw: *mut sys::ViewResult,
}

unsafe impl Send for ViewResult {}
unsafe impl Sync for ViewResult {}

impl ViewResult {
    /// Room for nothing yet.
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

/// What one view sees. Borrows the world, which cannot change meanwhile, and the memory of the answer.
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
    /// The objects' indices, ascending.
    pub fn ids(&self) -> &'a [u32] {
        self.arrays().0
    }
    /// Straddling or inside, for each of [`Seen::ids`].
    pub fn verdicts(&self) -> Vec<Verdict> {
        self.arrays().1.unwrap_or(&[]).iter().map(|&v| to_verdict(v)).collect()
    }
    /// Handles and the caller's numbers, in the order of [`Seen::ids`].
    pub fn objects(&self) -> Result<Vec<ObjectRef>> {
        let mut objects = vec![no_object(); self.ids().len()];
        let (o, masks, count) = (objects.as_mut_ptr(), ptr::null_mut(), objects.len());
        check(unsafe { sys::crofton_view_result_list(self.result.raw, self.world.raw, 0, o, masks, count) })?;
        Ok(objects)
    }
}

/// What several views see, each object once.
pub struct SeenByMany<'a> {
    world: &'a World,
    result: &'a ViewResult,
}

impl SeenByMany<'_> {
    /// Objects, and for each of them the views that see it: bit v for view v.
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

impl World {
    /// What a view sees, by the objects' boxes, exactly: no visible box is left out.
    pub fn view<'a>(&'a self, request: &ViewRequest, result: &'a mut ViewResult) -> Result<Seen<'a>> {
        self.view_on(None, request, result)
    }

    /// The same on the executor's threads.
    pub fn view_on<'a>(
        &'a self, executor: Option<&dyn Executor>, request: &ViewRequest, result: &'a mut ViewResult,
    ) -> Result<Seen<'a>> {
        let raw = Asked::new(request);
        let raw = raw.raw();
        check(with_jobs(executor, |jobs| unsafe { sys::crofton_world_view(self.raw, &raw, jobs, result.raw) }))?;
        Ok(Seen { world: self, result })
    }

    /// What up to 32 views see, each with its own options.
    pub fn view_many<'a>(
        &'a self, executor: Option<&dyn Executor>, requests: &[ViewRequest], result: &'a mut ViewResult,
    ) -> Result<SeenByMany<'a>> {
        let asked: Vec<Asked> = requests.iter().map(Asked::new).collect();
        let raw: Vec<sys::ViewRequest> = asked.iter().map(|a| a.raw()).collect();
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_world_view_many(self.raw, raw.as_ptr(), raw.len(), jobs, result.raw)
        }))?;
        Ok(SeenByMany { world: self, result })
    }
}

fn pointer<T>(value: &Option<T>) -> *const T {
    value.as_ref().map_or(ptr::null(), |v| v)
}

fn no_object() -> ObjectRef {
    ObjectRef { object: Object { index: u32::MAX, generation: 0 }, user: 0 }
}
