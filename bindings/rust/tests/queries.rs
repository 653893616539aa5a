// SPDX-License-Identifier: MIT
//! Rays, shapes, pairs and contacts.
mod common;
use common::{row, sphere, tetrahedron};
use crofton::*;

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

#[test]
fn a_ray_meets_the_nearest_sphere() {
    let (world, objects) = row(2);
    let hit = world.raycast(&Ray::new([1.0, 0.0, 0.0], DOWN), ALL_LAYERS).unwrap().unwrap();
    assert_eq!((hit.object, hit.user, hit.triangle()), (objects[1], 1, None));
    assert!((hit.t - 4.75).abs() < 1e-12);
    assert!((hit.point[2] + 4.75).abs() < 1e-12);
    assert!(world.raycast(&Ray::new([0.5, 0.0, 0.0], DOWN), ALL_LAYERS).unwrap().is_none());
}

#[test]
fn a_ray_ends_where_it_is_told_to() {
    let (world, _) = row(1);
    let short = Ray::segment([0.0; 3], [0.0, 0.0, -4.7]);
    let long = Ray::segment([0.0; 3], [0.0, 0.0, -4.8]);
    assert!(!world.raycast_any(&short, ALL_LAYERS).unwrap());
    assert!(world.raycast_any(&long, ALL_LAYERS).unwrap());
    assert!(!world.raycast_any(&long, 0).unwrap());
}

#[test]
fn a_ray_names_the_triangle() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    world.add(&Description::mesh(mesh)).unwrap();
    world.update().unwrap();
    let hit = world.raycast(&Ray::new([0.2, 0.2, -3.0], [0.0, 0.0, 1.0]), ALL_LAYERS).unwrap().unwrap();
    assert_eq!(hit.triangle(), Some(0));
    assert_eq!(hit.t, 3.0);
}

#[test]
fn a_ray_meets_all() {
    let (world, objects) = row(5);
    let mut found = Found::new().unwrap();
    let hits = world.raycast_all(&Ray::new([-10.0, 0.0, -5.0], [1.0, 0.0, 0.0]), ALL_LAYERS, &mut found).unwrap();
    assert_eq!(hits.iter().map(|h| h.object).collect::<Vec<_>>(), objects);
}

#[test]
fn queries_ignore_objects() {
    let (world, objects) = row(3);
    let ray = Ray::new([-10.0, 0.0, -5.0], [1.0, 0.0, 0.0]);
    let mut found = Found::new().unwrap();
    let filter = QueryFilter { ignored: &objects[..1], ..Default::default() };
    assert_eq!(world.raycast(&ray, filter).unwrap().unwrap().object, objects[1]);
    let hits = world.raycast_all(&ray, filter, &mut found).unwrap();
    assert_eq!(hits.iter().map(|h| h.object).collect::<Vec<_>>(), objects[1..]);
    let all = QueryFilter { layers: ALL_LAYERS, ignored: &objects };
    assert!(world.raycast(&ray, all).unwrap().is_none());
    assert!(!world.raycast_any(&ray, all).unwrap());
    let ball = QueryShape::Sphere { center: [0.0, 0.0, -5.0], radius: 0.1 };
    assert!(world.overlap(&ball, filter, &mut found).unwrap().is_empty());
    assert_eq!(world.closest(&ball, f64::INFINITY, filter).unwrap().unwrap().object, objects[1]);
    let shape = Shape::sphere(0.1).unwrap();
    let motion = Motion { velocity: [20.0, 0.0, 0.0], ..Default::default() };
    let placed = shape.at(Transform::at([-10.0, 0.0, -5.0]));
    let hit = world.cast(&placed, &motion, &CastOptions::default(), filter).unwrap().unwrap();
    assert_eq!(hit.object, objects[1]);
}

#[test]
fn a_ray_without_direction_is_an_error() {
    let (world, _) = row(1);
    assert!(world.raycast(&Ray::new([0.0; 3], [0.0; 3]), ALL_LAYERS).is_err());
    assert!(world.raycast(&Ray::new([f64::NAN, 0.0, 0.0], DOWN), ALL_LAYERS).is_err());
    assert!(world.raycasts(&[], ALL_LAYERS).unwrap().is_empty());
}

#[test]
fn shapes_find_what_they_meet() {
    let (world, objects) = row(5);
    let mut found = Found::new().unwrap();
    let shapes = [
        QueryShape::Box(Obb::aligned([1.5, 0.0, -5.0], [0.3; 3])),
        QueryShape::Sphere { center: [1.5, 0.0, -5.0], radius: 0.26 },
        QueryShape::Capsule { begin: [1.1, 0.5, -5.0], end: [1.9, 0.5, -5.0], radius: 0.3 },
    ];
    for shape in shapes {
        let met: Vec<_> = world.overlap(&shape, ALL_LAYERS, &mut found).unwrap().iter().map(|o| o.object).collect();
        assert_eq!(met, objects[1..3], "{shape:?}");
    }
}

#[test]
fn the_closest_is_found_within_a_distance() {
    let (world, objects) = row(3);
    let shape = QueryShape::Sphere { center: [2.0, 4.0, -5.0], radius: 0.5 };
    let closest = world.closest(&shape, f64::INFINITY, ALL_LAYERS).unwrap().unwrap();
    assert_eq!(closest.object, objects[2]);
    assert!((closest.distance - 3.25).abs() < 1e-9);
    assert!((closest.on_shape[1] - 3.5).abs() < 1e-9);
    assert!((closest.on_object[1] - 0.25).abs() < 1e-9);
    assert!(world.closest(&shape, 3.0, ALL_LAYERS).unwrap().is_none());
}

#[test]
fn pairs_and_contacts_begin_stay_and_end() {
    let mut world = World::new().unwrap();
    let a = sphere(&mut world, [0.0; 3], 1.0, 1);
    let b = sphere(&mut world, [1.5, 0.0, 0.0], 1.0, 2);
    world.update().unwrap();
    assert_eq!(world.pairs().unwrap().iter().map(|p| (p.first.user, p.second.user)).collect::<Vec<_>>(), [(1, 2)]);
    let contacts = world.contacts().unwrap();
    assert_eq!(contacts.len(), 1);
    assert_eq!((contacts[0].first.object, contacts[0].second.object), (a, b));
    assert_eq!(contacts[0].phase, Phase::Began);
    assert!((contacts[0].depth - 0.5).abs() < 1e-9);
    assert!((contacts[0].normal[0] - 1.0).abs() < 1e-12);
    assert!(!contacts[0].points.is_empty());
    world.update().unwrap();
    assert_eq!(world.contacts().unwrap()[0].phase, Phase::Stayed);
    world.set_bound(b, Bound::Sphere { center: [5.0, 0.0, 0.0], radius: 1.0 }).unwrap();
    world.update().unwrap();
    assert_eq!(world.contacts().unwrap()[0].phase, Phase::Ended);
    world.update().unwrap();
    assert!(world.contacts().unwrap().is_empty());
}

#[test]
fn what_does_not_collide_has_no_pair() {
    let mut world = World::new().unwrap();
    let bound = Bound::Sphere { center: [0.0; 3], radius: 1.0 };
    world.add(&Description::bound(bound).layers(0b01)).unwrap();
    world.add(&Description::bound(bound).layers(0b01).collides_with(0b10)).unwrap();
    world.update().unwrap();
    assert!(world.pairs().unwrap().is_empty());
}

#[test]
fn two_meshes_name_the_triangles_that_touch() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    world.add(&Description::mesh(mesh)).unwrap();
    world.add(&Description::mesh(mesh).at(Transform::at([0.1, 0.1, 0.1]))).unwrap();
    world.update().unwrap();
    let contacts = world.contacts().unwrap();
    assert_eq!(contacts.len(), 1);
    assert!(contacts[0].triangles.iter().all(|t| t.first_triangle < 4 && t.second_triangle < 4));
    assert!(!contacts[0].triangles.is_empty());
}

#[test]
fn a_limit_of_pairs_is_kept() {
    let mut world = World::with(WorldOptions { max_pairs: 1, ..Default::default() }).unwrap();
    for i in 0..3 {
        sphere(&mut world, [0.0; 3], 1.0, i);
    }
    assert_eq!(world.update().unwrap_err().status, Status::BudgetExceeded);
    assert!(world.pairs().unwrap().is_empty());
    let frustum = Camera { position: [0.0, 0.0, 5.0], ..Camera::default() }.frustum().unwrap();
    let mut visible = ViewResult::new().unwrap();
    assert_eq!(world.view(&frustum.into(), &mut visible).unwrap().ids().len(), 3);
}
