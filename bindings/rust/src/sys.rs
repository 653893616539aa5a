// SPDX-License-Identifier: MIT
//! The C API as it is declared in `crofton/capi/crofton.h`: what the safe types of this crate stand on.
#![allow(non_camel_case_types)]
use std::os::raw::{c_char, c_int, c_void};

pub type Status = c_int;

/// CROFTON_API_VERSION of the headers that this file was written from.
pub const API_VERSION: u32 = 3;

macro_rules! opaque {
    ($($name:ident),*) => {$(
        #[repr(C)]
        pub struct $name {
            private: [u8; 0],
        }
    )*};
}
opaque!(World, ViewResult, Found, Collider, Triangulator);

#[repr(C)]
pub struct Jobs {
    pub size: usize,
    pub user: *mut c_void,
    pub concurrency: u32,
    pub parallel_for: unsafe extern "C" fn(*mut c_void, usize, usize, RangeTask, *mut c_void),
}
pub type RangeTask = unsafe extern "C" fn(*mut c_void, usize, usize, u32);

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Camera {
    pub size: usize,
    pub position: [f64; 3],
    pub forward: [f64; 3],
    pub up: [f64; 3],
    pub projection: u32,
    pub fov_y: f64,
    pub height: f64,
    pub aspect: f64,
    pub near_distance: f64,
    pub far_distance: f64,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Plane {
    pub normal: [f64; 3],
    pub offset: f64,
}

pub const MAX_PLANES: usize = 12;

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Frustum {
    pub size: usize,
    pub plane_count: u32,
    pub origin: [f64; 3],
    pub planes: [Plane; MAX_PLANES],
}

#[repr(C)]
pub struct MeshData {
    pub size: usize,
    pub positions: *const c_void,
    pub position_count: usize,
    pub position_stride: usize,
    pub indices: *const c_void,
    pub index_count: usize,
    pub is_double: u32,
    pub is_short: u32,
    pub triangles: u32,
}

/// The triangles of a collider.
#[repr(C)]
pub struct Mesh {
    pub size: usize,
    pub positions: *const f32,
    pub vertex_count: usize,
    pub indices: *const u32,
    pub index_count: usize,
    pub name: *const c_char,
}

#[repr(C)]
pub struct Bound {
    pub kind: u32,
    pub bounding_box: crate::Obb,
    pub min: [f64; 3],
    pub max: [f64; 3],
    pub center: [f64; 3],
    pub radius: f64,
}

#[repr(C)]
pub struct ObjectDescription {
    pub size: usize,
    pub user: u64,
    pub bound: *const Bound,
    pub transform: *const crate::Transform,
    pub has_mesh: u32,
    pub has_node: u32,
    pub mesh: crate::Mesh,
    pub node: crate::Node,
    pub layers: u32,
    pub collides_with: u32,
    pub occludes: u32,
    pub only_occludes: u32,
    pub body: *const c_void,
}

#[repr(C)]
pub struct WorldOptions {
    pub size: usize,
    pub pairs: u32,
    pub contacts: u32,
    pub containment: u32,
    pub mesh_depth: u32,
    pub max_pairs: u64,
    pub rebuild_budget: u64,
    pub updates_to_rest: u32,
    pub contact_margin: f64,
}

#[repr(C)]
pub struct WorldStatistics {
    pub size: usize,
    pub objects: u64,
    pub resting: u64,
    pub moving: u64,
    pub box_pairs_tested: u64,
    pub contact_pairs_tested: u64,
    pub boxes_changed: u32,
    pub nodes_updated: u32,
    pub out_of_range: u32,
    pub tree_built: u32,
}

#[repr(C)]
pub struct ClosestObject {
    pub size: usize,
    pub object: crate::Object,
    pub user: u64,
    pub distance: f64,
    pub on_shape: [f64; 3],
    pub on_object: [f64; 3],
}

#[repr(C)]
pub struct ObjectContact {
    pub size: usize,
    pub first: crate::ObjectRef,
    pub second: crate::ObjectRef,
    pub phase: u32,
    pub inside: u32,
    pub normal: [f64; 3],
    pub depth: f64,
    pub points: *const crate::ContactPoint,
    pub triangles: *const crate::MeshContact,
    pub point_count: usize,
    pub triangle_count: usize,
}

#[repr(C)]
pub struct FindOptions {
    pub size: usize,
    pub is_two_sided: u32,
    pub max_occluders: u32,
    pub max_edges: u32,
    pub max_boxes_a_piece: u32,
    pub grid: u32,
    pub least_gain: f64,
    pub flatness: f64,
    pub max_patch_triangles: u32,
    pub level_triangles: u32,
}

#[repr(C)]
pub struct DrawLimits {
    pub size: usize,
    pub eye: [f64; 3],
    pub max_distance_in_radii: f64,
    pub least_radius: f64,
    pub layer_distances: *const f32,
    pub item_distances: *const f32,
    pub item_count: usize,
    pub drawn_before: *const u64,
    pub drawn_word_count: usize,
    pub hysteresis: f64,
}

#[repr(C)]
pub struct OcclusionOptions {
    pub size: usize,
    pub width: u32,
    pub height: u32,
    pub max_occluders: u32,
    pub list_occluded: u32,
    pub least_cover: f32,
}

#[repr(C)]
pub struct ViewMatrix {
    pub size: usize,
    pub doubles: *const f64,
    pub floats: *const f32,
    pub is_row_major: u32,
    pub depth: u32,
    pub origin: [f64; 3],
}

#[repr(C)]
pub struct ViewRequest {
    pub size: usize,
    pub camera: *const Camera,
    pub matrix: *const ViewMatrix,
    pub volume: *const Frustum,
    pub layers: u32,
    pub occlusion: *const OcclusionOptions,
    pub limits: *const DrawLimits,
    pub candidate_mask: *const u64,
    pub candidate_words: usize,
    pub conservative: u32,
    pub tree_order: u32,
}

#[repr(C)]
pub struct OcclusionStatistics {
    pub size: usize,
    pub occluders_drawn: u64,
    pub pieces_drawn: u64,
    pub triangles_drawn: u64,
    pub nodes_tested: u64,
    pub nodes_outside: u64,
    pub nodes_hidden: u64,
    pub items_tested: u64,
    pub items_hidden: u64,
}

pub const MAX_MANIFOLD_POINTS: usize = 8;

#[repr(C)]
pub struct Manifold {
    pub size: usize,
    pub normal: [f64; 3],
    pub depth: f64,
    pub point_count: u32,
    pub points: [crate::ContactPoint; MAX_MANIFOLD_POINTS],
}

#[repr(C)]
pub struct FitOptions {
    pub size: usize,
    pub quality: u32,
    pub criterion: crate::Criterion,
}

#[repr(C)]
pub struct Polygon {
    pub size: usize,
    pub points: *const f64,
    pub point_count: usize,
    pub ring_ends: *const u32,
    pub ring_count: usize,
}

#[repr(C)]
pub struct Triangulation {
    pub size: usize,
    pub indices: *const u32,
    pub triangle_count: usize,
    pub weight: f64,
    pub gap: f64,
    pub optimal: u32,
}

extern "C" {
    pub fn crofton_last_error() -> *const c_char;
    pub fn crofton_last_error_item() -> u64;
    pub fn crofton_status_name(status: c_int) -> *const c_char;
    pub fn crofton_api_version() -> u32;
    pub fn crofton_version_string() -> *const c_char;

    pub fn crofton_default_camera() -> Camera;
    pub fn crofton_default_world_options() -> WorldOptions;
    pub fn crofton_default_view_request() -> ViewRequest;
    pub fn crofton_default_view_matrix() -> ViewMatrix;
    pub fn crofton_default_occlusion_options() -> OcclusionOptions;
    pub fn crofton_default_find_options() -> FindOptions;
    pub fn crofton_frustum_from_camera(camera: *const Camera, frustum: *mut Frustum) -> Status;
    pub fn crofton_frustum_from_matrix(
        to_clip: *const f64, depth: u32, origin: *const f64, frustum: *mut Frustum,
    ) -> Status;
    pub fn crofton_boxes_validate(boxes: *const crate::Obb, count: usize) -> Status;
    pub fn crofton_box_transform(
        transform: *const crate::Transform, b: *const crate::Obb, result: *mut crate::Obb,
    ) -> Status;
    pub fn crofton_classify(
        frustum: *const Frustum, boxes: *const crate::Obb, count: usize, verdicts: *mut u8,
    ) -> Status;
    pub fn crofton_boxes_meet(a: *const crate::Obb, b: *const crate::Obb, meet: *mut c_int) -> Status;
    pub fn crofton_boxes_manifold(a: *const crate::Obb, b: *const crate::Obb, manifold: *mut Manifold) -> Status;
    pub fn crofton_boxes_distance(
        a: *const crate::Obb, b: *const crate::Obb, distance: *mut f64, on_a: *mut f64, on_b: *mut f64,
    ) -> Status;
    pub fn crofton_box_raycast(b: *const crate::Obb, ray: *const crate::Ray, t: *mut f64) -> Status;

    pub fn crofton_collider_create(mesh: *const Mesh, collider: *mut *mut Collider) -> Status;
    pub fn crofton_collider_destroy(collider: *mut Collider) -> Status;
    pub fn crofton_colliders_meet(
        a: *const Collider, b: *const Collider, b_to_a: *const crate::Transform, meet: *mut c_int,
    ) -> Status;
    pub fn crofton_colliders_distance(
        a: *const Collider, b: *const Collider, b_to_a: *const crate::Transform, distance: *mut f64, on_a: *mut f64,
        on_b: *mut f64,
    ) -> Status;
    pub fn crofton_collider_raycast(
        collider: *const Collider, rays: *const crate::Ray, count: usize, hits: *mut crate::TriangleHit,
    ) -> Status;

    pub fn crofton_criterion_minimal_perimeter(criterion: *mut crate::Criterion) -> Status;
    pub fn crofton_criterion_for_frustum(camera: *const Camera, criterion: *mut crate::Criterion) -> Status;
    pub fn crofton_criterion_for_rays(length: f64, criterion: *mut crate::Criterion) -> Status;
    pub fn crofton_fit_floats(
        points: *const f32, count: usize, options: *const FitOptions, b: *mut crate::Obb,
    ) -> Status;
    pub fn crofton_fit_doubles(
        points: *const f64, count: usize, options: *const FitOptions, b: *mut crate::Obb,
    ) -> Status;
    pub fn crofton_fit_boxes(
        boxes: *const crate::Obb, count: usize, criterion: *const crate::Criterion, b: *mut crate::Obb,
    ) -> Status;

    pub fn crofton_triangulator_create(triangulator: *mut *mut Triangulator) -> Status;
    pub fn crofton_triangulator_destroy(triangulator: *mut Triangulator) -> Status;
    pub fn crofton_triangulate(
        triangulator: *mut Triangulator, polygon: *const Polygon, method: u32, triangulation: *mut Triangulation,
    ) -> Status;

    pub fn crofton_world_create(options: *const WorldOptions, world: *mut *mut World) -> Status;
    pub fn crofton_world_destroy(world: *mut World) -> Status;
    pub fn crofton_world_add_mesh(world: *mut World, data: *const MeshData, mesh: *mut crate::Mesh) -> Status;
    pub fn crofton_world_replace_mesh(world: *mut World, mesh: crate::Mesh, data: *const MeshData) -> Status;
    pub fn crofton_world_set_vertices(world: *mut World, mesh: crate::Mesh, data: *const MeshData) -> Status;
    pub fn crofton_world_remove_mesh(world: *mut World, mesh: crate::Mesh) -> Status;
    pub fn crofton_world_add_node(
        world: *mut World, parent: *const crate::Node, transform: *const crate::Transform, layers: u32,
        node: *mut crate::Node,
    ) -> Status;
    pub fn crofton_world_remove_node(world: *mut World, node: crate::Node) -> Status;
    pub fn crofton_world_set_parent(world: *mut World, node: crate::Node, parent: *const crate::Node) -> Status;
    pub fn crofton_world_set_node_layers(world: *mut World, node: crate::Node, layers: u32) -> Status;
    pub fn crofton_world_set_node_transforms(
        world: *mut World, nodes: *const crate::Node, node_stride: usize, transforms: *const crate::Transform,
        transform_stride: usize, count: usize,
    ) -> Status;
    pub fn crofton_world_add(
        world: *mut World, description: *const ObjectDescription, object: *mut crate::Object,
    ) -> Status;
    pub fn crofton_world_remove(world: *mut World, object: crate::Object) -> Status;
    pub fn crofton_world_set_transforms(
        world: *mut World, objects: *const crate::Object, object_stride: usize, transforms: *const crate::Transform,
        transform_stride: usize, count: usize,
    ) -> Status;
    pub fn crofton_world_set_boxes(
        world: *mut World, objects: *const crate::Object, object_stride: usize, boxes: *const crate::Obb,
        box_stride: usize, count: usize,
    ) -> Status;
    pub fn crofton_world_set_bound(world: *mut World, object: crate::Object, bound: *const Bound) -> Status;
    pub fn crofton_world_set_mesh(world: *mut World, object: crate::Object, mesh: crate::Mesh) -> Status;
    pub fn crofton_world_set_hidden(world: *mut World, object: crate::Object, hidden: c_int) -> Status;
    pub fn crofton_world_set_layers(world: *mut World, object: crate::Object, layers: u32) -> Status;
    pub fn crofton_world_set_collides_with(world: *mut World, object: crate::Object, layers: u32) -> Status;
    pub fn crofton_world_set_user(world: *mut World, object: crate::Object, user: u64) -> Status;
    pub fn crofton_world_update(world: *mut World, jobs: *const Jobs) -> Status;
    pub fn crofton_world_get_statistics(world: *const World, statistics: *mut WorldStatistics) -> Status;
    pub fn crofton_world_object_count(world: *const World, count: *mut usize) -> Status;
    pub fn crofton_world_contains(world: *const World, object: crate::Object, contains: *mut c_int) -> Status;
    pub fn crofton_world_contains_node(world: *const World, node: crate::Node, contains: *mut c_int) -> Status;
    pub fn crofton_world_contains_mesh(world: *const World, mesh: crate::Mesh, contains: *mut c_int) -> Status;
    pub fn crofton_world_get_user(world: *const World, object: crate::Object, user: *mut u64) -> Status;
    pub fn crofton_world_get_box(world: *const World, object: crate::Object, b: *mut crate::Obb) -> Status;
    pub fn crofton_world_get_transform(
        world: *const World, object: crate::Object, transform: *mut crate::Transform,
    ) -> Status;

    pub fn crofton_view_result_create(result: *mut *mut ViewResult) -> Status;
    pub fn crofton_view_result_destroy(result: *mut ViewResult) -> Status;
    pub fn crofton_world_view(
        world: *const World, request: *const ViewRequest, jobs: *const Jobs, result: *mut ViewResult,
    ) -> Status;
    pub fn crofton_world_view_many(
        world: *const World, requests: *const ViewRequest, count: usize, jobs: *const Jobs, result: *mut ViewResult,
    ) -> Status;
    pub fn crofton_view_result_ids(
        result: *const ViewResult, ids: *mut *const u32, count: *mut usize, verdicts: *mut *const u8,
        inside_count: *mut usize,
    ) -> Status;
    pub fn crofton_view_result_list(
        result: *const ViewResult, world: *const World, first: usize, objects: *mut crate::ObjectRef,
        view_masks: *mut u32, capacity: usize,
    ) -> Status;
    pub fn crofton_view_result_occluded_ids(
        result: *const ViewResult, ids: *mut *const u32, count: *mut usize,
    ) -> Status;
    pub fn crofton_view_result_get_occlusion_statistics(
        result: *const ViewResult, view: usize, statistics: *mut OcclusionStatistics,
    ) -> Status;

    pub fn crofton_world_raycast(
        world: *const World, rays: *const crate::Ray, count: usize, layer_mask: u32, hits: *mut crate::ObjectHit,
    ) -> Status;
    pub fn crofton_world_raycast_any(
        world: *const World, ray: *const crate::Ray, layer_mask: u32, hit: *mut c_int,
    ) -> Status;
    pub fn crofton_found_create(found: *mut *mut Found) -> Status;
    pub fn crofton_found_destroy(found: *mut Found) -> Status;
    pub fn crofton_found_objects(
        found: *const Found, objects: *mut *const crate::ObjectRef, count: *mut usize,
    ) -> Status;
    pub fn crofton_found_hits(found: *const Found, hits: *mut *const crate::ObjectHit, count: *mut usize) -> Status;
    pub fn crofton_world_raycast_all(
        world: *const World, ray: *const crate::Ray, layer_mask: u32, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_overlap_box(
        world: *const World, b: *const crate::Obb, layer_mask: u32, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_overlap_sphere(
        world: *const World, center: *const f64, radius: f64, layer_mask: u32, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_overlap_capsule(
        world: *const World, begin: *const f64, end: *const f64, radius: f64, layer_mask: u32, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_closest_to_box(
        world: *const World, b: *const crate::Obb, max_distance: f64, layer_mask: u32, closest: *mut ClosestObject,
    ) -> Status;
    pub fn crofton_world_closest_to_sphere(
        world: *const World, center: *const f64, radius: f64, max_distance: f64, layer_mask: u32,
        closest: *mut ClosestObject,
    ) -> Status;
    pub fn crofton_world_closest_to_capsule(
        world: *const World, begin: *const f64, end: *const f64, radius: f64, max_distance: f64, layer_mask: u32,
        closest: *mut ClosestObject,
    ) -> Status;
    pub fn crofton_world_pairs(world: *const World, pairs: *mut *const crate::ObjectPair, count: *mut usize) -> Status;
    pub fn crofton_world_contact_count(world: *const World, count: *mut usize) -> Status;
    pub fn crofton_world_contact(world: *const World, contact: usize, result: *mut ObjectContact) -> Status;

    pub fn crofton_world_find_occluders(world: *mut World, mesh: crate::Mesh, options: *const FindOptions) -> Status;
    pub fn crofton_world_occluder_count(world: *const World, mesh: crate::Mesh, count: *mut usize) -> Status;
    pub fn crofton_world_set_occludes(world: *mut World, object: crate::Object, occludes: c_int) -> Status;
}
