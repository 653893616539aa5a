// SPDX-License-Identifier: MIT
//! Scenes, regions and visible sets from files.
mod common;
use common::{FACES, TETRAHEDRON};
use crofton::*;
use std::{
    ffi::CString, os::raw::c_char, os::raw::c_int, os::raw::c_void, path::Path, path::PathBuf, process::Command, ptr,
};

// What bakes, which the crate leaves to the command line.
#[repr(C)]
struct MeshToBake {
    size: usize,
    positions: *const [f32; 3],
    vertex_count: usize,
    indices: *const u32,
    index_count: usize,
    name: *const c_char,
}
extern "C" {
    fn crofton_scene_create(scene: *mut *mut c_void) -> c_int;
    fn crofton_scene_destroy(scene: *mut c_void) -> c_int;
    fn crofton_scene_add_mesh(scene: *mut c_void, mesh: *const MeshToBake, id: *mut u32) -> c_int;
    fn crofton_scene_add_node(
        scene: *mut c_void, parent: u32, local: *const Transform, layers: u32, node: *mut u32,
    ) -> c_int;
    fn crofton_scene_add_instance(scene: *mut c_void, node: u32, mesh: u32, instance: *mut u32) -> c_int;
    fn crofton_scene_update(scene: *mut c_void, jobs: *const c_void, statistics: *mut c_void) -> c_int;
    fn crofton_scene_bake(scene: *const c_void, path: *const c_char, jobs: *const c_void) -> c_int;
}

struct Folder(PathBuf);
impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("crofton-rust-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
}
impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).unwrap();
    }
}

/// Tetrahedra along x at 0, 10, 20.
fn bake(path: &Path) {
    let path = CString::new(path.to_str().unwrap()).unwrap();
    unsafe {
        let (mut scene, mut mesh, mut node, mut instance) = (ptr::null_mut(), 0, 0, 0);
        assert_eq!(crofton_scene_create(&mut scene), 0);
        let given = MeshToBake {
            size: std::mem::size_of::<MeshToBake>(),
            positions: TETRAHEDRON.as_ptr(),
            vertex_count: 4,
            indices: FACES.as_ptr(),
            index_count: 12,
            name: b"rock\0".as_ptr() as *const c_char,
        };
        assert_eq!(crofton_scene_add_mesh(scene, &given, &mut mesh), 0);
        for i in 0..3 {
            let place = Transform::at([10.0 * i as f64, 0.0, 0.0]);
            assert_eq!(crofton_scene_add_node(scene, u32::MAX, &place, u32::MAX, &mut node), 0);
            assert_eq!(crofton_scene_add_instance(scene, node, mesh, &mut instance), 0);
        }
        assert_eq!(crofton_scene_update(scene, ptr::null(), ptr::null_mut()), 0);
        assert_eq!(crofton_scene_bake(scene, path.as_ptr(), ptr::null()), 0);
        assert_eq!(crofton_scene_destroy(scene), 0);
    }
}

fn hits(world: &World) -> Vec<(u64, f64)> {
    let ray = Ray::new([-1.0, 0.1, 0.1], [1.0, 0.0, 0.0]);
    let mut found = Found::new().unwrap();
    world.raycast_all(&ray, ALL_LAYERS, &mut found).unwrap().iter().map(|hit| (hit.user, hit.t)).collect()
}

#[test]
fn a_scene_from_a_file_has_its_meshes_and_where_they_stand() {
    let folder = Folder::new("scene");
    let path = folder.0.join("rocks.crofton");
    bake(&path);
    let scene = BakedScene::open(&path).unwrap();
    std::fs::remove_file(&path).unwrap(); // it was read
    assert_eq!(scene.mesh_count(), 1);
    let mesh = scene.mesh(0).unwrap();
    assert_eq!((mesh.name, mesh.positions, mesh.indices), ("rock", &TETRAHEDRON[..], &FACES[..]));
    assert!(mesh.colors.is_empty() && !mesh.unlit);
    assert_eq!(scene.mesh(1).unwrap_err().status, Status::OutOfRange);
    let clusters = scene.clusters(0).unwrap().unwrap();
    assert_eq!(clusters.clusters().unwrap().triangle_order.len(), 4);
    let nodes = scene.nodes().unwrap();
    let at: Vec<f64> = scene.instances().unwrap().iter().map(|i| nodes[i.node as usize].world.translation[0]).collect();
    assert_eq!(at, [0.0, 10.0, 20.0]);
    assert_eq!(nodes[0].parent, u32::MAX);

    let mut world = World::new().unwrap();
    let added = world.add_mesh(&MeshData::new(mesh.positions, mesh.indices)).unwrap();
    for (i, instance) in scene.instances().unwrap().iter().enumerate() {
        let place = nodes[instance.node as usize].world;
        world.add(&Description::mesh(added).at(place).user(i as u64)).unwrap();
    }
    world.update().unwrap();
    assert_eq!(hits(&world).iter().map(|hit| hit.0).collect::<Vec<_>>(), [0, 1, 2]);
    let missing = BakedScene::open(&path).err().unwrap();
    assert_eq!(missing.status, Status::Io);
    assert!(missing.message.contains("rocks.crofton"), "{missing}");
    assert_eq!(BakedScene::open("a\0b").err().unwrap().status, Status::InvalidArgument);
}

#[test]
fn a_region_from_a_file_answers_as_its_objects_would() {
    let folder = Folder::new("region");
    let path = folder.0.join("rocks.crofton");
    bake(&path);
    let options = BakedRegionOptions::default();
    for executor in [None, Some(&Threads(2) as &dyn Executor)] {
        let region = Region::open(executor, &path, &options).unwrap();
        let info = region.info().unwrap();
        assert_eq!(info.object_count, 3);
        assert!(info.min[0] <= 0.0 && info.max[0] >= 21.0 && info.max[0] < 21.1 && info.bytes > 0);
        assert_eq!(region.mesh_of(2).unwrap(), Some(0));
        assert_eq!(region.mesh_of(3).unwrap_err().status, Status::OutOfRange);
        assert_eq!(region.clusters_of(0).unwrap().unwrap().clusters[0].triangle_count, 4);
        assert!(region.clusters_of(1).unwrap().is_none());
        let mut world = World::new().unwrap();
        world.attach(&region, [100.0, 0.0, 0.0]).unwrap();
        drop(region);
        world.update().unwrap();
        assert_eq!(hits(&world), [(0, 101.0), (1, 111.0), (2, 121.0)]);
    }
    let few = BakedRegionOptions { max_objects: 2, ..options };
    assert_eq!(Region::open(None, &path, &few).err().unwrap().status, Status::OutOfRange);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    assert_eq!(Region::open(None, &path, &options).err().unwrap().status, Status::Parse);
    assert_eq!(RegionIndex::open(&folder.0).err().unwrap().status, Status::Io);
    assert_eq!(Pvs::open(&path).err().unwrap().status, Status::Parse);
    assert_eq!(Pvs::from_bytes(&bytes).err().unwrap().status, Status::Parse); // a scene without sets
    assert_eq!(Pvs::from_bytes(&[]).err().unwrap().status, Status::Parse);
}

/// Runs the command line, where it has been built or is installed.
fn command(arguments: &[&str]) -> bool {
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../build/release/bin/crofton");
    let program = if built.exists() { built } else { PathBuf::from("crofton") };
    match Command::new(program).args(arguments).output() {
        Err(_) => {
            eprintln!("not tested: there is no command line");
            false
        }
        Ok(out) => {
            assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
            true
        }
    }
}

#[test]
fn a_folder_of_regions_and_its_visible_sets_are_opened() {
    let folder = Folder::new("town");
    let path = folder.0.to_str().unwrap();
    if !command(&["bake", "town", "--instances", "400", "--regions", "2x2", "--folder", path]) {
        return;
    }
    assert!(command(&["pvs", path, "--cells", "2x1x2", "--reach", "20"]));
    let index = RegionIndex::open(&folder.0).unwrap();
    let files = index.files();
    assert_eq!(files.len(), 4);
    let mut world = World::new().unwrap();
    for (place, file) in files.iter().enumerate() {
        let region = index.prepare(Some(&Threads(2)), place, &BakedRegionOptions::default()).unwrap();
        assert_eq!(region.info().unwrap().object_count, file.objects);
        assert_eq!(file.bytes, std::fs::metadata(folder.0.join(&file.name)).unwrap().len());
        assert!(file.min[0] <= file.max[0]);
        world.attach(&region, file.origin).unwrap();
        let sets = folder.0.join(file.name.replace(".crofton", ".sets.crofton"));
        let pvs = Pvs::open(&sets).unwrap();
        assert_eq!((pvs.object_count() as u64, pvs.cell_count()), (file.objects, 4));
        let same = Pvs::from_bytes(&std::fs::read(&sets).unwrap()).unwrap();
        let away = [1e6, 0.0, 0.0];
        assert_eq!(pvs.find_cell(away).unwrap(), None);
        assert!(pvs.visible(away, PvsMode::Conservative).unwrap().is_empty());
        // Some eye above the streets is in a cell.
        let eyes = (-20..20).map(|x| [x as f64 + 0.5, 1.7, 0.5]);
        let mut found = 0;
        for eye in eyes {
            let seen = pvs.visible(eye, PvsMode::Conservative).unwrap();
            assert_eq!(seen, same.visible(eye, PvsMode::Conservative).unwrap());
            found += pvs.find_cell(eye).unwrap().is_some() as u32;
            assert_eq!(pvs.find_cell(eye).unwrap().is_some(), !seen.is_empty());
        }
        assert!(found > 0);
        assert_eq!(pvs.find_cell([f64::NAN; 3]).unwrap_err().status, Status::NonFinite);
    }
    world.update().unwrap();
    assert_eq!(world.object_count(), files.iter().map(|f| f.objects as usize).sum::<usize>());
    let none = index.prepare(None, 4, &BakedRegionOptions::default()).err().unwrap();
    assert_eq!((none.status, none.item), (Status::OutOfRange, Some(4)));
}
