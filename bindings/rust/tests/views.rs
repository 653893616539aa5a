// SPDX-License-Identifier: MIT
//! What cameras see, with layers, in several views, and behind walls.
mod common;
use common::{row, sphere};
use crofton::*;

#[test]
fn a_view_lists_what_is_before_it() {
    let (mut world, objects) = row(3);
    let behind = sphere(&mut world, [0.0, 0.0, 5.0], 0.25, 99);
    world.update().unwrap();
    let mut visible = ViewResult::new().unwrap();
    let seen = world.view(&Camera::default().into(), &mut visible).unwrap();
    assert_eq!(seen.ids(), [objects[0].index, objects[1].index, objects[2].index]);
    assert!(!seen.ids().contains(&behind.index));
    let users: Vec<u64> = seen.objects().unwrap().iter().map(|o| o.user).collect();
    assert_eq!(users, [0, 1, 2]);
    assert!(seen.verdicts().iter().all(|&v| v == Verdict::Inside));
}

#[test]
fn layers_choose() {
    let (mut world, objects) = row(3);
    world.set_layers(objects[1], 0b10).unwrap();
    world.update().unwrap();
    let frustum = Camera::default().frustum().unwrap();
    let mut visible = ViewResult::new().unwrap();
    let seen = world.view(&ViewRequest { layers: 0b01, ..frustum.into() }, &mut visible).unwrap();
    assert_eq!(seen.ids(), [objects[0].index, objects[2].index]);
}

#[test]
fn hidden_objects_are_not_seen() {
    let (mut world, objects) = row(2);
    world.set_hidden(objects[0], true).unwrap();
    world.update().unwrap();
    let frustum = Camera::default().frustum().unwrap();
    let mut visible = ViewResult::new().unwrap();
    assert_eq!(world.view(&frustum.into(), &mut visible).unwrap().ids(), [objects[1].index]);
    world.set_hidden(objects[0], false).unwrap();
    world.update().unwrap();
    assert_eq!(world.view(&frustum.into(), &mut visible).unwrap().ids().len(), 2);
}

#[test]
fn several_views_say_which_of_them_sees() {
    let (mut world, objects) = row(1);
    let behind = sphere(&mut world, [0.0, 0.0, 5.0], 0.25, 99);
    world.update().unwrap();
    let forth = Camera::default().frustum().unwrap();
    let back = Camera { forward: [0.0, 0.0, 1.0], ..Camera::default() }.frustum().unwrap();
    let mut visible = ViewResult::new().unwrap();
    let views = [forth.into(), back.into(), ViewRequest { layers: 0, ..forth.into() }];
    let seen = world.view_many(None, &views, &mut visible).unwrap();
    let mut masks: Vec<_> = seen.objects().unwrap().iter().map(|(o, m)| (o.object, *m)).collect();
    masks.sort_by_key(|(o, _)| o.index);
    assert_eq!(masks, [(objects[0], 0b001), (behind, 0b010)]);
}

#[test]
fn a_bad_camera_is_an_error() {
    let camera = Camera { projection: Projection::Perspective { fov_y: 4.0 }, ..Camera::default() };
    assert!(camera.frustum().is_err());
    let camera = Camera { forward: [0.0; 3], ..Camera::default() };
    assert!(camera.frustum().is_err());
}

#[test]
fn an_orthographic_camera_sees_a_block() {
    let camera = Camera { projection: Projection::Orthographic { height: 2.0 }, aspect: 1.0, ..Camera::default() };
    let boxes = [
        Obb::aligned([0.0, 0.0, -5.0], [0.5; 3]),
        Obb::aligned([1.2, 0.0, -5.0], [0.5; 3]),
        Obb::aligned([1.6, 0.0, -5.0], [0.5; 3]),
    ];
    let verdicts = classify(&camera.frustum().unwrap(), &boxes).unwrap();
    assert_eq!(verdicts, [Verdict::Inside, Verdict::Straddling, Verdict::Outside]);
}

#[test]
fn a_frustum_is_made_of_planes_or_of_a_matrix() {
    let cube = [([1.0, 0.0, 0.0], 1.0), ([-1.0, 0.0, 0.0], 1.0), ([0.0, 1.0, 0.0], 1.0)];
    let frustum = Frustum::from_planes([10.0, 0.0, 0.0], &cube).unwrap();
    assert_eq!(frustum.planes(), cube);
    assert_eq!(frustum.origin(), [10.0, 0.0, 0.0]);
    assert!(Frustum::from_planes([0.0; 3], &[([1.0, 0.0, 0.0], 0.0); 13]).is_err());
    let mut identity = [0.0; 16];
    for i in 0..4 {
        identity[5 * i] = 1.0;
    }
    let clip = Frustum::from_matrix(&identity, DepthRange::MinusOneToOne, [0.0; 3]).unwrap();
    let verdicts = classify(&clip, &[Obb::aligned([0.0; 3], [0.9; 3]), Obb::aligned([2.5, 0.0, 0.0], [1.0; 3])]);
    assert_eq!(verdicts.unwrap(), [Verdict::Inside, Verdict::Outside]);
}

fn walled() -> (World, Object) {
    let mut world = World::new().unwrap();
    let corners: Vec<[f32; 3]> = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 })).collect();
    let faces =
        [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
    let mesh = world.add_mesh(&MeshData::new(&corners, &faces)).unwrap();
    world.find_occluders(mesh, &FindOptions::default()).unwrap();
    assert!(world.occluder_count(mesh).unwrap() > 0);
    let mut wide = Transform::at([0.0, 0.0, -5.0]);
    (wide.linear[0], wide.linear[4]) = (4.0, 4.0);
    let wall = world.add(&Description::mesh(mesh).at(wide).user(1)).unwrap();
    sphere(&mut world, [0.0, 0.0, -20.0], 0.5, 2);
    sphere(&mut world, [0.0, 0.0, -3.0], 0.2, 3);
    world.update().unwrap();
    (world, wall)
}

#[test]
fn what_a_wall_hides_is_not_seen() {
    let (world, _) = walled();
    let mut visible = ViewResult::new().unwrap();
    let options = OcclusionOptions { list_occluded: true, ..Default::default() };
    let seen = world.view(&ViewRequest { occlusion: Some(options), ..Camera::default().into() }, &mut visible).unwrap();
    let users: Vec<u64> = seen.objects().unwrap().iter().map(|o| o.user).collect();
    assert_eq!(users, [1, 3]);
    assert_eq!(seen.occluded_ids().len(), 1);
    assert!(seen.occlusion_statistics().unwrap().occluders_drawn > 0);
}

#[test]
fn glass_hides_nothing() {
    let (mut world, wall) = walled();
    world.set_occludes(wall, false).unwrap();
    world.update().unwrap();
    let mut visible = ViewResult::new().unwrap();
    let seen = world
        .view(&ViewRequest { occlusion: Some(OcclusionOptions::default()), ..Camera::default().into() }, &mut visible)
        .unwrap();
    assert_eq!(seen.ids().len(), 3);
}
