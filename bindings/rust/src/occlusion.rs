// SPDX-License-Identifier: MIT
//! Views that leave out what is hidden behind other objects.
use crate::error::{check, slice};
use crate::{sys, Mesh, Object, Result, Seen, World};

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
    /// What covers a smaller part of the sphere of directions is not drawn; 2e-5.
    pub least_cover: f32,
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
        let mut raw = unsafe { sys::crofton_default_find_options() };
        raw.is_two_sided = options.is_two_sided as u32;
        raw.max_occluders = options.max_occluders;
        check(unsafe { sys::crofton_world_find_occluders(self.raw, mesh, &raw) })
    }

    /// How many occluders a mesh has.
    pub fn occluder_count(&self, mesh: Mesh) -> Result<usize> {
        Ok(self.mesh_info(mesh)?.occluder_count)
    }

    /// Whether an object with a mesh hides others, as at first, or not, as where it is drawn transparent.
    pub fn set_occludes(&mut self, object: Object, occludes: bool) -> Result<()> {
        self.set(object, sys::SET_OCCLUDES, |d| d.occludes = occludes as u32)
    }
}

pub(crate) fn raw_occlusion(options: &OcclusionOptions) -> sys::OcclusionOptions {
    let mut raw = unsafe { sys::crofton_default_occlusion_options() };
    if options.width != 0 {
        raw.width = options.width;
    }
    if options.height != 0 {
        raw.height = options.height;
    }
    if options.max_occluders != 0 {
        raw.max_occluders = options.max_occluders;
    }
    if options.least_cover != 0.0 {
        raw.least_cover = options.least_cover;
    }
    raw.list_occluded = options.list_occluded as u32;
    raw
}

pub(crate) fn statistics_of(info: &sys::ViewInfo) -> OcclusionStatistics {
    OcclusionStatistics {
        occluders_drawn: info.occluders_drawn,
        items_tested: info.occlusion_items_tested,
        items_hidden: info.occlusion_items_hidden,
    }
}

impl<'a> Seen<'a> {
    /// Indices of what is in the frustum and hidden, ascending; none unless [`OcclusionOptions::list_occluded`] asked.
    pub fn occluded_ids(&self) -> &'a [u32] {
        self.info().map_or(&[], |info| unsafe { slice(info.occluded_ids, info.occluded_count) })
    }

    /// All 0 after a view without occlusion.
    pub fn occlusion_statistics(&self) -> Result<OcclusionStatistics> {
        Ok(statistics_of(&self.info()?))
    }
}
