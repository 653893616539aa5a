// SPDX-License-Identifier: MIT
//! Views with occlusion culling.
use crate::error::{check, slice};
use crate::{sys, Mesh, Object, Result, Seen, World};

/// Options for finding occluders in a mesh; 0 stands for the library's default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FindOptions {
    /// Back faces are drawn as well.
    pub is_two_sided: bool,
    /// The largest number of occluders.
    pub max_occluders: u32,
}

/// Options of occlusion culling; 0 stands for the library's default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OcclusionOptions {
    /// The width of the depth buffer in pixels; 480.
    pub width: u32,
    /// The height of the depth buffer in pixels; 270.
    pub height: u32,
    /// Draws at most this many occluders, those that hide most; 256.
    pub max_occluders: u32,
    /// Lists hidden objects in [`Seen::occluded_ids`].
    pub list_occluded: bool,
    /// Does not draw occluders that cover a smaller part of the sphere of directions; 2e-5.
    pub least_cover: f32,
}

/// Counts of a view with occlusion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OcclusionStatistics {
    /// Occluders drawn into the depth buffer.
    pub occluders_drawn: u64,
    /// Objects tested.
    pub items_tested: u64,
    /// Tested objects that are hidden; others are hidden with whole nodes of the tree.
    pub items_hidden: u64,
}

impl World {
    /// Searches a mesh for occluders, which the next update applies. Takes a second or more for 100,000 triangles.
    pub fn find_occluders(&mut self, mesh: Mesh, options: &FindOptions) -> Result<()> {
        let mut raw = unsafe { sys::crofton_default_find_options() };
        raw.is_two_sided = options.is_two_sided as u32;
        raw.max_occluders = options.max_occluders;
        check(unsafe { sys::crofton_world_find_occluders(self.raw, mesh, &raw) })
    }

    /// Returns the number of a mesh's occluders.
    pub fn occluder_count(&self, mesh: Mesh) -> Result<usize> {
        Ok(self.mesh_info(mesh)?.occluder_count)
    }

    /// Sets whether an object with a mesh hides others. The default is true; use false for transparent objects.
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
    /// Returns the indices of objects in the frustum that are hidden, ascending; empty without
    /// [`OcclusionOptions::list_occluded`].
    pub fn occluded_ids(&self) -> &'a [u32] {
        self.info().map_or(&[], |info| unsafe { slice(info.occluded_ids, info.occluded_count) })
    }

    /// Returns the counts; all 0 without occlusion.
    pub fn occlusion_statistics(&self) -> Result<OcclusionStatistics> {
        Ok(statistics_of(&self.info()?))
    }
}
