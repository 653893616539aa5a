// SPDX-License-Identifier: MIT
//! Views with occlusion culling.
use crate::error::{check, slice};
use crate::views::view_info;
use crate::{sys, Mesh, Obb, Object, Result, Seen, SeenByMany, ViewResult, World};
use std::{mem::size_of, ptr};

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

/// Geometry by which a mesh's objects hide others, in the mesh's frame. It must be opaque and lie within the drawn mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Occluder<'a> {
    /// A box inside a closed piece of the mesh.
    Box(Obb),
    /// A box behind walls of the mesh; it may be open on some sides.
    Walled(Obb),
    /// The convex hull of points.
    Convex(&'a [[f32; 3]]),
    /// Any triangles, three indices each.
    Patch {
        /// The vertices.
        positions: &'a [[f32; 3]],
        /// Three for each triangle.
        indices: &'a [u32],
        /// It hides only from the side where its triangles are counter-clockwise.
        one_sided: bool,
    },
}

impl Occluder<'_> {
    fn raw(&self) -> sys::Occluder {
        let mut raw: sys::Occluder = unsafe { std::mem::zeroed() };
        raw.size = size_of::<sys::Occluder>();
        match *self {
            Occluder::Box(b) => (raw.kind, raw.bounding_box) = (sys::OCCLUDER_BOX, b),
            Occluder::Walled(b) => (raw.kind, raw.bounding_box) = (sys::OCCLUDER_WALLED, b),
            Occluder::Convex(points) => {
                raw.kind = sys::OCCLUDER_CONVEX;
                (raw.positions, raw.position_count) = (points.as_ptr().cast(), points.len());
            }
            Occluder::Patch { positions, indices, one_sided } => {
                (raw.kind, raw.is_one_sided) = (sys::OCCLUDER_PATCH, one_sided as u32);
                (raw.positions, raw.position_count) = (positions.as_ptr().cast(), positions.len());
                (raw.indices, raw.index_count) = (indices.as_ptr(), indices.len());
            }
        }
        raw
    }
}

/// An occluder of an object.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OccluderRef {
    /// The object.
    pub object: Object,
    /// The object's user number.
    pub user: u64,
    /// The place in the list of the mesh's occluders.
    pub place: u32,
    unused: u32,
}

/// The depth buffer of a view with occlusion.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthBuffer {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// Row by row from the bottom: the occluders' nearness, 1 / w (orthographic: minus the distance), or below -1e38 where
    /// nothing is drawn.
    pub nearness: Vec<f32>,
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

    /// Sets a mesh's occluders: none removes them. Nothing changes if one is refused; [`Error::item`](crate::Error) is its
    /// place.
    pub fn set_occluders(&mut self, mesh: Mesh, occluders: &[Occluder]) -> Result<()> {
        let raw: Vec<sys::Occluder> = occluders.iter().map(|o| o.raw()).collect();
        check(unsafe { sys::crofton_world_set_occluders(self.raw, mesh, raw.as_ptr(), raw.len()) })
    }

    /// Returns one of a mesh's occluders, given or found.
    pub fn occluder(&self, mesh: Mesh, place: usize) -> Result<Occluder<'_>> {
        let mut raw: sys::Occluder = unsafe { std::mem::zeroed() };
        raw.size = size_of::<sys::Occluder>();
        check(unsafe { sys::crofton_world_get_occluder(self.raw, mesh, place, &mut raw) })?;
        // The arrays are the world's: they live until its next change.
        let positions = unsafe { slice(raw.positions.cast(), raw.position_count) };
        Ok(match raw.kind {
            sys::OCCLUDER_BOX => Occluder::Box(raw.bounding_box),
            sys::OCCLUDER_WALLED => Occluder::Walled(raw.bounding_box),
            sys::OCCLUDER_CONVEX => Occluder::Convex(positions),
            _ => {
                let indices = unsafe { slice(raw.indices, raw.index_count) };
                Occluder::Patch { positions, indices, one_sided: raw.is_one_sided != 0 }
            }
        })
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

    /// Lists the occluders that hide an object, none if it is not hidden; `None`: all that were drawn, those that hide most
    /// first. Draws all occluders again for one object.
    pub fn occluders(&self, hidden: Option<Object>) -> Result<Vec<OccluderRef>> {
        let (result, world, mut count) = (self.result.raw, self.world.raw, 0);
        let hidden = hidden.as_ref().map_or(ptr::null(), |h| h as *const _);
        check(unsafe { sys::crofton_view_result_occluders(result, world, hidden, ptr::null_mut(), 0, &mut count) })?;
        let none = OccluderRef { object: Object { index: u32::MAX, generation: 0 }, user: 0, place: 0, unused: 0 };
        let mut list = vec![none; count];
        check(unsafe {
            sys::crofton_view_result_occluders(result, world, hidden, list.as_mut_ptr(), list.len(), &mut count)
        })?;
        Ok(list)
    }

    /// Copies the depth buffer. Error: the view had no occlusion.
    pub fn depth(&self) -> Result<DepthBuffer> {
        depth_of(self.result, 0)
    }

    /// Returns the counts; all 0 without occlusion.
    pub fn occlusion_statistics(&self) -> Result<OcclusionStatistics> {
        Ok(statistics_of(&self.info()?))
    }
}

impl SeenByMany<'_> {
    /// The same as [`Seen::depth`], of one view.
    pub fn depth(&self, view: usize) -> Result<DepthBuffer> {
        depth_of(self.result, view)
    }
}

fn depth_of(result: &ViewResult, view: usize) -> Result<DepthBuffer> {
    let info = view_info(result, view)?;
    let (width, height) = (info.depth_width as usize, info.depth_height as usize);
    let mut nearness = vec![0.0; width * height];
    check(unsafe { sys::crofton_view_result_depth(result.raw, view, nearness.as_mut_ptr(), nearness.len()) })?;
    Ok(DepthBuffer { width, height, nearness })
}
