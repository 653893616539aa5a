// SPDX-License-Identifier: MIT
//! Shapes that several tests use.
#![allow(dead_code)]
use crofton::{Bound, Description, Mesh, MeshData, Object, World};

pub const TETRAHEDRON: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
pub const FACES: [u32; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

pub fn tetrahedron(world: &mut World) -> Mesh {
    world.add_mesh(&MeshData::new(&TETRAHEDRON, &FACES)).unwrap()
}

pub fn sphere(world: &mut World, center: [f64; 3], radius: f64, user: u64) -> Object {
    world.add(&Description::bound(Bound::Sphere { center, radius }).user(user)).unwrap()
}

/// Spheres of radius 0.25 along x at 0, 1, 2, …, five units before the default camera.
pub fn row(count: usize) -> (World, Vec<Object>) {
    let mut world = World::new().unwrap();
    let objects = (0..count).map(|i| sphere(&mut world, [i as f64, 0.0, -5.0], 0.25, i as u64)).collect();
    world.update().unwrap();
    (world, objects)
}
