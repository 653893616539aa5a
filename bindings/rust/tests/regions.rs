// SPDX-License-Identifier: MIT
//! Regions come and go; their objects are in every answer in between; bad ones are named.
mod common;
use common::{FACES, TETRAHEDRON};
use crofton::*;

fn ball(x: f64, user: u64) -> RegionObject<'static> {
    RegionObject { user, ..RegionObject::bound(Bound::Sphere { center: [x, 0.0, 0.0], radius: 1.0 }) }
}

fn seen_users(world: &World, from: f64) -> Vec<u64> {
    let ray = Ray { origin: [from, 0.0, 0.0], direction: [1.0, 0.0, 0.0], max_t: f64::INFINITY };
    let mut found = Found::new().unwrap();
    world.raycast_all(&ray, ALL_LAYERS, &mut found).unwrap().iter().map(|hit| hit.user).collect()
}

#[test]
fn objects_of_a_region_are_there_from_attach_to_detach_at_each_origin() {
    // Prepared on another thread, and dropped as soon as it is attached.
    let prepare = || Region::prepare(&[ball(0.0, 5), ball(10.0, 6)], &RegionOptions::default()).unwrap();
    let region = std::thread::spawn(prepare).join().unwrap();
    let mut world = World::new().unwrap();
    let near = world.attach(&region, [0.0; 3]).unwrap();
    let far = world.attach(&region, [100.0, 0.0, 0.0]).unwrap();
    drop(region);
    world.update().unwrap();
    assert_eq!(seen_users(&world, -50.0), [5, 6, 5, 6]);
    let object = world.object_in(far, 1).unwrap();
    assert_eq!(world.place_of(object).unwrap(), (far, 1));
    assert_eq!(world.obb(object).unwrap().center, [110.0, 0.0, 0.0]);
    world.set_hidden(object, true).unwrap();
    world.update().unwrap();
    assert_eq!(seen_users(&world, -50.0), [5, 6, 5]);
    world.detach(near).unwrap();
    world.update().unwrap();
    assert_eq!(seen_users(&world, -50.0), [5]);
    assert_eq!(world.object_in(near, 0).unwrap_err().status, Status::StaleHandle);
    assert_eq!(world.detach(near).unwrap_err().status, Status::StaleHandle);
}

#[test]
fn objects_share_the_meshes_of_a_region() {
    let mesh = MeshData { clusters: true, ..MeshData::new(&TETRAHEDRON, &FACES) };
    let objects = [
        RegionObject::mesh(0, Transform { translation: [0.0, 0.0, -9.0], ..Transform::default() }),
        RegionObject::mesh(0, Transform::default()),
    ];
    let region =
        Region::prepare_on(Some(&Threads(2)), &objects, &RegionOptions { meshes: &[mesh], ..Default::default() });
    let mut world = World::new().unwrap();
    let attached = world.attach(&region.unwrap(), [50.0, 0.0, 0.0]).unwrap();
    world.update().unwrap();
    assert_eq!(world.transform(world.object_in(attached, 0).unwrap()).unwrap().translation, [50.0, 0.0, -9.0]);
}

#[test]
fn what_is_refused_is_named_by_its_place_and_changes_nothing() {
    let options = RegionOptions::default();
    let error = Region::prepare(&[ball(0.0, 1), ball(f64::NAN, 2)], &options).err().unwrap();
    assert_eq!((error.status, error.item), (Status::NonFinite, Some(1)));
    let error = Region::prepare(&[RegionObject::mesh(3, Transform::default())], &options).err().unwrap();
    assert_eq!((error.status, error.item), (Status::InvalidArgument, Some(0)));
    let few = RegionOptions { max_objects: 1, ..options };
    assert_eq!(Region::prepare(&[ball(0.0, 1), ball(9.0, 2)], &few).err().unwrap().status, Status::OutOfRange);
    let region = Region::prepare(&[ball(0.0, 1)], &options).unwrap();
    let mut world = World::new().unwrap();
    assert_eq!(world.attach(&region, [f64::NAN, 0.0, 0.0]).unwrap_err().status, Status::NonFinite);
    let own = world.add(&Description::bound(Bound::Sphere { center: [0.0; 3], radius: 1.0 })).unwrap();
    world.update().unwrap();
    assert_eq!(world.place_of(own).unwrap_err().status, Status::InvalidArgument);
    assert_eq!(world.object_count(), 1);
}
