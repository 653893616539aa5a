// SPDX-License-Identifier: MIT
use crate::error::check;
use crate::{sys, Ray, Result, Separation, Transform};
use std::{mem::size_of, ptr};

/// A mesh for queries without a World.
pub struct Collider {
    raw: *mut sys::Shape,
}

unsafe impl Send for Collider {}
unsafe impl Sync for Collider {}

impl Drop for Collider {
    fn drop(&mut self) {
        unsafe { sys::crofton_shape_destroy(self.raw) };
    }
}

/// Where a ray hits a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// The parameter along the ray.
    pub t: f64,
    /// The triangle's index.
    pub triangle: u32,
}

impl Collider {
    /// Takes three indices per triangle; copies the arrays.
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
        let mut description = unsafe { sys::crofton_default_shape_description() };
        description.kind = sys::SHAPE_MESH;
        description.mesh = &mesh;
        check(unsafe { sys::crofton_shape_create(&description, &mut raw) })?;
        Ok(Collider { raw })
    }

    fn relate(&self, other: &Collider, other_to_self: &Transform, which: u32) -> Result<sys::MeshRelation> {
        let mut relation: sys::MeshRelation = unsafe { std::mem::zeroed() };
        relation.size = size_of::<sys::MeshRelation>();
        check(unsafe { sys::crofton_meshes_relate(self.raw, other.raw, other_to_self, which, &mut relation) })?;
        Ok(relation)
    }

    /// Tests whether the surfaces share a point, exactly. `other_to_self` is a rotation and a translation.
    pub fn touches(&self, other: &Collider, other_to_self: &Transform) -> Result<bool> {
        Ok(self.relate(other, other_to_self, sys::MESHES_MEET)?.meet != 0)
    }

    /// Returns the distance of the surfaces, in this mesh's frame.
    pub fn distance(&self, other: &Collider, other_to_self: &Transform) -> Result<Separation> {
        let found = self.relate(other, other_to_self, sys::MESHES_DISTANCE)?;
        Ok(Separation { distance: found.distance, on_a: found.on_a, on_b: found.on_b })
    }

    /// Returns the nearest triangle that each ray hits.
    pub fn raycasts(&self, rays: &[Ray]) -> Result<Vec<Option<TriangleHit>>> {
        let here = Transform::default();
        let placed = sys::Placed { shape: self.raw, pose: &here };
        rays.iter().map(|ray| raycast(&placed, ray)).collect()
    }
}

fn raycast(placed: &sys::Placed, ray: &Ray) -> Result<Option<TriangleHit>> {
    let mut hit: sys::ShapeRayHit = unsafe { std::mem::zeroed() };
    hit.size = size_of::<sys::ShapeRayHit>();
    check(unsafe { sys::crofton_shape_raycast(placed, ray, &mut hit) })?;
    Ok(hit.t.is_finite().then_some(TriangleHit { t: hit.t, triangle: hit.triangle }))
}
