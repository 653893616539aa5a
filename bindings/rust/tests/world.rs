// SPDX-License-Identifier: MIT
//! Objects that come, move, hide and go; handles that go stale; input that is refused.
mod common;
use common::{row, sphere, tetrahedron, FACES, TETRAHEDRON};
use crofton::*;

#[test]
fn an_object_is_there_from_add_to_remove() {
    let (mut world, objects) = row(3);
    assert_eq!(world.object_count(), 3);
    assert!(world.contains(objects[1]));
    world.remove(objects[1]).unwrap();
    assert!(!world.contains(objects[1]));
    assert_eq!(world.object_count(), 2);
}

#[test]
fn a_stale_handle_is_a_named_error_even_when_its_index_is_used_again() {
    let (mut world, objects) = row(1);
    world.remove(objects[0]).unwrap();
    world.update().unwrap(); // indices are used again after an update
    let new = sphere(&mut world, [0.0; 3], 1.0, 9);
    assert_eq!(new.index, objects[0].index);
    assert_ne!(new.generation, objects[0].generation);
    let error = world.set_user(objects[0], 1).unwrap_err();
    assert_eq!(error.status, Status::StaleHandle);
    assert_eq!(world.user(new).unwrap(), 9);
}

#[test]
fn user_data_is_given_back() {
    let (mut world, objects) = row(2);
    world.set_user(objects[1], u64::MAX).unwrap();
    assert_eq!(world.user(objects[0]).unwrap(), 0);
    assert_eq!(world.user(objects[1]).unwrap(), u64::MAX);
}

#[test]
fn a_box_is_known_after_the_first_update_only() {
    let mut world = World::new().unwrap();
    let object = sphere(&mut world, [1.0, 2.0, 3.0], 0.5, 0);
    assert_eq!(world.obb(object).unwrap_err().status, Status::Empty);
    world.update().unwrap();
    let obb = world.obb(object).unwrap();
    assert_eq!(obb.center, [1.0, 2.0, 3.0]);
    assert!(obb.half_extents.iter().all(|&h| h >= 0.5 && h < 0.5001));
}

#[test]
fn a_nan_is_refused_and_the_world_is_as_before() {
    let (mut world, objects) = row(1);
    let bad = Bound::Sphere { center: [f64::NAN, 0.0, 0.0], radius: 1.0 };
    assert_eq!(world.set_bound(objects[0], bad).unwrap_err().status, Status::NonFinite);
    assert!(world.add(&Description::bound(bad)).is_err());
    world.update().unwrap();
    assert_eq!(world.object_count(), 1);
    assert_eq!(world.obb(objects[0]).unwrap().center, [0.0, 0.0, -5.0]);
}

#[test]
fn of_many_boxes_the_bad_one_is_named_and_the_others_move() {
    let (mut world, objects) = row(3);
    let mut boxes = [Obb::aligned([9.0, 0.0, 0.0], [1.0; 3]); 3];
    boxes[1].half_extents[0] = -1.0;
    let error = world.set_boxes(&objects, &boxes).unwrap_err();
    assert_eq!(error.item, Some(1));
    assert!(error.to_string().contains("item 1"));
    world.update().unwrap();
    assert_eq!(world.obb(objects[0]).unwrap().center[0], 9.0);
    assert_eq!(world.obb(objects[1]).unwrap().center[0], 1.0);
    assert_eq!(world.obb(objects[2]).unwrap().center[0], 9.0);
}

#[test]
fn slices_of_two_lengths_are_refused() {
    let (mut world, objects) = row(2);
    let error = world.set_boxes(&objects, &[Obb::aligned([0.0; 3], [1.0; 3])]).unwrap_err();
    assert_eq!(error.status, Status::InvalidArgument);
}

#[test]
fn a_node_moves_what_is_below_it() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    let top = world.add_node(None, &Transform::at([10.0, 0.0, 0.0]), ALL_LAYERS).unwrap();
    let below = world.add_node(Some(top), &Transform::at([0.0, 1.0, 0.0]), ALL_LAYERS).unwrap();
    let object = world.add(&Description::mesh(mesh).under(below)).unwrap();
    world.update().unwrap();
    assert_eq!(world.transform(object).unwrap().translation, [10.0, 1.0, 0.0]);
    world.set_node_transforms(&[top], &[Transform::at([-4.0, 0.0, 0.0])]).unwrap();
    world.update().unwrap();
    assert_eq!(world.transform(object).unwrap().translation, [-4.0, 1.0, 0.0]);
}

#[test]
fn a_node_is_not_its_own_ancestor() {
    let mut world = World::new().unwrap();
    let top = world.add_node(None, &Transform::default(), ALL_LAYERS).unwrap();
    let below = world.add_node(Some(top), &Transform::default(), ALL_LAYERS).unwrap();
    assert!(world.set_parent(top, Some(below)).is_err());
    world.set_parent(below, None).unwrap();
    world.set_parent(top, Some(below)).unwrap();
}

#[test]
fn a_node_takes_all_below_it_along() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    let node = world.add_node(None, &Transform::default(), ALL_LAYERS).unwrap();
    let object = world.add(&Description::mesh(mesh).under(node)).unwrap();
    world.remove_node(node).unwrap();
    assert!(!world.contains_node(node));
    assert!(!world.contains(object));
    assert!(world.contains_mesh(mesh));
}

#[test]
fn a_mesh_in_use_stays() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    let object = world.add(&Description::mesh(mesh)).unwrap();
    assert!(world.remove_mesh(mesh).is_err());
    world.remove(object).unwrap();
    world.remove_mesh(mesh).unwrap();
    assert!(!world.contains_mesh(mesh));
}

#[test]
fn vertices_and_indices_come_in_several_kinds() {
    let mut world = World::new().unwrap();
    let doubles = TETRAHEDRON.map(|p| p.map(f64::from));
    let shorts = FACES.map(|i| i as u16);
    let interleaved: Vec<f32> = TETRAHEDRON.iter().flat_map(|p| [p[0], p[1], p[2], 7.0, 8.0]).collect();
    let kinds = [
        MeshData::new(&TETRAHEDRON, &FACES),
        MeshData { vertices: Vertices::F64(&doubles), indices: Indices::U16(&shorts), ..MeshData::new(&[], &[]) },
        MeshData {
            vertices: Vertices::Interleaved { floats: &interleaved, stride: 5 },
            indices: Indices::U32(&FACES),
            ..MeshData::new(&[], &[])
        },
    ];
    let objects = kinds.map(|data| {
        let mesh = world.add_mesh(&data).unwrap();
        world.add(&Description::mesh(mesh)).unwrap()
    });
    world.update().unwrap();
    let expected = world.obb(objects[0]).unwrap();
    assert_eq!(world.obb(objects[1]).unwrap(), expected);
    assert_eq!(world.obb(objects[2]).unwrap(), expected);
}

#[test]
fn an_index_beyond_the_vertices_is_refused() {
    let mut world = World::new().unwrap();
    assert!(world.add_mesh(&MeshData::new(&TETRAHEDRON, &[0, 1, 4])).is_err());
    let half = MeshData {
        vertices: Vertices::Interleaved { floats: &[0.0; 7], stride: 3 },
        indices: Indices::None,
        ..MeshData::new(&[], &[])
    };
    assert_eq!(world.add_mesh(&half).unwrap_err().status, Status::InvalidArgument);
}

#[test]
fn a_mesh_that_deforms_takes_its_object_along() {
    let mut world = World::new().unwrap();
    let mesh = tetrahedron(&mut world);
    let object = world.add(&Description::mesh(mesh)).unwrap();
    world.update().unwrap();
    let moved = TETRAHEDRON.map(|p| [p[0] + 100.0, p[1], p[2]]);
    world.set_vertices(mesh, Vertices::F32(&moved)).unwrap();
    world.update().unwrap();
    assert!(world.obb(object).unwrap().center[0] > 99.0);
    assert!(world.set_vertices(mesh, Vertices::F32(&moved[..3])).is_err());
}

#[test]
fn what_a_view_sees_is_the_same_on_any_number_of_threads() {
    let mut worlds = [World::new().unwrap(), World::new().unwrap()];
    for world in &mut worlds {
        for i in 0..5000u64 {
            let x = (i % 100) as f64 - 50.0;
            sphere(world, [x, (i / 100) as f64 - 25.0, -40.0], 0.3, i);
        }
    }
    worlds[0].update().unwrap();
    worlds[1].update_on(&Threads(4)).unwrap();
    let frustum = Camera::default().frustum().unwrap();
    let (mut a, mut b) = (ViewResult::new().unwrap(), ViewResult::new().unwrap());
    let one = worlds[0].view(&frustum.into(), &mut a).unwrap();
    let four = worlds[1].view_on(Some(&Threads(4)), &frustum.into(), &mut b).unwrap();
    assert!(!one.ids().is_empty());
    assert_eq!(one.ids(), four.ids());
}

#[test]
fn a_world_is_asked_from_many_threads_at_once() {
    let (world, objects) = row(50);
    let frustum = Camera::default().frustum().unwrap();
    std::thread::scope(|scope| {
        for i in 0..8usize {
            let (world, frustum, object) = (&world, &frustum, objects[i]);
            scope.spawn(move || {
                let mut visible = ViewResult::new().unwrap();
                for _ in 0..200 {
                    assert!(!world.view(&(*frustum).into(), &mut visible).unwrap().ids().is_empty());
                    let ray = Ray::new([i as f64, 0.0, 0.0], [0.0, 0.0, -1.0]);
                    assert_eq!(world.raycast(&ray, ALL_LAYERS).unwrap().unwrap().object, object);
                }
            });
        }
    });
}

#[test]
fn an_error_is_the_threads_own() {
    let (world, objects) = row(1);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..500 {
                    let stale = Object { index: objects[0].index, generation: 77 };
                    assert_eq!(world.user(stale).unwrap_err().status, Status::StaleHandle);
                    assert!(world.user(objects[0]).is_ok());
                }
            });
        }
    });
}

#[test]
fn no_indices_are_no_triangles() {
    let mut world = World::new().unwrap();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for indices in [Indices::U32(&[]), Indices::U16(&[])] {
        let data = MeshData { vertices: Vertices::F32(&corners), indices, ..MeshData::new(&[], &[]) };
        assert_eq!(world.add_mesh(&data).unwrap_err().status, Status::Empty);
    }
    let data = MeshData { vertices: Vertices::F32(&corners), indices: Indices::None, ..MeshData::new(&[], &[]) };
    assert!(world.add_mesh(&data).is_ok());
}

#[test]
fn threads_do_each_range_once_whatever_the_grain() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    for (count, grain) in [(5, usize::MAX / 2 + 1), (5, usize::MAX), (5, 2), (5, 5), (0, 3), (7, 1)] {
        let times: Vec<AtomicUsize> = (0..count).map(|_| AtomicUsize::new(0)).collect();
        Threads(4).parallel_for(count, grain, &|begin, end, worker| {
            assert!(begin < end && worker < 4);
            for time in &times[begin..end] {
                time.fetch_add(1, Ordering::Relaxed);
            }
        });
        assert!(times.iter().all(|t| t.load(Ordering::Relaxed) == 1));
    }
}

#[test]
fn many_objects_are_added_at_once_and_those_that_are_refused_are_named() {
    let mut world = World::new().unwrap();
    world.reserve(1000).unwrap();
    assert_eq!(world.reserve(usize::MAX).unwrap_err().status, Status::OutOfRange);
    let at = |x: f64| Description::bound(Bound::Sphere { center: [x, 0.0, 0.0], radius: 0.25 });
    let mut all: Vec<Description> = (0..1000).map(|i| at(i as f64).user(i)).collect();
    let mut objects = Vec::new();
    world.add_many(&all, &mut objects).unwrap();
    world.update().unwrap();
    assert_eq!(world.object_count(), 1000);
    for (i, object) in objects.iter().enumerate() {
        assert_eq!((world.user(*object).unwrap(), world.obb(*object).unwrap().center[0]), (i as u64, i as f64));
    }
    all.truncate(3);
    all[1] = at(f64::NAN);
    let error = world.add_many(&all, &mut objects).unwrap_err();
    assert_eq!((error.status, error.item), (Status::NonFinite, Some(1)));
    assert_eq!((world.object_count(), objects.len()), (1002, 3));
    assert!(world.contains(objects[0]) && !world.contains(objects[1]) && world.contains(objects[2]));
}

#[test]
fn pairs_of_boxes_begin_stay_and_end_without_a_world() {
    let mut broadphase = Broadphase::new().unwrap();
    let row = |gap: f64| (0..4).map(|i| Obb::aligned([gap * i as f64, 0.0, 0.0], [1.0; 3])).collect::<Vec<_>>();
    let pair = |first, second| Pair { first, second };
    broadphase.update(None, &row(1.5), None).unwrap();
    assert_eq!(broadphase.pairs(Pairs::Began).unwrap(), [pair(0, 1), pair(1, 2), pair(2, 3)]);
    let alone = [Filter { layers: 1, collides_with: 1 }, Filter { layers: 2, collides_with: 2 }];
    let filters = [alone[0], alone[1], alone[1], alone[0]];
    broadphase.update(Some(&Threads(2)), &row(1.5), Some(&filters)).unwrap();
    assert_eq!(broadphase.pairs(Pairs::Stayed).unwrap(), [pair(1, 2)]);
    assert_eq!(broadphase.pairs(Pairs::Ended).unwrap(), [pair(0, 1), pair(2, 3)]);
    assert_eq!(broadphase.update(None, &row(1.5), Some(&alone)).unwrap_err().status, Status::InvalidArgument);
    broadphase.update(None, &row(3.0), None).unwrap();
    assert!(broadphase.pairs(Pairs::All).unwrap().is_empty());
}

#[test]
fn a_logger_gets_the_messages() {
    static HEARD: std::sync::Mutex<Vec<(LogLevel, String)>> = std::sync::Mutex::new(Vec::new());
    unsafe { set_logger(Some(|level, message| HEARD.lock().unwrap().push((level, message.to_owned())))) };
    log(LogLevel::Info, "from the game").unwrap();
    unsafe { set_logger(None) };
    log(LogLevel::Info, "not heard").unwrap();
    assert_eq!(*HEARD.lock().unwrap(), [(LogLevel::Info, "from the game".to_owned())]);
    assert_eq!(log(LogLevel::Info, "a\0b").unwrap_err().status, Status::InvalidArgument);
}

#[test]
fn options_are_those_of_the_library() {
    let mut world = World::with(WorldOptions { updates_to_rest: 2, rebuild_budget: 0, ..Default::default() }).unwrap();
    world.add(&Description::bound(Bound::Sphere { center: [0.0; 3], radius: 1.0 })).unwrap();
    for _ in 0..4 {
        world.update().unwrap();
    }
    assert_eq!(world.statistics().unwrap().resting, 1);
    assert_eq!(WorldOptions::default().updates_to_rest, 16);
}
