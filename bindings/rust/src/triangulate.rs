// SPDX-License-Identifier: MIT
use crate::error::{check, slice};
use crate::{sys, Result};
use std::{mem::size_of, ptr};

/// Triangulates polygons; keeps its memory from one polygon to the next.
pub struct Triangulator {
    raw: *mut sys::Triangulator,
}

unsafe impl Send for Triangulator {}

impl Drop for Triangulator {
    fn drop(&mut self) {
        unsafe { sys::crofton_triangulator_destroy(self.raw) };
    }
}

/// The method of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Ear clipping, the fastest.
    Ear = 0,
    /// Constrained Delaunay: maximises the smallest angles.
    Delaunay = 1,
    /// Minimum weight: minimises the total length of the diagonals.
    MinimumWeight = 2,
}

/// A triangulated polygon.
#[derive(Debug, Clone, Copy)]
pub struct Triangulation<'a> {
    /// Three indices of points per triangle, counter-clockwise.
    pub indices: &'a [[u32; 3]],
    /// The total length of the diagonals.
    pub weight: f64,
    /// A proved bound of (weight - minimum) / minimum; infinite if unknown.
    pub gap: f64,
    /// True if the weight is proved to be minimal.
    pub is_optimal: bool,
}

impl Triangulator {
    /// Returns a triangulator without memory.
    pub fn new() -> Result<Triangulator> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_triangulator_create(&mut raw) })?;
        Ok(Triangulator { raw })
    }

    /// Triangulates a polygon. Ring r is `points[ring_ends[r - 1]..ring_ends[r]]`; the first is the outer one, the
    /// others are holes.
    pub fn triangulate(&mut self, points: &[[f64; 2]], ring_ends: &[u32], method: Method) -> Result<Triangulation<'_>> {
        let polygon = sys::Polygon {
            size: size_of::<sys::Polygon>(),
            points: points.as_ptr() as *const f64,
            point_count: points.len(),
            ring_ends: ring_ends.as_ptr(),
            ring_count: ring_ends.len(),
        };
        let mut t: sys::Triangulation = unsafe { std::mem::zeroed() };
        t.size = size_of::<sys::Triangulation>();
        check(unsafe { sys::crofton_triangulate(self.raw, &polygon, method as u32, &mut t) })?;
        let indices = unsafe { slice(t.indices as *const [u32; 3], t.triangle_count) };
        Ok(Triangulation { indices, weight: t.weight, gap: t.gap, is_optimal: t.optimal != 0 })
    }
}
