// SPDX-License-Identifier: MIT
//! Every call with numbers that are none, huge, negative or denormal, and with places far beyond the end: each answers, or names an error, and a
//! world is afterwards as it was.
mod common;
use common::{row, FACES, TETRAHEDRON};
use crofton::*;

const NUMBERS: [f64; 9] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 5e-324, -1.0, 0.0, 1e20];
const PLACES: [u32; 4] = [1, 65_537, u32::MAX / 2 + 1, u32::MAX];

/// Names its error, if it is one.
fn told<T>(what: &str, result: Result<T>) {
    if let Err(error) = result {
        assert!(!error.to_string().trim().is_empty(), "{what}");
    }
}

fn pose(x: f64) -> Transform {
    Transform { linear: [x, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, x], translation: [x; 3] }
}

#[test]
fn numbers_that_are_none_end_no_call_without_a_name() {
    let ball = Shape::sphere(1.0).unwrap();
    for x in NUMBERS {
        let (point, small) = ([x, 0.0, -x], x as f32);
        let obb = Obb::aligned(point, [small; 3]);
        let ray = Ray::new(point, [0.0, x, -1.0]);
        let camera = Camera { position: point, projection: Projection::Perspective { fov_y: x }, ..Default::default() };
        told("shapes", Shape::sphere(small));
        told("shapes", Shape::capsule(small, small));
        told("shapes", Shape::cylinder(small, 1.0));
        told("shapes", Shape::cone(1.0, small));
        told("shapes", Shape::cuboid([small, 1.0, small]));
        told("shapes", Shape::triangle([[small; 3], [0.0; 3], [1.0; 3]]));
        told("shapes", Shape::hull(&[[small; 3], [0.0; 3], [1.0, small, 0.0], [0.0, 0.0, 1.0]], 4));
        told("shapes", Shape::half_space(point, x));
        told("shapes", Shape::mesh(&[[small; 3], [0.0; 3], [1.0; 3]], &[0, 1, 2], true));
        told("shapes", Shape::rounded(&ball, small));
        let heights = [small; 4];
        told(
            "shapes",
            Shape::height_field(&HeightField { columns: 2, heights: &heights, materials: &[], spacing: [x; 2] }, false),
        );
        told("shapes", Shape::compound(&[ball.at(pose(x))]));
        let (one, other) = (ball.at(pose(x)), ball.at(Transform::default()));
        told("touches", one.touches(&other));
        told("distance", one.distance(&other));
        told("penetration", one.penetration(&other));
        told("contacts", one.contacts(&other, x, 9));
        told("closest", other.closest_point(point));
        told("raycast", one.raycast(&ray));
        told("boxes", obb.validate());
        told("boxes", obb.transformed(&pose(x)));
        told("boxes", touches(&obb, &obb));
        told("boxes", distance(&obb, &obb));
        told("boxes", manifold(&obb, &obb));
        told("boxes", ray_enters(&obb, &ray));
        told("boxes", fit_boxes(&[obb, obb], None));
        told("camera", camera.frustum());
        told("camera", Frustum::from_matrix(&[x; 16], DepthRange::ZeroToOne, point));
        told("camera", Frustum::from_planes(point, &[(point, x)]));
        told("camera", DrawLimits::of_camera(&camera, x, x));
        told("criteria", Criterion::for_rays(x));
        told("criteria", Criterion::for_frustum(&camera));
        told("polygons", Triangulator::new().unwrap().triangulate(&[[x, 0.0], [0.0, x], [x, x]], &[], Method::Ear));
        told("clusters", ClusteredMesh::new(&[[small; 3], [0.0; 3], [1.0; 3]], &[0, 1, 2], 1000));
        told(
            "regions",
            Region::prepare(
                &[RegionObject::bound(Bound::Box(obb))],
                &RegionOptions { max_origin: x, ..Default::default() },
            ),
        );
    }
}

#[test]
fn a_world_is_as_before_whatever_was_asked_of_it() {
    let (mut world, objects) = row(3);
    let mesh = world.add_mesh(&MeshData::new(&TETRAHEDRON, &FACES)).unwrap();
    let ball = Shape::sphere(1.0).unwrap();
    let region = Region::prepare(
        &[RegionObject::bound(Bound::Sphere { center: [0.0; 3], radius: 1.0 })],
        &RegionOptions::default(),
    )
    .unwrap();
    world.update().unwrap();
    let canary = |world: &World| {
        let hit = world.raycast(&Ray::new([2.0, 0.0, 0.0], [0.0, 0.0, -1.0]), u32::MAX).unwrap().unwrap();
        assert_eq!((hit.user, hit.t, world.object_count()), (2, 4.75, 3));
    };
    canary(&world);
    for x in NUMBERS.into_iter().filter(|x| !(x.abs() < 1e-3)) {
        let (point, small) = ([x, 0.0, -x], x as f32);
        let ray = Ray::new(point, [0.0, x, -1.0]);
        told("add_mesh", world.add_mesh(&MeshData::new(&[[small; 3]; 3], &[0, 1, 2])));
        told("set_vertices", world.set_vertices(mesh, Vertices::F32(&[[f32::NAN; 3]; 4])));
        told("raycast", world.raycast(&ray, 0));
        told("raycast_any", world.raycast_any(&ray, u32::MAX));
        told("raycasts", world.raycasts(&[ray, ray], u32::MAX));
        told("attach", world.attach(&region, [f64::NAN, x, 0.0]));
        told(
            "view",
            ViewResult::new().and_then(|mut result| {
                world.view(&Camera { near: x, ..Default::default() }.into(), &mut result).map(|_| ())
            }),
        );
        told("reserve", world.reserve(usize::MAX));
        if !x.is_finite() {
            assert!(world.add(&Description::shape(&ball).at(pose(x))).is_err());
            assert!(world.set_boxes(&objects[..1], &[Obb::aligned(point, [1.0; 3])]).is_err());
            assert!(world.set_bound(objects[0], Bound::Aligned { min: point, max: point }).is_err());
            assert!(world.add_node(None, &pose(x), 1).is_err());
        }
        world.update().unwrap();
        canary(&world);
    }
    for index in PLACES {
        for generation in [0, 1, u32::MAX] {
            let stale = Object { index: index.max(100), generation };
            assert_eq!(world.remove(stale).unwrap_err().status, Status::StaleHandle);
            assert!(world.obb(stale).is_err() && world.user(stale).is_err() && world.set_hidden(stale, true).is_err());
            assert!(world.set_shape(stale, Some(&ball)).is_err() && world.set_layers(stale, 1).is_err());
            let (node, no_mesh) = (Node { index, generation }, Mesh { index: index.max(100), generation });
            assert!(world.set_parent(node, Some(node)).is_err() && world.remove_node(node).is_err());
            assert!(world.remove_mesh(no_mesh).is_err() && world.set_mesh(objects[0], no_mesh).is_err());
            assert!(world.occluder_count(no_mesh).is_err() && world.add(&Description::mesh(no_mesh)).is_err());
            assert!(world.detach(AttachedRegion { index, generation }).is_err());
        }
        told("mesh_of", region.mesh_of(index));
        told("clusters_of", region.clusters_of(index));
    }
    world.update_on(&Threads(u32::MAX)).unwrap();
    canary(&world);
}
