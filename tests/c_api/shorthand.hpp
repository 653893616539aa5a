// SPDX-License-Identifier: MIT
// Single questions and changes as tests write them, each by the call of the C API that takes a description.
#pragma once
#include <crofton/capi/bake.h>
#include <crofton/capi/crofton.h>

#include <algorithm>

namespace crofton::capi_test {

// ---- Shapes ----

template <class Fill>
crofton_status shape_of_kind(std::uint32_t kind, crofton_shape** shape, Fill fill) {
    crofton_shape_description description = crofton_default_shape_description();
    description.kind = kind;
    fill(description);
    return crofton_shape_create(&description, shape);
}
inline crofton_status shape_sphere(float radius, crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_SPHERE, shape, [&](auto& d) { d.radius = radius; });
}
inline crofton_status shape_round(std::uint32_t kind, float half_height, float radius, crofton_shape** shape) {
    return shape_of_kind(kind, shape, [&](auto& d) {
        d.half_height = half_height;
        d.radius = radius;
    });
}
inline crofton_status shape_box(const float half[3], crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_BOX, shape, [&](auto& d) { std::copy_n(half, 3, d.half_extents); });
}
inline crofton_status shape_triangle(const float corners[9], crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_TRIANGLE, shape, [&](auto& d) { std::copy_n(corners, 9, d.corners); });
}
inline crofton_status shape_half_space(const crofton_plane* plane, crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_HALF_SPACE, shape, [&](auto& d) { d.plane = *plane; });
}
inline crofton_status shape_hull(const float* points, std::size_t count, crofton_shape** shape,
                                 std::uint32_t max_vertices = 0, float face_tolerance = 0.0f) {
    return shape_of_kind(CROFTON_SHAPE_HULL, shape, [&](auto& d) {
        d.points = points;
        d.point_count = count;
        d.max_vertices = max_vertices;
        d.face_tolerance = face_tolerance;
    });
}
inline crofton_status shape_rounded(const crofton_shape* core, float radius, crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_ROUNDED, shape, [&](auto& d) {
        d.core = core;
        d.radius = radius;
    });
}
inline crofton_status shape_mesh(const crofton_mesh* mesh, std::uint32_t front_only, crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_MESH, shape, [&](auto& d) {
        d.mesh = mesh;
        d.front_only = front_only;
    });
}
inline crofton_status shape_height_field(const crofton_height_field* field, std::uint32_t both_sides,
                                         crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_HEIGHT_FIELD, shape, [&](auto& d) {
        d.height_field = field;
        d.front_only = both_sides ? 0 : 1;
    });
}
inline crofton_status shape_compound(const crofton_shape* const* children, const crofton_transform* poses,
                                     std::size_t count, crofton_shape** shape) {
    return shape_of_kind(CROFTON_SHAPE_COMPOUND, shape, [&](auto& d) {
        d.children = children;
        d.poses = poses;
        d.child_count = count;
    });
}

// ---- Shapes that World and trees are asked with ----

inline crofton_query_shape shape_of(const crofton_box& box) {
    crofton_query_shape probe{};
    probe.kind = CROFTON_QUERY_SHAPE_BOX;
    probe.box = box;
    return probe;
}
inline crofton_query_shape shape_of(const crofton_placed& shape) {
    crofton_query_shape probe{};
    probe.kind = CROFTON_QUERY_SHAPE_SHAPE;
    probe.shape = shape;
    return probe;
}
inline crofton_query_shape sphere_shape(const double center[3], double radius) {
    crofton_query_shape probe{};
    probe.kind = CROFTON_QUERY_SHAPE_SPHERE;
    std::copy_n(center, 3, probe.begin);
    probe.radius = radius;
    return probe;
}
inline crofton_query_shape capsule_shape(const double begin[3], const double end[3], double radius) {
    crofton_query_shape probe = sphere_shape(begin, radius);
    probe.kind = CROFTON_QUERY_SHAPE_CAPSULE;
    std::copy_n(end, 3, probe.end);
    return probe;
}
inline crofton_query_filter in_layers(std::uint32_t layers) {
    crofton_query_filter filter = crofton_default_query_filter();
    filter.layers = layers;
    return filter;
}
template <class Given>
crofton_status world_overlap(const crofton_world* world, const Given* given, const crofton_query_filter* filter,
                             crofton_found* found) {
    const crofton_query_shape probe = given ? shape_of(*given) : crofton_query_shape{};
    return crofton_world_overlap(world, given ? &probe : nullptr, filter, found);
}
inline crofton_status world_overlap_sphere(const crofton_world* world, const double center[3], double radius,
                                           const crofton_query_filter* filter, crofton_found* found) {
    const crofton_query_shape probe = sphere_shape(center, radius);
    return crofton_world_overlap(world, &probe, filter, found);
}
inline crofton_status world_overlap_capsule(const crofton_world* world, const double begin[3], const double end[3],
                                            double radius, const crofton_query_filter* filter, crofton_found* found) {
    const crofton_query_shape probe = capsule_shape(begin, end, radius);
    return crofton_world_overlap(world, &probe, filter, found);
}
template <class Given>
crofton_status world_closest(const crofton_world* world, const Given* given, double most,
                             const crofton_query_filter* filter, crofton_closest_object* closest) {
    const crofton_query_shape probe = given ? shape_of(*given) : crofton_query_shape{};
    return crofton_world_closest(world, given ? &probe : nullptr, most, filter, closest);
}
inline crofton_status world_closest_to_sphere(const crofton_world* world, const double center[3], double radius,
                                              double most, const crofton_query_filter* filter,
                                              crofton_closest_object* closest) {
    const crofton_query_shape probe = sphere_shape(center, radius);
    return crofton_world_closest(world, &probe, most, filter, closest);
}
inline crofton_status world_closest_to_capsule(const crofton_world* world, const double begin[3], const double end[3],
                                               double radius, double most, const crofton_query_filter* filter,
                                               crofton_closest_object* closest) {
    const crofton_query_shape probe = capsule_shape(begin, end, radius);
    return crofton_world_closest(world, &probe, most, filter, closest);
}

inline crofton_status tree_within_box(const crofton_tree* tree, const crofton_box* box, std::uint32_t layers,
                                      std::uint32_t* items, std::size_t capacity, std::size_t* found) {
    const crofton_query_shape probe = shape_of(*box);
    return crofton_tree_overlap(tree, &probe, layers, items, capacity, found);
}
inline crofton_status tree_within_sphere(const crofton_tree* tree, const double* center, double radius,
                                         std::uint32_t layers, std::uint32_t* items, std::size_t capacity,
                                         std::size_t* found) {
    const crofton_query_shape probe = center ? sphere_shape(center, radius) : crofton_query_shape{};
    return crofton_tree_overlap(tree, center ? &probe : nullptr, layers, items, capacity, found);
}

// ---- Meshes ----

// One question of crofton_meshes_relate.
inline crofton_status relate(const crofton_shape* a, const crofton_shape* b, const crofton_transform* pose,
                             std::uint32_t which, crofton_mesh_relation* relation) {
    relation->size = sizeof *relation;
    return crofton_meshes_relate(a, b, pose, which, relation);
}

// ---- Objects of a World ----

template <class Fill>
crofton_status world_set(crofton_world* world, crofton_object object, std::uint32_t member, Fill fill) {
    crofton_object_description description = crofton_default_object_description();
    fill(description);
    return crofton_world_set(world, object, member, &description);
}
inline crofton_status world_set_hidden(crofton_world* world, crofton_object object, int hidden) {
    return world_set(world, object, CROFTON_SET_HIDDEN, [&](auto& d) { d.hidden = hidden != 0; });
}
inline crofton_status world_set_layers(crofton_world* world, crofton_object object, std::uint32_t layers) {
    return world_set(world, object, CROFTON_SET_LAYERS, [&](auto& d) { d.layers = layers; });
}
inline crofton_status world_set_collides_with(crofton_world* world, crofton_object object, std::uint32_t layers) {
    return world_set(world, object, CROFTON_SET_COLLIDES_WITH, [&](auto& d) { d.collides_with = layers; });
}
inline crofton_status world_set_user(crofton_world* world, crofton_object object, std::uint64_t user) {
    return world_set(world, object, CROFTON_SET_USER, [&](auto& d) { d.user = user; });
}
inline crofton_status world_set_occludes(crofton_world* world, crofton_object object, int occludes) {
    return world_set(world, object, CROFTON_SET_OCCLUDES, [&](auto& d) { d.occludes = occludes != 0; });
}
inline crofton_status world_set_mesh(crofton_world* world, crofton_object object, crofton_world_mesh mesh) {
    return world_set(world, object, CROFTON_SET_MESH, [&](auto& d) {
        d.has_mesh = 1;
        d.mesh = mesh;
    });
}
inline crofton_status world_set_bound(crofton_world* world, crofton_object object, const crofton_bound* bound) {
    return world_set(world, object, CROFTON_SET_BOUND, [&](auto& d) { d.bound = bound; });
}
inline crofton_status world_set_shape(crofton_world* world, crofton_object object, const crofton_shape* shape) {
    return world_set(world, object, CROFTON_SET_SHAPE, [&](auto& d) { d.shape = shape; });
}

template <class Info>
Info sized_info() {
    Info info{};
    info.size = sizeof info;
    return info;
}
// Stale handles are answered with no; all else is the call's status.
inline crofton_status yes_or_no(crofton_status status, int* contains) {
    if (status != CROFTON_OK && status != CROFTON_STALE_HANDLE) return status;
    *contains = status == CROFTON_OK ? 1 : 0;
    return CROFTON_OK;
}
inline crofton_status world_contains(const crofton_world* world, crofton_object object, int* contains) {
    auto info = sized_info<crofton_object_info>();
    return yes_or_no(crofton_world_get_object(world, object, &info), contains);
}
inline crofton_status world_contains_mesh(const crofton_world* world, crofton_world_mesh mesh, int* contains) {
    auto info = sized_info<crofton_mesh_info>();
    return yes_or_no(crofton_world_get_mesh(world, mesh, &info), contains);
}
inline crofton_status world_object_count(const crofton_world* world, std::size_t* count) {
    auto statistics = sized_info<crofton_world_statistics>();
    const crofton_status status = crofton_world_get_statistics(world, &statistics);
    if (status == CROFTON_OK) *count = static_cast<std::size_t>(statistics.object_count);
    return status;
}
inline crofton_status world_get_user(const crofton_world* world, crofton_object object, std::uint64_t* user) {
    auto info = sized_info<crofton_object_info>();
    const crofton_status status = crofton_world_get_object(world, object, &info);
    if (status == CROFTON_OK) *user = info.user;
    return status;
}
inline crofton_status world_get_box(const crofton_world* world, crofton_object object, crofton_box* box) {
    auto info = sized_info<crofton_object_info>();
    const crofton_status status = crofton_world_get_object(world, object, &info);
    if (status != CROFTON_OK) return status;
    if (!info.has_box) return CROFTON_EMPTY;
    *box = info.box;
    return CROFTON_OK;
}
inline crofton_status world_get_transform(const crofton_world* world, crofton_object object,
                                          crofton_transform* transform) {
    auto info = sized_info<crofton_object_info>();
    const crofton_status status = crofton_world_get_object(world, object, &info);
    if (status != CROFTON_OK) return status;
    if (!info.has_transform) return CROFTON_EMPTY;
    *transform = info.transform;
    return CROFTON_OK;
}
inline crofton_status world_contact_count(const crofton_world* world, std::size_t* count) {
    const crofton_object_contact* contacts = nullptr;
    return crofton_world_contacts(world, &contacts, count);
}
inline crofton_status world_contact(const crofton_world* world, std::size_t place, crofton_object_contact* contact) {
    const crofton_object_contact* contacts = nullptr;
    std::size_t count = 0;
    const crofton_status status = crofton_world_contacts(world, &contacts, &count);
    if (status != CROFTON_OK) return status;
    if (place >= count) return CROFTON_OUT_OF_RANGE;
    *contact = contacts[place];
    return CROFTON_OK;
}
inline crofton_status world_occluder_count(const crofton_world* world, crofton_world_mesh mesh, std::size_t* count) {
    auto info = sized_info<crofton_mesh_info>();
    const crofton_status status = crofton_world_get_mesh(world, mesh, &info);
    if (status == CROFTON_OK) *count = info.occluder_count;
    return status;
}
inline crofton_status world_hidden_by(const crofton_world* world, crofton_object object,
                                      const crofton_view_result* result, crofton_occluder_ref* occluders,
                                      std::size_t capacity, std::size_t* count) {
    return crofton_view_result_occluders(result, world, &object, occluders, capacity, count);
}
inline crofton_status world_drawn_occluders(const crofton_world* world, const crofton_view_result* result,
                                            crofton_occluder_ref* occluders, std::size_t capacity, std::size_t* count) {
    return crofton_view_result_occluders(result, world, nullptr, occluders, capacity, count);
}

// ---- Views ----

// A view by a frustum.
struct View {
    std::uint32_t layer_mask = ~0u;
    crofton_frustum frustum{};
};
// What it asks; the view must outlive the request. `options` or null: what else is asked.
inline crofton_view_request request_of(const View& view, const crofton_view_request* options = nullptr) {
    crofton_view_request request = options ? *options : crofton_default_view_request();
    request.volume = &view.frustum;
    request.layers = view.layer_mask;
    return request;
}
inline crofton_view_request request_of(const crofton_camera& camera) {
    crofton_view_request request = crofton_default_view_request();
    request.camera = &camera;
    return request;
}
inline crofton_status cull_tree(const crofton_tree* tree, const View* view, const crofton_view_request* options,
                                const crofton_jobs* jobs, crofton_view_result* result) {
    const crofton_view_request request = request_of(*view, options);
    return crofton_tree_view(tree, &request, jobs, result);
}
inline crofton_status cull_boxes(const crofton_box* boxes, const std::uint32_t* layers, std::size_t count,
                                 const View* view, const crofton_view_request* options, const crofton_jobs* jobs,
                                 crofton_view_result* result) {
    const crofton_view_request request = request_of(*view, options);
    return crofton_view_boxes(boxes, layers, count, &request, jobs, result);
}
inline crofton_status visible_set_items(const crofton_view_result* result, const std::uint32_t** ids,
                                        const std::uint8_t** verdicts, std::size_t* count) {
    return crofton_view_result_ids(result, ids, count, verdicts, nullptr);
}
inline crofton_status view_result_occluded_ids(const crofton_view_result* result, const std::uint32_t** ids,
                                               std::size_t* count) {
    auto info = sized_info<crofton_view_info>();
    const crofton_status status = crofton_view_result_get_view(result, 0, &info);
    *ids = info.occluded_ids;
    *count = info.occluded_count;
    return status;
}

}  // namespace crofton::capi_test
