// SPDX-License-Identifier: MIT
use crate::error::check;
use crate::{sys, Camera, Obb, Result};
use std::{mem::size_of, os::raw::c_void, ptr};

/// The quantity that a box minimises: volume_weight V + area_weight F + mean_curvature_weight M. Weights are at least 0
/// and not all 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// The weight of the volume.
    pub volume_weight: f64,
    /// The weight of the surface area.
    pub area_weight: f64,
    /// The weight of the integral of mean curvature; for a box, that is pi times the sum of its three sides.
    pub mean_curvature_weight: f64,
}

impl Criterion {
    fn zero() -> Criterion {
        Criterion { volume_weight: 0.0, area_weight: 0.0, mean_curvature_weight: 0.0 }
    }
    /// The sum of the edges: for frusta that are large compared with the objects.
    pub fn minimal_perimeter() -> Criterion {
        unsafe { sys::crofton_default_fit_options() }.criterion
    }
    /// Minimises the expected number of boxes in the camera's frustum; its far distance must be finite.
    pub fn for_frustum(camera: &Camera) -> Result<Criterion> {
        let mut criterion = Criterion::zero();
        check(unsafe { sys::crofton_criterion_for_frustum(&camera.raw(), &mut criterion) })?;
        Ok(criterion)
    }
    /// Minimises the expected number of hits by rays and segments of this length.
    pub fn for_rays(length: f64) -> Result<Criterion> {
        let mut criterion = Criterion::zero();
        check(unsafe { sys::crofton_criterion_for_rays(length, &mut criterion) })?;
        Ok(criterion)
    }
}

/// The effort to fit a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// One or two passes over the points.
    Fast = 0,
    /// Convex hull and local search.
    Tight = 1,
    /// The global optimum.
    Exact = 2,
}

/// The points to fit a box around.
#[derive(Debug, Clone, Copy)]
pub enum Points<'a> {
    /// x, y, z of each point.
    F32(&'a [[f32; 3]]),
    /// x, y, z of each point.
    F64(&'a [[f64; 3]]),
}

/// Returns a box that contains every point, the best by `criterion`.
pub fn fit(points: Points, quality: Quality, criterion: &Criterion) -> Result<Obb> {
    let options =
        sys::FitOptions { size: size_of::<sys::FitOptions>(), quality: quality as u32, criterion: *criterion };
    let mut result = Obb::aligned([0.0; 3], [0.0; 3]);
    let (numbers, count, is_double) = match points {
        Points::F32(p) => (p.as_ptr() as *const c_void, p.len(), 0),
        Points::F64(p) => (p.as_ptr() as *const c_void, p.len(), 1),
    };
    check(unsafe { sys::crofton_fit_points(numbers, count, is_double, &options, &mut result) })?;
    Ok(result)
}

/// Returns a box that contains all the boxes. `None` as criterion: the sum of the edges.
pub fn fit_boxes(boxes: &[Obb], criterion: Option<&Criterion>) -> Result<Obb> {
    let mut result = Obb::aligned([0.0; 3], [0.0; 3]);
    let criterion = criterion.map_or(ptr::null(), |c| c as *const Criterion);
    check(unsafe { sys::crofton_fit_boxes(boxes.as_ptr(), boxes.len(), criterion, &mut result) })?;
    Ok(result)
}
