// SPDX-License-Identifier: MIT
//! Views that leave out what is hidden behind other objects.
use crate::error::{check, slice};
use crate::jobs::with_jobs;
use crate::{sys, Camera, Executor, Mesh, Object, Result, Seen, ViewResult, World};
use std::{mem::size_of, ptr};

/// How occluders are looked for in a mesh; 0 stands for the library's default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FindOptions {
    /// Back faces are drawn as well.
    pub is_two_sided: bool,
    /// At most so many.
    pub max_occluders: u32,
}

/// How hidden objects are found; 0 stands for the library's default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OcclusionOptions {
    /// Of the depth buffer, in pixels; 480.
    pub width: u32,
    /// Of the depth buffer, in pixels; 270.
    pub height: u32,
    /// Drawn into it; 256.
    pub max_occluders: u32,
    /// [`Seen::occluded_ids`] lists what is hidden.
    pub list_occluded: bool,
}

/// What it took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OcclusionStatistics {
    /// Occluders drawn into the depth buffer.
    pub occluders_drawn: u64,
    /// Objects asked.
    pub items_tested: u64,
    /// Of them hidden; more are hidden with whole nodes of the tree.
    pub items_hidden: u64,
}

impl World {
    /// Looks for occluders in a mesh, which takes a second or more for 100,000 triangles. They count from the next update on.
    pub fn find_occluders(&mut self, mesh: Mesh, options: &FindOptions) -> Result<()> {
        let mut raw: sys::FindOptions = unsafe { std::mem::zeroed() };
        raw.size = size_of::<sys::FindOptions>();
        raw.is_two_sided = options.is_two_sided as u32;
        raw.max_occluders = options.max_occluders;
        check(unsafe { sys::crofton_world_find_occluders(self.raw, mesh, &raw) })
    }

    /// How many occluders a mesh has.
    pub fn occluder_count(&self, mesh: Mesh) -> Result<usize> {
        let mut count = 0;
        check(unsafe { sys::crofton_world_occluder_count(self.raw, mesh, &mut count) })?;
        Ok(count)
    }

    /// Whether an object with a mesh hides others, as at first, or not, as where it is drawn transparent.
    pub fn set_occludes(&mut self, object: Object, occludes: bool) -> Result<()> {
        check(unsafe { sys::crofton_world_set_occludes(self.raw, object, occludes as i32) })
    }

    /// What a camera sees, without what is hidden; nothing visible is left out.
    pub fn view_occluding<'a>(
        &'a self, camera: &Camera, options: &OcclusionOptions, executor: Option<&dyn Executor>,
        visible: &'a mut ViewResult,
    ) -> Result<Seen<'a>> {
        let camera = camera.raw();
        let view = sys::OccludingView {
            size: size_of::<sys::OccludingView>(),
            camera: &camera,
            to_clip: ptr::null(),
            origin: [0.0; 3],
            depth: 0,
            hidden_layers: 0,
            limits: ptr::null(),
        };
        let occlusion = sys::OcclusionOptions {
            size: size_of::<sys::OcclusionOptions>(),
            disabled: 0,
            width: options.width,
            height: options.height,
            max_occluders: options.max_occluders,
            list_occluded: options.list_occluded as u32,
            least_cover: 0.0,
        };
        check(with_jobs(executor, |jobs| unsafe {
            sys::crofton_world_view_occluding(self.raw, &view, &occlusion, ptr::null(), jobs, visible.raw)
        }))?;
        Ok(Seen { world: self, visible })
    }
}

impl<'a> Seen<'a> {
    /// Indices of what is in the frustum and hidden, ascending; none unless [`OcclusionOptions::list_occluded`] asked.
    pub fn occluded_ids(&self) -> &'a [u32] {
        let (mut ids, mut count) = (ptr::null(), 0);
        unsafe {
            sys::crofton_visible_objects_occluded_ids(self.visible.raw, &mut ids, &mut count);
            slice(ids, count)
        }
    }

    /// All 0 after a view without occlusion.
    pub fn occlusion_statistics(&self) -> Result<OcclusionStatistics> {
        let mut s: sys::OcclusionStatistics = unsafe { std::mem::zeroed() };
        s.size = size_of::<sys::OcclusionStatistics>();
        check(unsafe { sys::crofton_visible_objects_get_occlusion_statistics(self.visible.raw, &mut s) })?;
        Ok(OcclusionStatistics {
            occluders_drawn: s.occluders_drawn,
            items_tested: s.items_tested,
            items_hidden: s.items_hidden,
        })
    }
}
