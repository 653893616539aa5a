// SPDX-License-Identifier: MIT
//! The C API as declared in `crofton/capi/crofton.h`, used by the safe types of this crate.
#![allow(non_camel_case_types)]
use std::os::raw::{c_char, c_int, c_void};

pub type Status = c_int;

/// CROFTON_API_VERSION of the headers that this file matches.
pub const API_VERSION: u32 = 3;

macro_rules! opaque {
    ($($name:ident),*) => {$(
        #[repr(C)]
        pub struct $name {
            private: [u8; 0],
        }
    )*};
}
opaque!(World, ViewResult, Found, Region, Shape, Triangulator, ClusteredMesh, DepthCuller, Broadphase, Tree);
opaque!(BakedScene, RegionIndex, Pvs);

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
    pub clusters: u32,
    pub one_sided: u32,
    pub precut: *const ClusteredMesh,
}

/// The triangles of a shape.
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
    pub shape: *const Shape,
    pub hidden: u32,
}

#[repr(C)]
pub struct RegionObject {
    pub bound: Bound,
    pub user: u64,
    pub layers: u32,
    pub collides_with: u32,
    pub mesh: u32,
    pub occludes: u32,
    pub only_occludes: u32,
    pub transform: *const crate::Transform,
    pub shape: *const Shape,
}

#[repr(C)]
pub struct RegionOptions {
    pub size: usize,
    pub max_objects: u64,
    pub should_stop: *const c_void,
    pub stop_user: *mut c_void,
    pub meshes: *const MeshData,
    pub mesh_count: usize,
    pub find_occluders: u32,
    pub max_origin: f64,
}

pub const SET_USER: u32 = 1;
pub const SET_LAYERS: u32 = 2;
pub const SET_COLLIDES_WITH: u32 = 4;
pub const SET_HIDDEN: u32 = 8;
pub const SET_OCCLUDES: u32 = 16;
pub const SET_MESH: u32 = 32;
pub const SET_BOUND: u32 = 64;
pub const SET_SHAPE: u32 = 128;

#[repr(C)]
pub struct ObjectInfo {
    pub size: usize,
    pub user: u64,
    pub has_box: u32,
    pub has_transform: u32,
    pub bounding_box: crate::Obb,
    pub transform: crate::Transform,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Clusters {
    pub clusters: *const crate::Cluster,
    pub cluster_count: usize,
    pub triangle_order: *const u32,
    pub triangle_count: usize,
}

#[repr(C)]
pub struct MeshInfo {
    pub size: usize,
    pub occluder_count: usize,
    pub clusters: Clusters,
}

#[repr(C)]
pub struct ShapeDescription {
    pub size: usize,
    pub kind: u32,
    pub radius: f32,
    pub half_height: f32,
    pub half_extents: [f32; 3],
    pub corners: [f32; 9],
    pub plane: Plane,
    pub points: *const f32,
    pub point_count: usize,
    pub max_vertices: u32,
    pub face_tolerance: f32,
    pub mesh: *const Mesh,
    pub height_field: *const HeightField,
    pub front_only: u32,
    pub core: *const Shape,
    pub children: *const *const Shape,
    pub poses: *const crate::Transform,
    pub child_count: usize,
}
pub const SHAPE_SPHERE: u32 = 0;
pub const SHAPE_CAPSULE: u32 = 1;
pub const SHAPE_CYLINDER: u32 = 2;
pub const SHAPE_CONE: u32 = 3;
pub const SHAPE_BOX: u32 = 4;
pub const SHAPE_TRIANGLE: u32 = 5;
pub const SHAPE_HULL: u32 = 6;
pub const SHAPE_HALF_SPACE: u32 = 7;
pub const SHAPE_MESH: u32 = 8;
pub const SHAPE_HEIGHT_FIELD: u32 = 9;
pub const SHAPE_COMPOUND: u32 = 10;
pub const SHAPE_ROUNDED: u32 = 11;

#[repr(C)]
pub struct HeightField {
    pub size: usize,
    pub columns: u32,
    pub rows: u32,
    pub heights: *const f32,
    pub materials: *const u8,
    pub spacing: [f64; 2],
}

#[repr(C)]
pub struct ShapeInfo {
    pub size: usize,
    pub kind: u32,
    pub vertex_count: u32,
    pub face_count: u32,
    pub part_count: u32,
    pub min: [f64; 3],
    pub max: [f64; 3],
    pub max_overshoot: f64,
    pub vertices: *const f32,
    pub indices: *const u16,
    pub index_count: usize,
}

#[repr(C)]
pub struct MassProperties {
    pub size: usize,
    pub volume: f64,
    pub center: [f64; 3],
    pub inertia: [f64; 9],
}

#[repr(C)]
pub struct ShapeDistance {
    pub size: usize,
    pub distance: f64,
    pub lower: f64,
    pub upper: f64,
    pub on_a: [f64; 3],
    pub on_b: [f64; 3],
    pub normal: [f64; 3],
    pub part_a: crate::Part,
    pub part_b: crate::Part,
}

#[repr(C)]
pub struct ShapePenetration {
    pub size: usize,
    pub depth: f64,
    pub lower: f64,
    pub upper: f64,
    pub on_a: [f64; 3],
    pub on_b: [f64; 3],
    pub normal: [f64; 3],
    pub part_a: crate::Part,
    pub part_b: crate::Part,
    pub overlapping: u32,
}

#[repr(C)]
pub struct QueryFilter {
    pub size: usize,
    pub layers: u32,
    pub ignored: *const crate::Object,
    pub ignored_count: usize,
}

#[repr(C)]
pub struct CastOptions {
    pub size: usize,
    pub duration: f64,
    pub tolerance: f64,
    pub max_steps: u32,
    pub ignore_initial_overlaps: u32,
}
pub const CAST_MISS: u32 = 0;
pub const CAST_UNRESOLVED: u32 = 2;

#[repr(C)]
pub struct Impact {
    pub size: usize,
    pub time: f64,
    pub distance: f64,
    pub on_a: [f64; 3],
    pub on_b: [f64; 3],
    pub normal: [f64; 3],
    pub part_a: crate::Part,
    pub part_b: crate::Part,
    pub result: u32,
    pub steps: u32,
}

#[repr(C)]
pub struct ShapeHit {
    pub size: usize,
    pub object: crate::Object,
    pub user: u64,
    pub time: f64,
    pub normal: [f64; 3],
    pub point: [f64; 3],
    pub triangle: u32,
    pub result: u32,
    pub distance: f64,
    pub child: u32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Placed {
    pub shape: *const Shape,
    pub pose: *const crate::Transform,
}

pub const QUERY_SHAPE_BOX: u32 = 0;
pub const QUERY_SHAPE_SPHERE: u32 = 1;
pub const QUERY_SHAPE_CAPSULE: u32 = 2;
pub const QUERY_SHAPE_SHAPE: u32 = 3;

#[repr(C)]
pub struct QueryShape {
    pub kind: u32,
    pub bounding_box: crate::Obb,
    pub begin: [f64; 3],
    pub end: [f64; 3],
    pub radius: f64,
    pub shape: Placed,
}

#[repr(C)]
pub struct ShapeRayHit {
    pub size: usize,
    pub t: f64,
    pub point: [f64; 3],
    pub normal: [f64; 3],
    pub part: crate::Part,
    pub started_inside: u32,
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
    pub object_count: u64,
    pub occluders_waiting: u64,
}

#[repr(C)]
pub struct ClosestObject {
    pub size: usize,
    pub object: crate::Object,
    pub user: u64,
    pub distance: f64,
    pub on_shape: [f64; 3],
    pub on_object: [f64; 3],
    pub triangle: u32,
    pub child: u32,
}

#[repr(C)]
pub struct ObjectContact {
    pub first: crate::ObjectRef,
    pub second: crate::ObjectRef,
    pub phase: u8,
    pub inside: u8,
    pub normal: [f64; 3],
    pub depth: f64,
    pub points: *const crate::ContactPoint,
    pub point_count: usize,
    pub triangles: *const crate::MeshContact,
    pub triangle_count: usize,
    pub shape_points: *mut crate::TrackedPoint,
    pub shape_point_count: usize,
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

pub const OCCLUDER_BOX: u32 = 0;
pub const OCCLUDER_WALLED: u32 = 1;
pub const OCCLUDER_CONVEX: u32 = 2;
pub const OCCLUDER_PATCH: u32 = 3;

#[repr(C)]
pub struct Occluder {
    pub size: usize,
    pub kind: u32,
    pub is_one_sided: u32,
    pub positions: *const f32,
    pub position_count: usize,
    pub indices: *const u32,
    pub index_count: usize,
    pub bounding_box: crate::Obb,
    pub edges: u32,
    pub has_piece: u32,
    pub has_eyes: u32,
    pub piece_min: [f64; 3],
    pub piece_max: [f64; 3],
    pub eyes_min: [f64; 3],
    pub eyes_max: [f64; 3],
    pub mean_shadow: f64,
    pub gain: f64,
}

#[repr(C)]
pub struct DepthObject {
    pub size: usize,
    pub mesh: *const ClusteredMesh,
    pub to_clip: [f32; 16],
    pub one_sided: u32,
    pub hides: u32,
    pub position_error: f32,
}

#[repr(C)]
pub struct DepthReceiver {
    pub mesh: *const ClusteredMesh,
    pub to_map: [f32; 16],
    pub solid: u32,
}

#[repr(C)]
pub struct DepthReceivers {
    pub size: usize,
    pub seen: *const DepthCuller,
    pub objects: *const DepthReceiver,
    pub object_count: usize,
    pub radius: f64,
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
    pub picture: *const PictureView,
    pub receivers: *const ShadowReceivers,
}

#[repr(C)]
pub struct ShadowReceivers {
    pub size: usize,
    pub seen: *const ViewResult,
    pub radius: f64,
}

#[repr(C)]
pub struct PictureView {
    pub size: usize,
    pub width: u32,
    pub height: u32,
    pub depth: u32,
    pub samples: u32,
    pub work_limit: u64,
}

#[repr(C)]
pub struct ViewInfo {
    pub size: usize,
    pub nodes_tested: u64,
    pub boxes_tested: u64,
    pub accepted_whole: u64,
    pub straddling: u64,
    pub exact_tests: u64,
    pub false_positives: u64,
    pub occluders_drawn: u64,
    pub occluder_pieces_drawn: u64,
    pub occluder_triangles_drawn: u64,
    pub occlusion_nodes_tested: u64,
    pub occlusion_nodes_outside: u64,
    pub occlusion_nodes_hidden: u64,
    pub occlusion_items_tested: u64,
    pub occlusion_items_hidden: u64,
    pub occluded_ids: *const u32,
    pub occluded_count: usize,
    pub depth_width: u32,
    pub depth_height: u32,
    pub triangles: *const crate::VisibleCluster,
    pub triangle_cluster_count: usize,
    pub objects_listed: u64,
    pub objects_asked: u64,
    pub clusters_asked: u64,
    pub clusters_drawn: u64,
    pub triangles_drawn: u64,
    pub triangles_listed: u64,
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
pub struct ShapeManifold {
    pub size: usize,
    pub normal: [f64; 3],
    pub depth: f64,
    pub point_count: u32,
    pub points: [crate::ShapePoint; MAX_MANIFOLD_POINTS],
}

#[repr(C)]
pub struct ObjectManifold {
    pub object: crate::Object,
    pub user: u64,
    pub normal: [f64; 3],
    pub depth: f64,
    pub point_count: u32,
    pub points: [crate::ShapePoint; MAX_MANIFOLD_POINTS],
}

#[repr(C)]
pub struct ManifoldOptions {
    pub size: usize,
    pub margin: f64,
    pub max_points: u32,
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

#[repr(C)]
pub struct RegionInfo {
    pub size: usize,
    pub object_count: u64,
    pub bytes: u64,
    pub min: [f64; 3],
    pub max: [f64; 3],
}

#[repr(C)]
pub struct BakedMesh {
    pub size: usize,
    pub positions: *const [f32; 3],
    pub vertex_count: usize,
    pub colors: *const [f32; 3],
    pub indices: *const u32,
    pub index_count: usize,
    pub name: *const u8,
    pub name_length: usize,
    pub bounding_box: crate::Obb,
    pub one_sided: u32,
    pub flat: u32,
    pub unlit: u32,
    pub reserved: u32,
}

#[repr(C)]
pub struct BakedRegionOptions {
    pub size: usize,
    pub triangles: u32,
    pub occluders: u32,
    pub collides_with: u32,
    pub trust_contents: u32,
    pub max_objects: u64,
    pub max_origin: f64,
}

#[repr(C)]
pub struct RegionFile {
    pub name: *const c_char,
    pub origin: [f64; 3],
    pub min: [f64; 3],
    pub max: [f64; 3],
    pub objects: u64,
    pub bytes: u64,
}

extern "C" {
    pub fn crofton_last_error() -> *const c_char;
    pub fn crofton_last_error_item() -> u64;
    pub fn crofton_status_name(status: c_int) -> *const c_char;
    pub fn crofton_api_version() -> u32;
    pub fn crofton_version_string() -> *const c_char;

    pub fn crofton_set_log_hook(
        hook: Option<unsafe extern "C" fn(*mut c_void, u32, *const c_char)>, user: *mut c_void,
    ) -> Status;
    pub fn crofton_log(level: u32, message: *const c_char) -> Status;

    pub fn crofton_default_camera() -> Camera;
    pub fn crofton_default_world_options() -> WorldOptions;
    pub fn crofton_default_view_request() -> ViewRequest;
    pub fn crofton_default_view_matrix() -> ViewMatrix;
    pub fn crofton_default_occlusion_options() -> OcclusionOptions;
    pub fn crofton_default_find_options() -> FindOptions;
    pub fn crofton_default_object_description() -> ObjectDescription;
    pub fn crofton_default_picture_view() -> PictureView;
    pub fn crofton_default_draw_limits() -> DrawLimits;
    pub fn crofton_default_shape_description() -> ShapeDescription;
    pub fn crofton_default_fit_options() -> FitOptions;
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
    pub fn crofton_view_boxes(
        boxes: *const crate::Obb, layer_masks: *const u32, count: usize, request: *const ViewRequest,
        jobs: *const Jobs, result: *mut ViewResult,
    ) -> Status;
    pub fn crofton_draw_limits_of_camera(
        camera: *const Camera, picture_height: f64, pixels: f64, limits: *mut DrawLimits,
    ) -> Status;
    pub fn crofton_broadphase_create(broadphase: *mut *mut Broadphase) -> Status;
    pub fn crofton_broadphase_destroy(broadphase: *mut Broadphase) -> Status;
    pub fn crofton_broadphase_update(
        broadphase: *mut Broadphase, boxes: *const crate::Obb, filters: *const crate::Filter, count: usize,
        jobs: *const Jobs,
    ) -> Status;
    pub fn crofton_broadphase_pairs(
        broadphase: *const Broadphase, which: u32, pairs: *mut *const crate::Pair, count: *mut usize,
    ) -> Status;
    pub fn crofton_boxes_meet(a: *const crate::Obb, b: *const crate::Obb, meet: *mut c_int) -> Status;
    pub fn crofton_boxes_manifold(a: *const crate::Obb, b: *const crate::Obb, manifold: *mut Manifold) -> Status;
    pub fn crofton_boxes_distance(
        a: *const crate::Obb, b: *const crate::Obb, distance: *mut f64, on_a: *mut f64, on_b: *mut f64,
    ) -> Status;
    pub fn crofton_box_raycast(b: *const crate::Obb, ray: *const crate::Ray, t: *mut f64) -> Status;

    pub fn crofton_shape_create(description: *const ShapeDescription, shape: *mut *mut Shape) -> Status;
    pub fn crofton_shape_destroy(shape: *mut Shape) -> Status;
    pub fn crofton_shape_raycast(shape: *const Placed, ray: *const crate::Ray, hit: *mut ShapeRayHit) -> Status;
    pub fn crofton_shape_get_info(shape: *const Shape, info: *mut ShapeInfo) -> Status;
    pub fn crofton_shape_get_mass(shape: *const Shape, mass: *mut MassProperties) -> Status;
    pub fn crofton_shapes_meet(a: *const Placed, b: *const Placed, cache: *mut c_void, meet: *mut c_int) -> Status;
    pub fn crofton_shapes_distance(
        a: *const Placed, b: *const Placed, cache: *mut c_void, distance: *mut ShapeDistance,
    ) -> Status;
    pub fn crofton_shapes_penetration(
        a: *const Placed, b: *const Placed, cache: *mut c_void, penetration: *mut ShapePenetration,
    ) -> Status;
    pub fn crofton_shapes_manifold(
        a: *const Placed, b: *const Placed, options: *const ManifoldOptions, cache: *mut c_void,
        manifold: *mut ShapeManifold,
    ) -> Status;
    pub fn crofton_shape_closest_point(a: *const Placed, point: *const f64, nearest: *mut ShapeDistance) -> Status;
    pub fn crofton_default_cast_options() -> CastOptions;
    pub fn crofton_shapes_cast(
        a: *const Placed, motion_a: *const crate::Motion, b: *const Placed, motion_b: *const crate::Motion,
        options: *const CastOptions, impact: *mut Impact,
    ) -> Status;

    pub fn crofton_default_depth_object() -> DepthObject;
    pub fn crofton_clustered_mesh_create(
        mesh: *const Mesh, max_triangles: u32, clustered: *mut *mut ClusteredMesh,
    ) -> Status;
    pub fn crofton_clustered_mesh_destroy(clustered: *mut ClusteredMesh) -> Status;
    pub fn crofton_clustered_mesh_lend(clustered: *mut ClusteredMesh, mesh: *const Mesh, order: u32) -> Status;
    pub fn crofton_permute_triangles(
        clusters: *const Clusters, indices: *const u32, index_count: usize, permuted: *mut u32,
    ) -> Status;
    pub fn crofton_clustered_mesh_get(clustered: *const ClusteredMesh, clusters: *mut Clusters) -> Status;
    pub fn crofton_clustered_mesh_box(
        clustered: *const ClusteredMesh, cluster: usize, cluster_box: *mut crate::ClusterBox,
    ) -> Status;
    pub fn crofton_clustered_mesh_serialise(
        clustered: *const ClusteredMesh, bytes: *mut u8, capacity: usize, count: *mut usize,
    ) -> Status;
    pub fn crofton_clustered_mesh_deserialise(
        bytes: *const u8, count: usize, clustered: *mut *mut ClusteredMesh,
    ) -> Status;
    pub fn crofton_depth_culler_create(culler: *mut *mut DepthCuller) -> Status;
    pub fn crofton_depth_culler_destroy(culler: *mut DepthCuller) -> Status;
    pub fn crofton_depth_culler_find_visible(
        culler: *mut DepthCuller, objects: *const DepthObject, object_count: usize, picture: *const PictureView,
        jobs: *const Jobs, clusters: *mut *const crate::VisibleCluster, count: *mut usize, statistics: *mut c_void,
    ) -> Status;
    pub fn crofton_depth_culler_find_casters(
        culler: *mut DepthCuller, objects: *const DepthObject, object_count: usize, map: *const PictureView,
        receivers: *const DepthReceivers, jobs: *const Jobs, clusters: *mut *const crate::VisibleCluster,
        count: *mut usize, statistics: *mut c_void,
    ) -> Status;
    pub fn crofton_depth_culler_nearness(culler: *const DepthCuller, x: u32, y: u32, nearness: *mut f32) -> Status;

    pub fn crofton_criterion_for_frustum(camera: *const Camera, criterion: *mut crate::Criterion) -> Status;
    pub fn crofton_criterion_for_rays(length: f64, criterion: *mut crate::Criterion) -> Status;
    pub fn crofton_fit_points(
        points: *const c_void, count: usize, is_double: u32, options: *const FitOptions, b: *mut crate::Obb,
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
    pub fn crofton_world_add_many(
        world: *mut World, descriptions: *const ObjectDescription, count: usize, objects: *mut crate::Object,
    ) -> Status;
    pub fn crofton_world_reserve(world: *mut World, objects: usize) -> Status;
    pub fn crofton_world_remove(world: *mut World, object: crate::Object) -> Status;
    pub fn crofton_world_set_transforms(
        world: *mut World, objects: *const crate::Object, object_stride: usize, transforms: *const crate::Transform,
        transform_stride: usize, count: usize,
    ) -> Status;
    pub fn crofton_world_set_boxes(
        world: *mut World, objects: *const crate::Object, object_stride: usize, boxes: *const crate::Obb,
        box_stride: usize, count: usize,
    ) -> Status;
    pub fn crofton_world_set(
        world: *mut World, object: crate::Object, members: u32, description: *const ObjectDescription,
    ) -> Status;
    pub fn crofton_default_region_object() -> RegionObject;
    pub fn crofton_default_region_options() -> RegionOptions;
    pub fn crofton_region_prepare(
        objects: *const RegionObject, count: usize, options: *const RegionOptions, jobs: *const Jobs,
        region: *mut *mut Region,
    ) -> Status;
    pub fn crofton_region_destroy(region: *mut Region) -> Status;
    pub fn crofton_region_get_info(region: *const Region, info: *mut RegionInfo) -> Status;
    pub fn crofton_region_mesh_of(region: *const Region, place: u32, mesh: *mut u32) -> Status;
    pub fn crofton_region_clusters_of(region: *const Region, mesh: u32, clusters: *mut Clusters) -> Status;
    pub fn crofton_default_baked_region_options() -> BakedRegionOptions;
    pub fn crofton_baked_region_open(
        path: *const c_char, options: *const BakedRegionOptions, jobs: *const Jobs, region: *mut *mut Region,
    ) -> Status;
    pub fn crofton_region_index_open(folder: *const c_char, index: *mut *mut RegionIndex) -> Status;
    pub fn crofton_region_index_destroy(index: *mut RegionIndex) -> Status;
    pub fn crofton_region_index_files(
        index: *const RegionIndex, files: *mut *const RegionFile, count: *mut usize,
    ) -> Status;
    pub fn crofton_region_index_prepare(
        index: *const RegionIndex, place: usize, options: *const BakedRegionOptions, jobs: *const Jobs,
        region: *mut *mut Region,
    ) -> Status;
    pub fn crofton_baked_scene_read(
        path: *const c_char, jobs: *const Jobs, baked: *mut *mut BakedScene, tree: *mut *mut Tree,
    ) -> Status;
    pub fn crofton_baked_scene_destroy(baked: *mut BakedScene) -> Status;
    pub fn crofton_tree_destroy(tree: *mut Tree) -> Status;
    pub fn crofton_baked_scene_mesh_count(baked: *const BakedScene, count: *mut usize) -> Status;
    pub fn crofton_baked_scene_mesh(baked: *const BakedScene, mesh_id: u32, mesh: *mut BakedMesh) -> Status;
    pub fn crofton_baked_scene_clusters(
        baked: *const BakedScene, mesh_id: u32, clustered: *mut *mut ClusteredMesh,
    ) -> Status;
    pub fn crofton_baked_scene_instances(
        baked: *const BakedScene, instances: *mut *const crate::BakedInstance, count: *mut usize,
    ) -> Status;
    pub fn crofton_baked_scene_nodes(
        baked: *const BakedScene, nodes: *mut *const crate::BakedNode, count: *mut usize,
    ) -> Status;
    pub fn crofton_pvs_open(path: *const c_char, pvs: *mut *mut Pvs) -> Status;
    pub fn crofton_pvs_read(bytes: *const u8, count: usize, pvs: *mut *mut Pvs) -> Status;
    pub fn crofton_pvs_destroy(pvs: *mut Pvs) -> Status;
    pub fn crofton_pvs_counts(pvs: *const Pvs, cells: *mut usize, objects: *mut usize) -> Status;
    pub fn crofton_pvs_find_cell(pvs: *const Pvs, eye: *const f64, cell: *mut u32) -> Status;
    pub fn crofton_pvs_visible(
        pvs: *const Pvs, eye: *const f64, mode: u32, words: *mut *const u64, count: *mut usize,
    ) -> Status;
    pub fn crofton_world_attach(
        world: *mut World, region: *const Region, origin: *const f64, attached: *mut crate::AttachedRegion,
    ) -> Status;
    pub fn crofton_world_detach(world: *mut World, region: crate::AttachedRegion) -> Status;
    pub fn crofton_world_object_in(
        world: *const World, region: crate::AttachedRegion, place: u32, object: *mut crate::Object,
    ) -> Status;
    pub fn crofton_world_place_of(
        world: *const World, object: crate::Object, region: *mut crate::AttachedRegion, place: *mut u32,
    ) -> Status;
    pub fn crofton_world_update(world: *mut World, jobs: *const Jobs) -> Status;
    pub fn crofton_world_get_statistics(world: *const World, statistics: *mut WorldStatistics) -> Status;
    pub fn crofton_world_contains_node(world: *const World, node: crate::Node, contains: *mut c_int) -> Status;
    pub fn crofton_world_get_object(world: *const World, object: crate::Object, info: *mut ObjectInfo) -> Status;
    pub fn crofton_world_get_mesh(world: *const World, mesh: crate::Mesh, info: *mut MeshInfo) -> Status;

    pub fn crofton_view_result_create(result: *mut *mut ViewResult) -> Status;
    pub fn crofton_view_result_destroy(result: *mut ViewResult) -> Status;
    pub fn crofton_world_view(
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
    pub fn crofton_view_result_get_view(result: *const ViewResult, view: usize, info: *mut ViewInfo) -> Status;

    pub fn crofton_world_raycast(
        world: *const World, rays: *const crate::Ray, count: usize, filter: *const QueryFilter,
        hits: *mut crate::ObjectHit,
    ) -> Status;
    pub fn crofton_world_raycast_any(
        world: *const World, ray: *const crate::Ray, filter: *const QueryFilter, hit: *mut c_int,
    ) -> Status;
    pub fn crofton_found_create(found: *mut *mut Found) -> Status;
    pub fn crofton_found_destroy(found: *mut Found) -> Status;
    pub fn crofton_found_objects(
        found: *const Found, objects: *mut *const crate::ObjectRef, count: *mut usize,
    ) -> Status;
    pub fn crofton_found_hits(found: *const Found, hits: *mut *const crate::ObjectHit, count: *mut usize) -> Status;
    pub fn crofton_found_shape_hits(found: *const Found, hits: *mut *const ShapeHit, count: *mut usize) -> Status;
    pub fn crofton_found_manifolds(
        found: *const Found, manifolds: *mut *const ObjectManifold, count: *mut usize,
    ) -> Status;
    pub fn crofton_world_raycast_all(
        world: *const World, ray: *const crate::Ray, filter: *const QueryFilter, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_overlap(
        world: *const World, shape: *const QueryShape, filter: *const QueryFilter, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_closest(
        world: *const World, shape: *const QueryShape, max_distance: f64, filter: *const QueryFilter,
        closest: *mut ClosestObject,
    ) -> Status;
    pub fn crofton_world_pairs(world: *const World, pairs: *mut *const crate::ObjectPair, count: *mut usize) -> Status;
    pub fn crofton_world_contacts(
        world: *const World, contacts: *mut *const ObjectContact, count: *mut usize,
    ) -> Status;

    pub fn crofton_world_cast(
        world: *const World, probe: *const Placed, motion: *const crate::Motion, options: *const CastOptions,
        filter: *const QueryFilter, hit: *mut ShapeHit,
    ) -> Status;
    pub fn crofton_world_cast_all(
        world: *const World, probe: *const Placed, motion: *const crate::Motion, options: *const CastOptions,
        filter: *const QueryFilter, found: *mut Found,
    ) -> Status;
    pub fn crofton_world_manifolds(
        world: *const World, probe: *const Placed, options: *const ManifoldOptions, filter: *const QueryFilter,
        found: *mut Found,
    ) -> Status;

    pub fn crofton_world_set_occluders(
        world: *mut World, mesh: crate::Mesh, occluders: *const Occluder, count: usize,
    ) -> Status;
    pub fn crofton_world_get_occluder(
        world: *const World, mesh: crate::Mesh, place: usize, occluder: *mut Occluder,
    ) -> Status;
    pub fn crofton_view_result_occluders(
        result: *const ViewResult, world: *const World, hidden: *const crate::Object,
        occluders: *mut crate::OccluderRef, capacity: usize, count: *mut usize,
    ) -> Status;
    pub fn crofton_view_result_depth(
        result: *const ViewResult, view: usize, nearness: *mut f32, capacity: usize,
    ) -> Status;
    pub fn crofton_world_find_occluders(world: *mut World, mesh: crate::Mesh, options: *const FindOptions) -> Status;
}
