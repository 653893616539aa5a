// SPDX-License-Identifier: MIT
use crate::error::{check, slice};
use crate::{sys, Result};
use std::{mem::size_of, ptr};

/// Memory that is kept from one polygon to the next.
pub struct Triangulator {
    raw: *mut sys::Triangulator,
}

unsafe impl Send for Triangulator {}

impl Drop for Triangulator {
    fn drop(&mut self) {
        unsafe { sys::crofton_triangulator_destroy(self.raw) };
    }
}

/// How a polygon is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Quickest.
    Ear = 0,
    /// Angles as large as they can be.
    Delaunay = 1,
    /// Diagonals as short as they can be in all.
    MinimumWeight = 2,
}

/// A polygon cut into triangles.
#[derive(Debug, Clone, Copy)]
pub struct Triangulation<'a> {
    /// Three places of points a triangle, counter-clockwise.
    pub indices: &'a [[u32; 3]],
    /// The total length of the diagonals.
    pub weight: f64,
    /// A proven bound on (weight - minimum) / minimum; infinite where none is known.
    pub gap: f64,
    /// The weight is proven to be the least.
    pub is_optimal: bool,
}

impl Triangulator {
    /// Room for nothing yet.
    pub fn new() -> Result<Triangulator> {
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_triangulator_create(&mut raw) })?;
        Ok(Triangulator { raw })
    }

    /// Ring r is `points[ring_ends[r - 1]..ring_ends[r]]`; the first is the outer one, the others are holes.
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
