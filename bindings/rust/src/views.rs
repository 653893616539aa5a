// SPDX-License-Identifier: MIT
//! What views see of a [`World`].
use crate::error::{check, slice};
use crate::geometry::to_verdict;
use crate::jobs::with_jobs;
use crate::{sys, Executor, Frustum, Object, ObjectRef, Result, Verdict, World};
use std::{mem::size_of, ptr};

/// Memory for the answer to a view; keep it from frame to frame, and nothing is allocated once it is large enough.
pub struct ViewResult {
    pub(crate) raw: *mut sys::ViewResult,
}

unsafe impl Send for ViewResult {}
unsafe impl Sync for ViewResult {}

impl ViewResult {
    /// Room for nothing yet.
    pub fn new() -> Result<ViewResult> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_visible_objects_create(&mut raw) })?;
        Ok(ViewResult { raw })
    }
}

impl Drop for ViewResult {
    fn drop(&mut self) {
        unsafe { sys::crofton_visible_objects_destroy(self.raw) };
    }
}

/// What one view sees. Borrows the world, which cannot change meanwhile, and the memory of the answer.
///
/// ```compile_fail
/// # use crofton::{Camera, ViewResult, World};
/// # let mut world = World::new().unwrap();
/// # let mut visible = ViewResult::new().unwrap();
/// let seen = world.view(&Camera::default().frustum().unwrap(), &mut visible).unwrap();
/// world.update().unwrap(); // the world is borrowed
/// seen.ids();
/// ```
pub struct Seen<'a> {
    pub(crate) world: &'a World,
    pub(crate) visible: &'a ViewResult,
}

impl<'a> Seen<'a> {
    fn arrays(&self) -> (&'a [u32], Option<&'a [u8]>) {
        let (mut ids, mut count, mut verdicts) = (ptr::null(), 0, ptr::null());
        unsafe {
            sys::crofton_visible_objects_ids(self.visible.raw, &mut ids, &mut count, &mut verdicts, ptr::null_mut());
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
        check(unsafe {
            sys::crofton_visible_objects_list(self.visible.raw, self.world.raw, 0, objects.as_mut_ptr(), objects.len())
        })?;
        Ok(objects)
    }
}

/// As [`ViewResult`], for up to 32 views at once.
pub struct MultiViewResult {
    raw: *mut sys::MultiViewResult,
}

unsafe impl Send for MultiViewResult {}
unsafe impl Sync for MultiViewResult {}

impl MultiViewResult {
    /// Room for nothing yet.
    pub fn new() -> Result<MultiViewResult> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_visible_in_views_create(&mut raw) })?;
        Ok(MultiViewResult { raw })
    }
}

impl Drop for MultiViewResult {
    fn drop(&mut self) {
        unsafe { sys::crofton_visible_in_views_destroy(self.raw) };
    }
}

/// What several views see, each object once.
pub struct SeenInViews<'a> {
    world: &'a World,
    visible: &'a MultiViewResult,
}

impl SeenInViews<'_> {
    /// Objects, and for each of them the views that see it: bit v for view v.
    pub fn objects(&self) -> Result<Vec<(ObjectRef, u32)>> {
        let (mut ids, mut count) = (ptr::null(), 0);
        check(unsafe { sys::crofton_visible_in_views_ids(self.visible.raw, &mut ids, &mut count) })?;
        let mut objects = vec![no_object(); count];
        let mut masks = vec![0u32; count];
        check(unsafe {
            let (o, m) = (objects.as_mut_ptr(), masks.as_mut_ptr());
            sys::crofton_visible_in_views_list(self.visible.raw, self.world.raw, 0, o, m, count)
        })?;
        Ok(objects.into_iter().zip(masks).collect())
    }
}

impl World {
    /// What a view sees, by the objects' boxes, exactly: no visible box is left out.
    pub fn view<'a>(&'a self, frustum: &Frustum, visible: &'a mut ViewResult) -> Result<Seen<'a>> {
        self.view_layers(frustum, u32::MAX, None, visible)
    }

    /// The same for objects in any of `layers`, on several threads if told.
    pub fn view_layers<'a>(
        &'a self, frustum: &Frustum, layers: u32, executor: Option<&dyn Executor>, visible: &'a mut ViewResult,
    ) -> Result<Seen<'a>> {
        let view = to_view(frustum, layers);
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_world_view(self.raw, &view, ptr::null(), jobs, visible.raw)
        }))?;
        Ok(Seen { world: self, visible })
    }

    /// What up to 32 views see: frusta and the layers that each sees.
    pub fn views<'a>(&'a self, views: &[(Frustum, u32)], visible: &'a mut MultiViewResult) -> Result<SeenInViews<'a>> {
        let views: Vec<sys::View> = views.iter().map(|(f, layers)| to_view(f, *layers)).collect();
        check(unsafe { sys::crofton_world_views(self.raw, views.as_ptr(), views.len(), ptr::null(), visible.raw) })?;
        Ok(SeenInViews { world: self, visible })
    }
}

fn to_view(frustum: &Frustum, layers: u32) -> sys::View {
    sys::View { size: size_of::<sys::View>(), layer_mask: layers, frustum: frustum.raw }
}

fn no_object() -> ObjectRef {
    ObjectRef { object: Object { index: u32::MAX, generation: 0 }, user: 0 }
}
