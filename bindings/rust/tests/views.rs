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

// A wall of two triangles in clusters, one behind it, one beside it.
fn walls() -> (World, Mesh, Vec<Object>) {
    let mut world = World::new().unwrap();
    let corners = [[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]];
    let mesh = world.add_mesh(&MeshData { clusters: true, ..MeshData::new(&corners, &[0, 1, 2, 0, 2, 3]) }).unwrap();
    let places = [[0.0, 0.0, -10.0], [0.0, 0.0, -40.0], [20.0, 0.0, -40.0]];
    let objects = places.map(|at| world.add(&Description::mesh(mesh).at(Transform::at(at))).unwrap());
    for _ in 0..40 {
        world.update().unwrap(); // candidates say nothing about what may have moved since
    }
    (world, mesh, objects.to_vec())
}

#[test]
fn a_picture_lists_the_triangles_that_it_needs() {
    let (mut world, mesh, objects) = walls();
    let picture =
        Some(PictureView { width: 160, height: 90, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 });
    let mut visible = ViewResult::new().unwrap();
    let request = ViewRequest { picture, ..Camera::default().into() };
    let seen = world.view(&request, &mut visible).unwrap();
    assert_eq!(seen.ids(), [objects[0].index, objects[2].index]);
    let whole = |object: &Object| VisibleCluster { object: object.index, cluster: 0, triangles: 3 };
    assert_eq!(seen.triangles().unwrap(), [whole(&objects[0]), whole(&objects[2])]);
    let clusters = world.clusters_of(mesh).unwrap().unwrap();
    assert_eq!((clusters.clusters.len(), clusters.clusters[0].triangle_count), (1, 2));
    let mut order = clusters.triangle_order.to_vec();
    order.sort();
    assert_eq!(order, [0, 1]);
    let both = ViewRequest { occlusion: Some(OcclusionOptions::default()), ..request };
    assert_eq!(world.view(&both, &mut visible).err().unwrap().status, Status::InvalidArgument);
    let plain = world.add_mesh(&MeshData::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2])).unwrap();
    assert!(world.clusters_of(plain).unwrap().is_none());
}

#[test]
fn a_light_lists_what_throws_a_shadow_on_what_the_camera_sees() {
    let (world, _, objects) = walls();
    let picture =
        Some(PictureView { width: 160, height: 90, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 });
    let (mut of_camera, mut of_lamp) = (ViewResult::new().unwrap(), ViewResult::new().unwrap());
    let seen = world.view(&ViewRequest { picture, ..Camera::default().into() }, &mut of_camera).unwrap();
    // The second wall is hidden from the camera and from a lamp beside it.
    let lamp = Camera { position: [1.0, 0.0, 1.0], ..Camera::default() };
    let receivers = Some(ShadowReceivers { seen: &seen, radius: 2.0 });
    let request = ViewRequest { picture, receivers, ..lamp.into() };
    let casters = world.view(&request, &mut of_lamp).unwrap();
    assert!(casters.ids().contains(&objects[0].index) && !casters.ids().contains(&objects[1].index));
    let behind = Camera { position: [0.0, 0.0, -30.0], ..Camera::default() };
    let of_behind = ViewRequest { camera: Some(behind), ..request.clone() };
    assert!(world
        .view(&of_behind, &mut of_lamp)
        .unwrap()
        .triangles()
        .unwrap()
        .iter()
        .all(|t| t.object != objects[1].index));
    let no_radius = ViewRequest { receivers: Some(ShadowReceivers { seen: &seen, radius: 0.0 }), ..request.clone() };
    assert_eq!(world.view(&no_radius, &mut of_lamp).err().unwrap().status, Status::OutOfRange);
    let no_map = ViewRequest { picture: None, ..request.clone() };
    assert_eq!(world.view(&no_map, &mut of_lamp).err().unwrap().status, Status::InvalidArgument);
    let (other, _, _) = walls();
    assert_eq!(other.view(&request, &mut of_lamp).err().unwrap().status, Status::InvalidArgument);
}

#[test]
fn each_of_many_views_is_obeyed_as_it_is_alone() {
    let (world, _, objects) = walls();
    let camera = || ViewRequest::from(Camera::default());
    let picture =
        Some(PictureView { width: 160, height: 90, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 });
    let near = DrawLimits { max_distance_in_radii: 5.0, ..DrawLimits::new([0.0; 3]) };
    let distances = [1.0, 100.0, 1.0];
    let by_item = DrawLimits { item_distances: &distances, ..DrawLimits::new([0.0; 3]) };
    let drawn = [0b100u64];
    let kept = DrawLimits { drawn_before: &drawn, hysteresis: 2.0, least_radius: 6.0, ..DrawLimits::new([0.0; 3]) };
    let cases = [
        (camera(), vec![0, 1, 2]),
        (ViewRequest { picture, ..camera() }, vec![0, 2]),
        (ViewRequest { limits: Some(&near), ..camera() }, vec![0]),
        (ViewRequest { limits: Some(&by_item), ..camera() }, vec![1]),
        (ViewRequest { limits: Some(&kept), ..camera() }, vec![2]),
        (ViewRequest { candidate_mask: &[0b010], ..camera() }, vec![1]),
        (ViewRequest { conservative: true, ..camera() }, vec![0, 1, 2]),
        (ViewRequest { layers: 0, ..camera() }, vec![]),
    ];
    let index = |which: &Vec<usize>| which.iter().map(|&i| objects[i].index).collect::<Vec<_>>();
    let mut visible = ViewResult::new().unwrap();
    for (request, expected) in &cases {
        assert_eq!(world.view(request, &mut visible).unwrap().ids(), index(expected));
        let by_tree = ViewRequest { tree_order: true, ..request.clone() };
        let mut ids = world.view(&by_tree, &mut visible).unwrap().ids().to_vec();
        ids.sort();
        assert_eq!(ids, index(expected));
    }
    let requests: Vec<ViewRequest> = cases.iter().map(|(request, _)| request.clone()).collect();
    let seen = world.view_many(None, &requests, &mut visible).unwrap();
    for (v, (_, expected)) in cases.iter().enumerate() {
        let masks = seen.objects().unwrap();
        let ids: Vec<u32> = masks.iter().filter(|(_, m)| m >> v & 1 == 1).map(|(o, _)| o.object.index).collect();
        assert_eq!(ids, index(expected));
        assert_eq!(seen.triangles(v).unwrap().len(), if v == 1 { 2 } else { 0 });
        assert!(seen.occluded_ids(v).unwrap().is_empty());
        assert_eq!(seen.occlusion_statistics(v).unwrap().occluders_drawn, 0);
    }
    assert_eq!(seen.triangles(cases.len()).unwrap_err().status, Status::OutOfRange);
}

#[test]
fn given_occluders_hide_and_say_what_they_hide() {
    let (mut world, wall) = walled();
    let corners: Vec<[f32; 3]> = (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 })).collect();
    let faces = [4, 5, 6, 5, 7, 6];
    let mesh = world.add_mesh(&MeshData::new(&corners, &faces)).unwrap();
    world.set_mesh(wall, mesh).unwrap();
    let occlusion = Some(OcclusionOptions { list_occluded: true, ..Default::default() });
    let request = ViewRequest { occlusion, ..Camera::default().into() };
    let mut visible = ViewResult::new().unwrap();
    let cube = Obb::aligned([0.0; 3], [1.0; 3]);
    let patch = |one_sided| Occluder::Patch { positions: &corners, indices: &faces, one_sided };
    for given in [Occluder::Box(cube), Occluder::Walled(cube), Occluder::Convex(&corners), patch(false), patch(true)] {
        world.set_occluders(mesh, &[]).unwrap();
        world.update().unwrap();
        assert!(world.view(&request, &mut visible).unwrap().occluded_ids().is_empty());
        world.set_occluders(mesh, &[given]).unwrap();
        world.update().unwrap();
        let kept = world.occluder(mesh, 0).unwrap();
        assert_eq!(std::mem::discriminant(&kept), std::mem::discriminant(&given));
        let seen = world.view(&request, &mut visible).unwrap();
        assert_eq!(seen.occluded_ids().len(), 1, "{given:?}");
        let hidden =
            (0..9).map(|i| Object { index: seen.occluded_ids()[0], generation: i }).find(|&o| world.contains(o));
        for asked in [hidden, None] {
            let hiders = seen.occluders(asked).unwrap();
            assert_eq!((hiders.len(), hiders[0].object, hiders[0].user, hiders[0].place), (1, wall, 1, 0));
        }
        assert!(seen.occluders(Some(wall)).unwrap().is_empty());
        // The wall's front is 4 before the camera, in the middle of the picture; nothing is at its corner.
        let depth = seen.depth().unwrap();
        assert_eq!((depth.width, depth.height, depth.nearness.len()), (480, 270, 480 * 270));
        assert!((depth.nearness[135 * 480 + 240] - 0.25).abs() < 0.01 && depth.nearness[0] < -1e38);
    }
    assert_eq!(world.occluder(mesh, 1).unwrap_err().status, Status::OutOfRange);
    let bad = [Occluder::Box(cube), Occluder::Convex(&[[f32::NAN; 3]; 4])];
    let error = world.set_occluders(mesh, &bad).unwrap_err();
    assert_eq!((error.status, error.item), (Status::NonFinite, Some(1)));
    assert_eq!(world.occluder_count(mesh).unwrap(), 1); // nothing has changed
    let many = world.view_many(None, &[request.clone(), Camera::default().into()], &mut visible).unwrap();
    assert_eq!(many.depth(0).unwrap().nearness.len(), 480 * 270);
    assert_eq!(many.depth(1).unwrap_err().status, Status::Empty);
}

#[test]
fn an_object_may_only_hide_or_be_hidden_from_the_start() {
    let (mut world, mesh, objects) = walls();
    world.set_hidden(objects[0], true).unwrap();
    let corners = [[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]];
    let wall = Occluder::Patch { positions: &corners, indices: &[0, 1, 2, 0, 2, 3], one_sided: false };
    world.set_occluders(mesh, &[wall]).unwrap();
    world.add(&Description::mesh(mesh).at(Transform::at([0.0, 0.0, -10.0])).only_occludes()).unwrap();
    world.add(&Description::mesh(mesh).at(Transform::at([0.0, 0.0, -11.0])).hidden()).unwrap();
    world.update().unwrap();
    let request = ViewRequest { occlusion: Some(OcclusionOptions::default()), ..Camera::default().into() };
    let mut visible = ViewResult::new().unwrap();
    assert_eq!(world.view(&request, &mut visible).unwrap().ids(), [objects[2].index]);
}

#[test]
fn a_culler_of_its_own_lists_the_same_triangles_and_takes_clusters_that_were_cut_before() {
    let corners = [[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]];
    let mesh = ClusteredMesh::new(&corners, &[0, 1, 2, 0, 2, 3], 0).unwrap();
    assert_eq!((mesh.clusters().unwrap().clusters.len(), mesh.clusters().unwrap().triangle_order.len()), (1, 2));
    let around = mesh.box_of(0).unwrap();
    for i in 0..3 {
        let extent: f32 = around.half_edges.iter().map(|edge| edge[i].abs()).sum();
        assert!(corners.iter().all(|corner| (corner[i] - around.center[i]).abs() <= extent));
    }
    assert_eq!(mesh.box_of(1).unwrap_err().status, Status::OutOfRange);
    // Reversed depth to infinity: w = -z, near plane 1. Of three walls the second is hidden.
    let place = |x: f32, z: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, x, 0.0, 1.0, -z];
    let object = |x, z| DepthObject::new(&mesh, place(x, z));
    let picture =
        PictureView { width: 160, height: 90, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 };
    let mut culler = DepthCuller::new().unwrap();
    assert_eq!(culler.nearness(0, 0).unwrap_err().status, Status::OutOfRange);
    let objects = [object(0.0, -10.0), object(0.0, -40.0), object(20.0, -40.0)];
    for executor in [None, Some(&Threads(2) as &dyn Executor)] {
        let listed = culler.find_visible(executor, &objects, &picture).unwrap();
        assert_eq!(listed.iter().map(|c| (c.object, c.triangles)).collect::<Vec<_>>(), [(0, 3), (2, 3)]);
    }
    assert!((culler.nearness(80, 45).unwrap() - 0.1).abs() < 1e-6);
    assert_eq!(culler.nearness(0, 0).unwrap(), f32::NEG_INFINITY);
    let glass = DepthObject { hides: false, ..objects[0] };
    assert_eq!(culler.find_visible(None, &[glass, objects[1]], &picture).unwrap().len(), 2);
    let unknown = DepthObject { position_error: -1.0, ..objects[1] }; // listed, and hides nothing
    assert_eq!(culler.find_visible(None, &[objects[0], unknown], &picture).unwrap().len(), 2);
    let empty = PictureView { width: 0, ..picture };
    assert_eq!(culler.find_visible(None, &objects, &empty).unwrap_err().status, Status::OutOfRange);
    // The camera sees one wall. The light is where the camera is: of two casters one is before that wall, one beside it.
    let mut camera = DepthCuller::new().unwrap();
    camera.find_visible(None, &[object(0.0, -20.0)], &picture).unwrap();
    let (casters, map) =
        ([object(0.0, -10.0), object(30.0, -35.0)], PictureView { width: 256, height: 256, ..picture });
    let receiver = DepthReceiver { mesh: &mesh, to_map: place(0.0, -20.0), solid: false };
    assert_eq!(culler.find_visible(None, &casters, &map).unwrap().len(), 2);
    for executor in [None, Some(&Threads(2) as &dyn Executor)] {
        let needed = culler.find_casters(executor, &casters, &map, &camera, &[receiver], 1.0).unwrap();
        assert_eq!(needed.iter().map(|c| c.object).collect::<Vec<_>>(), [0]);
    }
    let refused = |receivers: &[_], radius| {
        let mut light = DepthCuller::new().unwrap();
        let error = light.find_casters(None, &casters, &map, &camera, receivers, radius).unwrap_err();
        (error.status, error.item)
    };
    assert_eq!(refused(&[], 1.0).0, Status::InvalidArgument);
    assert_eq!(refused(&[receiver], 0.0).0, Status::OutOfRange);
    let stored = ClusteredMesh::from_bytes(&mesh.to_bytes().unwrap()).unwrap();
    assert_eq!(refused(&[DepthReceiver { mesh: &stored, ..receiver }], 1.0), (Status::InvalidArgument, Some(0)));
    assert_eq!(stored.to_bytes().unwrap(), mesh.to_bytes().unwrap());
    assert_eq!(ClusteredMesh::from_bytes(&stored.to_bytes().unwrap()[1..]).unwrap_err().status, Status::Parse);
    assert_eq!(ClusteredMesh::from_bytes(&[]).unwrap_err().status, Status::Parse);

    assert!(ClusteredMesh::new(&corners, &[0, 1, 7], 0).is_err());
    assert!(ClusteredMesh::new(&corners, &[0, 1, 2], 65).is_err());

    let mut world = World::new().unwrap();
    let precut = MeshData { clusters: true, precut: Some(&mesh), ..MeshData::new(&corners, &[0, 1, 2, 0, 2, 3]) };
    let placed = world.add_mesh(&precut).unwrap();
    world.update().unwrap();
    let order = mesh.clusters().unwrap().triangle_order.to_vec();
    assert_eq!(world.clusters_of(placed).unwrap().unwrap().triangle_order, order);
    let other = MeshData { indices: Indices::U32(&[0, 1, 2]), ..precut };
    assert_eq!(world.add_mesh(&other).unwrap_err().status, Status::InvalidArgument);
}

#[test]
fn clusters_read_arrays_that_are_lent_and_indices_are_put_in_their_order() {
    let corners: std::sync::Arc<[[f32; 3]]> =
        vec![[-3.0, -3.0, 0.0], [3.0, -3.0, 0.0], [3.0, 3.0, 0.0], [-3.0, 3.0, 0.0]].into();
    let indices = [0, 1, 2, 0, 2, 3];
    let mut mesh = ClusteredMesh::new(&corners, &indices, 1).unwrap();
    let permuted = mesh.clusters().unwrap().permute(&indices).unwrap();
    let order = mesh.clusters().unwrap().triangle_order.to_vec();
    let expected: Vec<u32> = order.iter().flat_map(|&t| indices[3 * t as usize..][..3].to_vec()).collect();
    assert_eq!(permuted, expected);
    assert!(mesh.clusters().unwrap().permute(&indices[3..]).is_err());
    let other = mesh.lend(corners.clone(), vec![0, 1, 2, 0, 2, 1].into(), IndexOrder::Original).unwrap_err();
    assert_eq!((other.status, other.item.is_some()), (Status::InvalidArgument, true));
    mesh.lend(corners.clone(), indices.to_vec().into(), IndexOrder::Original).unwrap();
    assert_eq!(mesh.clusters().unwrap().triangle_order, order);
    mesh.lend(corners.clone(), permuted.into(), IndexOrder::Permuted).unwrap();
    assert!(mesh.clusters().unwrap().triangle_order.is_empty());
    drop(corners); // the mesh has it still
    let picture =
        PictureView { width: 160, height: 90, depth: DepthRange::ReversedZeroToOne, samples: 1, work_limit: 0 };
    let place = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 10.0];
    let mut culler = DepthCuller::new().unwrap();
    assert_eq!(culler.find_visible(None, &[DepthObject::new(&mesh, place)], &picture).unwrap().len(), 2);
}

#[test]
fn boxes_alone_are_viewed_and_limits_come_from_a_camera() {
    let boxes: Vec<Obb> = (0..100).map(|i| Obb::aligned([0.0, 0.0, 200.0 - 4.0 * i as f64], [0.5; 3])).collect();
    let camera = Camera::default();
    let verdicts = classify(&camera.frustum().unwrap(), &boxes).unwrap();
    let expected: Vec<u32> = (0..100).filter(|&i| verdicts[i as usize] != Verdict::Outside).collect();
    assert!(expected.len() > 40);
    let mut result = ViewResult::new().unwrap();
    assert_eq!(view_boxes(&boxes, None, &camera.into(), &mut result).unwrap(), expected);
    let layers: Vec<u32> = (0..100).map(|i| 1 << (i % 2)).collect();
    let even = ViewRequest { layers: 1, ..camera.into() };
    let halves: Vec<u32> = expected.iter().copied().filter(|i| i % 2 == 0).collect();
    assert_eq!(view_boxes(&boxes, Some(&layers), &even, &mut result).unwrap(), halves);
    assert_eq!(view_boxes(&boxes, Some(&layers[1..]), &even, &mut result).unwrap_err().status, Status::InvalidArgument);
    let occluded = ViewRequest { occlusion: Some(OcclusionOptions::default()), ..camera.into() };
    assert_eq!(view_boxes(&boxes, None, &occluded, &mut result).unwrap_err().status, Status::Unsupported);
    // A sphere around a box has radius sqrt(3) / 2. One pixel of 1000 is d * 2 tan(30 degrees) / 1000 wide at distance d.
    let limits = DrawLimits::of_camera(&camera, 1000.0, 10.0).unwrap();
    let farthest = 0.75f64.sqrt() * 2.0 * 1000.0 / (10.0 * 2.0 * (std::f64::consts::PI / 6.0).tan());
    let near: Vec<u32> = expected.iter().copied().filter(|&i| -boxes[i as usize].center[2] < farthest).collect();
    assert!(near.len() < expected.len() && near.len() > 10);
    assert_eq!(
        view_boxes(&boxes, None, &ViewRequest { limits: Some(&limits), ..camera.into() }, &mut result).unwrap(),
        near
    );
    assert!(DrawLimits::of_camera(&camera, 1000.0, -1.0).is_err());
}

#[test]
fn tree_order_says_how_many_lie_inside() {
    let (world, _) = row(3);
    let mut visible = ViewResult::new().unwrap();
    let request = ViewRequest { tree_order: true, ..Camera::default().into() };
    let seen = world.view(&request, &mut visible).unwrap();
    assert_eq!((seen.ids().len(), seen.inside_count()), (3, 3));
    assert_eq!(world.view(&Camera::default().into(), &mut visible).unwrap().inside_count(), 3);
}
