// SPDX-License-Identifier: MIT
use crate::error::check;
use crate::{sys, Ray, Result, Separation, Transform};
use std::{mem::size_of, ptr};

/// One mesh, ready for questions about it alone.
pub struct Collider {
    raw: *mut sys::Collider,
}

unsafe impl Send for Collider {}
unsafe impl Sync for Collider {}

impl Drop for Collider {
    fn drop(&mut self) {
        unsafe { sys::crofton_collider_destroy(self.raw) };
    }
}

/// Where a ray meets a mesh.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// The ray's.
    pub t: f64,
    /// Its number.
    pub triangle: u32,
}

impl Collider {
    /// Three indices a triangle; the arrays are copied.
    pub fn new(positions: &[[f32; 3]], indices: &[u32]) -> Result<Collider> {
        let mesh = sys::Mesh {
            size: size_of::<sys::Mesh>(),
            positions: positions.as_ptr() as *const f32,
            vertex_count: positions.len(),
            indices: indices.as_ptr(),
            index_count: indices.len(),
            name: ptr::null(),
        };
        let mut raw = ptr::null_mut();
        check(unsafe { sys::crofton_collider_create(&mesh, &mut raw) })?;
        Ok(Collider { raw })
    }

    /// Whether the surfaces share a point, exactly. `other_to_self` is a rotation and a translation.
    pub fn touches(&self, other: &Collider, other_to_self: &Transform) -> Result<bool> {
        let mut meet = 0;
        check(unsafe { sys::crofton_colliders_meet(self.raw, other.raw, other_to_self, &mut meet) })?;
        Ok(meet != 0)
    }

    /// How far the surfaces are apart, in this mesh's frame.
    pub fn distance(&self, other: &Collider, other_to_self: &Transform) -> Result<Separation> {
        let mut s = Separation { distance: 0.0, on_a: [0.0; 3], on_b: [0.0; 3] };
        check(unsafe {
            let (a, b) = (s.on_a.as_mut_ptr(), s.on_b.as_mut_ptr());
            sys::crofton_colliders_distance(self.raw, other.raw, other_to_self, &mut s.distance, a, b)
        })?;
        Ok(s)
    }

    /// The nearest triangle that each ray meets.
    pub fn raycasts(&self, rays: &[Ray]) -> Result<Vec<Option<TriangleHit>>> {
        let mut hits = vec![TriangleHit { t: 0.0, triangle: u32::MAX }; rays.len()];
        check(unsafe { sys::crofton_collider_raycast(self.raw, rays.as_ptr(), rays.len(), hits.as_mut_ptr()) })?;
        Ok(hits.into_iter().map(|hit| (hit.triangle != u32::MAX).then_some(hit)).collect())
    }
}
