// SPDX-License-Identifier: MIT
//! Boxes, meshes and polygons by themselves; what the crate declares.
mod common;
use common::{FACES, TETRAHEDRON};
use crofton::*;

fn cube(x: f64) -> Obb {
    Obb::aligned([x, 0.0, 0.0], [0.5; 3])
}

#[test]
fn boxes_that_touch_meet() {
    assert!(touches(&cube(0.0), &cube(1.0)).unwrap());
    assert!(!touches(&cube(0.0), &cube(1.0 + 1e-12)).unwrap());
}

#[test]
fn boxes_apart_have_a_distance() {
    let s = distance(&cube(0.0), &cube(3.0)).unwrap();
    assert!((s.distance - 2.0).abs() < 1e-9);
    assert!((s.on_a[0] - 0.5).abs() < 1e-9 && (s.on_b[0] - 2.5).abs() < 1e-9);
    assert_eq!(distance(&cube(0.0), &cube(0.7)).unwrap().distance, 0.0);
}

#[test]
fn boxes_that_overlap_have_a_manifold() {
    let m = manifold(&cube(0.0), &cube(0.75)).unwrap().unwrap();
    assert!((m.depth - 0.25).abs() < 1e-9);
    assert!((m.normal[0] - 1.0).abs() < 1e-12);
    assert_eq!(m.points.len(), 4);
    assert!(manifold(&cube(0.0), &cube(2.0)).unwrap().is_none());
}

#[test]
fn a_ray_enters_a_box() {
    let ray = Ray::new([-2.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(ray_enters(&cube(0.0), &ray).unwrap(), Some(1.5));
    assert_eq!(ray_enters(&cube(0.0), &Ray::new([0.0; 3], [1.0, 0.0, 0.0])).unwrap(), Some(0.0));
    assert_eq!(ray_enters(&cube(0.0), &Ray::new([0.0, 2.0, 0.0], [1.0, 0.0, 0.0])).unwrap(), None);
}

#[test]
fn a_bad_box_says_why() {
    let mut bad = cube(0.0);
    bad.axes = [0.0; 9];
    let error = bad.validate().unwrap_err();
    assert!(!error.message.is_empty());
    assert!(cube(0.0).validate().is_ok());
    assert!(touches(&bad, &cube(0.0)).is_err());
}

#[test]
fn a_box_is_transformed() {
    let moved = cube(1.0).transformed(&Transform::at([0.0, 2.0, 0.0])).unwrap();
    assert_eq!(moved.center, [1.0, 2.0, 0.0]);
    let nan = Transform::at([f64::NAN, 0.0, 0.0]);
    assert!(cube(1.0).transformed(&nan).is_err());
}

#[test]
fn a_box_around_points_holds_them_and_no_more() {
    let points: Vec<[f64; 3]> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f64)).map(|p| [3.0 * p[0], 2.0 * p[1], p[2]]).collect();
    for quality in [Quality::Fast, Quality::Tight, Quality::Exact] {
        let b = fit(Points::F64(&points), quality, &Criterion::minimal_perimeter()).unwrap();
        let mut sides = b.half_extents.map(|h| 2.0 * h);
        sides.sort_by(f32::total_cmp);
        for (side, expected) in sides.iter().zip([1.0, 2.0, 3.0]) {
            assert!((side - expected).abs() < 1e-5, "{quality:?}: {sides:?}");
        }
    }
    assert_eq!(
        fit(Points::F32(&[]), Quality::Tight, &Criterion::minimal_perimeter()).unwrap_err().status,
        Status::Empty
    );
}

#[test]
fn criteria_come_from_what_asks() {
    let rays = Criterion::for_rays(f64::INFINITY);
    let rays = rays.or_else(|_| Criterion::for_rays(1e6)).unwrap();
    assert!(rays.area_weight > 0.0);
    let camera = Camera { far: 100.0, ..Camera::default() };
    assert!(Criterion::for_frustum(&camera).unwrap().mean_curvature_weight > 0.0);
    let none = Criterion { volume_weight: 0.0, area_weight: 0.0, mean_curvature_weight: 0.0 };
    assert!(fit(Points::F32(&TETRAHEDRON), Quality::Tight, &none).is_err());
}

#[test]
fn a_box_around_boxes_holds_them() {
    let b = fit_boxes(&[cube(0.0), cube(4.0)], None).unwrap();
    let mut sides = b.half_extents.map(|h| 2.0 * h);
    sides.sort_by(f32::total_cmp);
    assert!((sides[2] - 5.0).abs() < 1e-3 && (sides[0] - 1.0).abs() < 1e-3, "{sides:?}");
    assert!(fit_boxes(&[], None).is_err());
}

#[test]
fn a_square_is_cut_once() {
    let mut triangulator = Triangulator::new().unwrap();
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for method in [Method::Ear, Method::Delaunay, Method::MinimumWeight] {
        let t = triangulator.triangulate(&square, &[4], method).unwrap();
        assert_eq!(t.indices.len(), 2);
        assert!((t.weight - 2f64.sqrt()).abs() < 1e-12);
    }
    assert!(triangulator.triangulate(&square, &[4], Method::MinimumWeight).unwrap().is_optimal);
}

#[test]
fn a_hole_adds_triangles() {
    let mut triangulator = Triangulator::new().unwrap();
    let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]];
    let t = triangulator.triangulate(&points, &[4, 8], Method::MinimumWeight).unwrap();
    assert_eq!(t.indices.len(), 8); // n + 2 h - 2
    let area: f64 = t.indices.iter().map(|i| area(i.map(|k| points[k as usize]))).sum();
    assert!((area - 12.0).abs() < 1e-12);
}

fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
}

#[test]
fn a_polygon_that_crosses_itself_is_an_error() {
    let mut triangulator = Triangulator::new().unwrap();
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert!(triangulator.triangulate(&bow, &[4], Method::Ear).is_err());
    assert!(triangulator.triangulate(&[], &[], Method::Ear).is_err());
}

#[test]
fn meshes_touch_or_are_apart() {
    let mesh = Shape::mesh(&TETRAHEDRON, &FACES, false).unwrap();
    let (here, at) = (mesh.at(Transform::default()), |x| mesh.at(Transform::at([x, 0.0, 0.0])));
    assert!(here.touches(&at(1.0)).unwrap());
    assert!(!here.touches(&at(1.5)).unwrap());
    assert!((here.distance(&at(1.5)).unwrap().distance - 0.5).abs() < 1e-12);
    let skew = Transform { linear: [2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };
    assert!(here.touches(&mesh.at(skew)).is_err());
}

#[test]
fn rays_meet_a_mesh() {
    let mesh = Shape::mesh(&TETRAHEDRON, &FACES, false).unwrap();
    let from = |x| mesh.at(Transform::default()).raycast(&Ray::new([x, 0.2, -1.0], [0.0, 0.0, 1.0])).unwrap();
    let hit = from(0.2).unwrap();
    assert_eq!((hit.t, hit.normal, hit.part.triangle, hit.started_inside), (1.0, [0.0, 0.0, -1.0], 0, false));
    assert_eq!(from(2.0), None);
}

#[test]
fn every_declared_function_is_exported() {
    let libraries =
        [include_str!("../../../engine/c_api/symbols.txt"), include_str!("../../../engine/bake/c_api/symbols.txt")];
    let exported: Vec<&str> = libraries.iter().flat_map(|symbols| symbols.split_whitespace()).collect();
    let source = include_str!("../src/sys.rs");
    let declared: Vec<&str> = source.split("pub fn ").skip(1).map(|rest| rest.split('(').next().unwrap()).collect();
    assert!(declared.len() > 70);
    for name in &declared {
        assert!(exported.contains(name), "{name} is not exported");
    }
}

#[test]
fn versions_agree() {
    let header = include_str!("../../../engine/c_api/include/crofton/capi/base.h");
    let source = include_str!("../src/sys.rs");
    let of_header = header.split("#define CROFTON_API_VERSION ").nth(1).unwrap().split('u').next().unwrap();
    let of_crate = source.split("pub const API_VERSION: u32 = ").nth(1).unwrap().split(';').next().unwrap();
    assert_eq!(of_header, of_crate);
    assert_eq!(version(), env!("CARGO_PKG_VERSION"));
}
