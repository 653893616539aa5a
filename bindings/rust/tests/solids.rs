// SPDX-License-Identifier: MIT
//! Shapes by themselves, on objects of a World, and as its probes.
mod common;
use common::{row, tetrahedron, FACES, TETRAHEDRON};
use crofton::*;
use std::f64::consts::PI;

fn near(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b}");
}

#[test]
fn each_kind_of_shape_has_its_volume() {
    let corners: Vec<[f32; 3]> = (0..8).map(|i| [0, 1, 2].map(|k| (i >> k & 1) as f32)).collect();
    let cube = Shape::cuboid([1.0, 1.0, 1.0]).unwrap();
    let (left, right) = (Transform::at([-2.0, 0.0, 0.0]), Transform::at([2.0, 0.0, 0.0]));
    let volumes = [
        (Shape::sphere(2.0), 4.0 / 3.0 * PI * 8.0),
        (Shape::capsule(1.0, 3.0), 4.0 / 3.0 * PI + PI * 6.0),
        (Shape::cylinder(2.0, 1.5), PI * 4.0 * 3.0),
        (Shape::cone(2.0, 1.5), PI * 4.0 * 3.0 / 3.0),
        (Shape::cuboid([1.0, 2.0, 3.0]), 48.0),
        (Shape::hull(&corners, 256), 1.0),
        // A cube, its faces, a quarter of a cylinder at each edge, and a sphere in eight parts.
        (Shape::rounded(&cube, 1.0), 8.0 + 6.0 * 4.0 + 12.0 * 2.0 * PI / 4.0 + 4.0 / 3.0 * PI),
        (Shape::compound(&[cube.at(left), cube.at(right)]), 16.0),
    ];
    for (shape, volume) in volumes {
        near(shape.unwrap().mass().unwrap().volume, volume, 1e-4 * volume);
    }
    let ball = Shape::sphere(2.0).unwrap();
    let (min, max) = ball.bounds().unwrap();
    assert!(min.iter().chain(&max).all(|x| (2.0..2.001).contains(&x.abs())));
    near(ball.mass().unwrap().inertia[0], 0.4 * ball.mass().unwrap().volume * 4.0, 1e-4);
}

#[test]
fn surfaces_and_half_spaces_have_sides() {
    let floor = Shape::half_space([0.0, -2.0, 0.0], 0.0).unwrap(); // any length; solid below
    let ball = Shape::sphere(1.0).unwrap();
    let at = |y| ball.at(Transform::at([0.0, y, 0.0]));
    let ground = floor.at(Transform::default());
    near(ground.distance(&at(3.0)).unwrap().distance, 2.0, 1e-9);
    let deep = ground.penetration(&at(0.25)).unwrap().unwrap();
    near(deep.depth, 0.75, 1e-6);
    near(deep.normal[1], 1.0, 1e-6);
    assert_eq!(ground.penetration(&at(3.0)).unwrap(), None);
    let triangle = Shape::triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    assert_eq!(triangle.mass().unwrap().volume, 0.0);
    let surface = Shape::mesh(&TETRAHEDRON, &FACES, false).unwrap();
    assert_eq!(surface.mass().unwrap_err().status, Status::Unsupported);
    // A slope of 45 degrees, two cells by one, with a hole in the first.
    let heights = [0.0, 1.0, 2.0, 0.0, 1.0, 2.0];
    let field = HeightField { columns: 3, heights: &heights, materials: &[255, 0], spacing: [1.0, 1.0] };
    let slope = Shape::height_field(&field, true).unwrap();
    let down = |x| slope.at(Transform::default()).raycast(&Ray::new([x, 5.0, 0.5], [0.0, -1.0, 0.0])).unwrap();
    assert_eq!(down(0.5), None);
    let hit = down(1.5).unwrap();
    near(hit.t, 3.5, 1e-9);
    near(hit.normal[0], -0.5f64.sqrt(), 1e-9);
}

#[test]
fn a_box_on_a_floor_has_four_contact_points() {
    let (floor, cube) = (Shape::half_space([0.0, -1.0, 0.0], 0.0).unwrap(), Shape::cuboid([1.0, 2.0, 3.0]).unwrap());
    let (ground, at) = (floor.at(Transform::default()), |y| cube.at(Transform::at([0.0, y, 0.0])));
    let contact = ground.contacts(&at(1.75), 0.0, 4).unwrap();
    assert_eq!(contact.points.len(), 4);
    near(contact.depth, 0.25, 1e-9);
    near(contact.normal[1], 1.0, 1e-9);
    for point in &contact.points {
        near(point.depth, 0.25, 1e-9);
        near(point.position[0].abs(), 1.0, 1e-6);
        near(point.position[1], -0.125, 1e-6);
        near(point.position[2].abs(), 3.0, 1e-6);
    }
    assert_eq!(ground.contacts(&at(1.75), 0.0, 1).unwrap().points.len(), 1);
    assert!(ground.contacts(&at(2.5), 0.25, 4).unwrap().points.is_empty());
    near(ground.contacts(&at(2.5), 1.0, 4).unwrap().depth, -0.5, 1e-9);
    assert_eq!(ground.contacts(&at(2.5), -1.0, 4).unwrap_err().status, Status::InvalidArgument);
    assert_eq!(ground.contacts(&at(2.5), 0.0, 9).unwrap_err().status, Status::OutOfRange);

    let nearest = at(0.0).closest_point([0.0, 5.0, 4.0]).unwrap();
    near(nearest.distance, 10.0f64.sqrt(), 1e-9);
    near(nearest.point[1], 2.0, 1e-9);
    assert_eq!(at(0.0).closest_point([0.0, 1.0, 1.0]).unwrap().distance, 0.0);
    assert_eq!(at(0.0).closest_point([0.0, f64::NAN, 0.0]).unwrap_err().status, Status::NonFinite);
}

#[test]
fn a_shape_that_moves_meets_another_in_time() {
    let (a, b) = (Shape::sphere(1.0).unwrap(), Shape::cuboid([1.0; 3]).unwrap());
    let (from, at) = (a.at(Transform::at([-10.0, 0.0, 0.0])), b.at(Transform::default()));
    let forth = Motion { velocity: [2.0, 0.0, 0.0], ..Default::default() };
    let options = CastOptions { duration: 10.0, ..Default::default() };
    let impact = from.cast(&forth, &at, &Motion::default(), &options).unwrap().unwrap();
    near(impact.time, 4.0, 1e-5);
    near(impact.normal[0], 1.0, 1e-6);
    assert!(!impact.unresolved);
    let short = CastOptions { duration: 3.9, ..options };
    assert_eq!(from.cast(&forth, &at, &Motion::default(), &short).unwrap(), None);
    let back = Motion { velocity: [-2.0, 0.0, 0.0], ..Default::default() };
    assert_eq!(from.cast(&back, &at, &back, &options).unwrap(), None);
}

#[test]
fn shapes_that_cannot_be_are_refused_by_name() {
    let status = |made: Result<Shape>| made.err().unwrap().status;
    assert_eq!(status(Shape::sphere(f32::NAN)), Status::NonFinite);
    assert_eq!(status(Shape::sphere(-1.0)), Status::InvalidArgument);
    let error = Shape::hull(&[[0.0; 3], [f32::INFINITY; 3], [1.0; 3], [2.0; 3]], 256).err().unwrap();
    assert_eq!((error.status, error.item), (Status::NonFinite, Some(1)));
    let error = Shape::mesh(&TETRAHEDRON, &[0, 2, 1, 0, 1, 9], false).err().unwrap();
    assert_eq!((error.status, error.item), (Status::OutOfRange, Some(5)));
    let field = HeightField { columns: 3, heights: &[0.0; 7], materials: &[], spacing: [1.0; 2] };
    assert_eq!(status(Shape::height_field(&field, false)), Status::InvalidArgument);
    let none = HeightField { columns: 0, heights: &[], ..field };
    assert!(Shape::height_field(&none, false).is_err());
    let few = HeightField { heights: &[0.0; 6], materials: &[0], ..field };
    assert_eq!(status(Shape::height_field(&few, false)), Status::InvalidArgument);
    assert!(Shape::half_space([0.0; 3], 1.0).is_err());
    assert!(Shape::compound(&[]).is_err());
    let ball = Shape::sphere(1.0).unwrap();
    let nowhere = ball.at(Transform::at([f64::NAN, 0.0, 0.0]));
    assert_eq!(nowhere.touches(&ball.at(Transform::default())).unwrap_err().status, Status::NonFinite);
    let error = Shape::compound(&[ball.at(Transform::default()), nowhere]).err().unwrap();
    assert_eq!((error.status, error.item), (Status::NonFinite, Some(1)));
}

#[test]
fn objects_have_shapes_that_queries_and_contacts_use() {
    let mut world = World::with(WorldOptions { contact_margin: 0.01, ..Default::default() }).unwrap();
    let floor = Shape::half_space([0.0, -1.0, 0.0], 0.0).unwrap();
    let ball = Shape::sphere(1.0).unwrap();
    world.add(&Description::shape(&floor).user(1)).unwrap();
    let high = world.add(&Description::shape(&ball).at(Transform::at([0.0, 0.9, 0.0])).user(2)).unwrap();
    drop((floor, ball)); // the world keeps what it needs
    world.update().unwrap();
    let contacts = world.contacts().unwrap();
    assert_eq!((contacts.len(), contacts[0].first.user, contacts[0].second.user), (1, 1, 2));
    let points = contacts[0].shape_points;
    assert_eq!(points.len(), 1);
    near(points[0].depth, 0.1, 1e-6);
    assert!(points[0].began() && points[0].memory == [0.0; 4]);
    world.visit_shape_points(|_, _, point, memory| memory[0] = point.depth as f32 + 5.0).unwrap();
    world.set_transforms(&[high], &[Transform::at([0.0, 0.95, 0.0])]).unwrap();
    world.update().unwrap();
    let contacts = world.contacts().unwrap();
    let stayed = contacts[0].shape_points[0];
    assert!(contacts[0].phase == Phase::Stayed && !stayed.began());
    near(stayed.memory[0] as f64, 5.1, 1e-5);
    near(stayed.depth, 0.05, 1e-6);

    // A ray beside the ball's top misses it, though not its box.
    let down = |x| world.raycast(&Ray::new([x, 9.0, 0.0], [0.0, -1.0, 0.0]), ALL_LAYERS).unwrap().unwrap().user;
    assert_eq!((down(0.0), down(0.99)), (2, 2));
    world.set_shape(high, None).unwrap_err(); // it was added with only a shape
    let (mut spheres, objects) = row(1);
    let needle = Shape::cuboid([0.01, 0.01, 0.01]).unwrap();
    spheres.set_shape(objects[0], Some(&needle)).unwrap();
    spheres.update().unwrap();
    let aside = Ray::new([0.1, 0.0, 0.0], [0.0, 0.0, -1.0]);
    assert_eq!(spheres.raycast(&aside, ALL_LAYERS).unwrap(), None);
    spheres.set_shape(objects[0], None).unwrap();
    spheres.update().unwrap();
    assert!(spheres.raycast(&aside, ALL_LAYERS).unwrap().is_some());
}

#[test]
fn a_world_answers_probes_of_any_shape() {
    let (mut world, objects) = row(3); // spheres of radius 0.25
    let wide = Shape::capsule(0.25, 1.0).unwrap();
    let at = |x| wide.at(Transform::at([x, 0.0, -5.0]));
    let mut found = Found::new().unwrap();
    let overlaps = world.overlap(&QueryShape::Shape(at(0.5)), ALL_LAYERS, &mut found).unwrap();
    assert_eq!(overlaps.iter().map(|o| o.user).collect::<Vec<_>>(), [0, 1]);
    let closest = world.closest(&QueryShape::Shape(at(4.0)), 9.0, ALL_LAYERS).unwrap().unwrap();
    assert_eq!(closest.object, objects[2]);
    near(closest.distance, 1.5, 1e-9);
    let back = Motion { velocity: [-1.0, 0.0, 0.0], ..Default::default() };
    let options = CastOptions { duration: 9.0, ..Default::default() };
    let hit = world.cast(&at(4.0), &back, &options, ALL_LAYERS).unwrap().unwrap();
    assert_eq!((hit.object, hit.user, hit.triangle, hit.unresolved), (objects[2], 2, u32::MAX, false));
    near(hit.time, 1.5, 1e-5);
    near(hit.normal[0], -1.0, 1e-6);
    assert_eq!(world.cast(&at(4.0), &back, &CastOptions { duration: 1.4, ..options }, ALL_LAYERS).unwrap(), None);
    assert_eq!(world.cast(&at(4.0), &back, &options, 0).unwrap(), None);
    let hits = world.cast_all(&at(4.0), &back, &options, ALL_LAYERS).unwrap();
    assert_eq!(hits.iter().map(|h| h.object).collect::<Vec<_>>(), [objects[2], objects[1], objects[0]]);
    for (i, hit) in hits.iter().enumerate() {
        near(hit.time, 1.5 + i as f64, 1e-5);
        assert_eq!(hit.triangle, u32::MAX);
    }
    let filter = QueryFilter { ignored: &objects[1..2], ..Default::default() };
    assert_eq!(world.cast_all(&at(4.0), &back, &options, filter).unwrap().len(), 2);
    assert!(world.cast_all(&at(4.0), &back, &options, 0).unwrap().is_empty());
    let touched = world.contact_manifolds(&at(2.3), 0.0, 4, ALL_LAYERS).unwrap();
    assert_eq!(touched.iter().map(|m| (m.object, m.user)).collect::<Vec<_>>(), [(objects[2], 2)]);
    near(touched[0].contact.depth, 0.2, 1e-6);
    near(touched[0].contact.normal[0], -1.0, 1e-6);
    assert_eq!(touched[0].contact.points.len(), 1);
    assert!(world.contact_manifolds(&at(9.0), 0.0, 4, ALL_LAYERS).unwrap().is_empty());
    assert_eq!(world.contact_manifolds(&at(1.5), 0.5, 4, ALL_LAYERS).unwrap().len(), 2);
    assert_eq!(world.contact_manifolds(&at(0.0), 0.0, 9, ALL_LAYERS).unwrap_err().status, Status::OutOfRange);
    assert_eq!(world.contact_manifolds(&at(0.0), f64::NAN, 4, ALL_LAYERS).unwrap_err().status, Status::NonFinite);
    let nan = Motion { velocity: [f64::NAN, 0.0, 0.0], ..back };
    assert_eq!(world.cast(&at(4.0), &nan, &options, ALL_LAYERS).unwrap_err().status, Status::NonFinite);
    let floor = Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let ground = QueryShape::Shape(floor.at(Transform::default()));
    assert_eq!(world.overlap(&ground, ALL_LAYERS, &mut found).unwrap_err().status, Status::Unsupported);
    let ground = floor.at(Transform::default());
    assert_eq!(world.contact_manifolds(&ground, 0.0, 4, ALL_LAYERS).unwrap_err().status, Status::Unsupported);
    // A mesh says which triangle it is met at.
    let mesh = tetrahedron(&mut world);
    world.add(&Description::mesh(mesh).at(Transform::at([50.0, 0.0, 0.0])).user(9)).unwrap();
    world.update().unwrap();
    let ball = Shape::sphere(0.125).unwrap();
    let up = Motion { velocity: [0.0, 0.0, 1.0], ..Default::default() };
    let below = ball.at(Transform::at([50.2, 0.2, -1.0]));
    let hit = world.cast(&below, &up, &options, ALL_LAYERS).unwrap().unwrap();
    assert_eq!((hit.user, hit.triangle), (9, 0));
    near(hit.time, 0.875, 1e-5);
}

#[test]
fn regions_hold_shapes_and_hiders() {
    let ball = Shape::sphere(1.0).unwrap();
    let objects = [RegionObject { user: 5, ..RegionObject::shape(&ball, Transform::at([0.0, 0.0, -9.0])) }];
    let region = Region::prepare(&objects, &RegionOptions::default()).unwrap();
    let floor = Shape::half_space([0.0, 1.0, 0.0], 0.0).unwrap();
    let infinite = [RegionObject::shape(&floor, Transform::default())];
    let error = Region::prepare(&infinite, &RegionOptions::default()).err().unwrap();
    assert_eq!((error.status, error.item), (Status::Unsupported, Some(0)));
    drop(ball);
    let mut world = World::new().unwrap();
    world.attach(&region, [50.0, 0.0, 0.0]).unwrap();
    world.update().unwrap();
    let hit = world.raycast(&Ray::new([50.0, 0.0, 0.0], [0.0, 0.0, -1.0]), ALL_LAYERS).unwrap().unwrap();
    assert_eq!(hit.user, 5);
    near(hit.t, 8.0, 1e-6);
    let only = [RegionObject { only_occludes: true, ..RegionObject::mesh(0, Transform::default()) }];
    let meshes = [MeshData::new(&TETRAHEDRON, &FACES)];
    let hider = Region::prepare(&only, &RegionOptions { meshes: &meshes, ..Default::default() }).unwrap();
    world.attach(&hider, [0.0, 0.0, -9.0]).unwrap();
    world.update().unwrap();
    let mut visible = ViewResult::new().unwrap();
    assert!(world.view(&Camera::default().into(), &mut visible).unwrap().ids().is_empty());
}
