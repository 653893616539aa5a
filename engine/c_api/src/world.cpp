// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include <crofton/capi/clustered_mesh.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/numbers.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_NONE == kNoIndex);
static_assert(CROFTON_AUTOMATIC >= kAutomatic);

namespace {

std::size_t clamp_to_size(std::uint64_t value) {
    return static_cast<std::size_t>(std::min<std::uint64_t>(value, SIZE_MAX));
}

WorldOptions to_world_options(const crofton_world_options& given) {
    WorldOptions options;
    options.pairs = given.pairs != 0;
    options.contacts = given.contacts != 0;
    options.containment = given.containment != 0;
    options.mesh_depth = given.mesh_depth != 0;
    options.max_pairs = clamp_to_size(given.max_pairs);
    options.rebuild_budget = clamp_to_size(given.rebuild_budget);
    options.updates_to_rest = given.updates_to_rest;
    options.contact_margin = given.contact_margin;
    return options;
}

// `count` values of `bytes` bytes each, `stride` bytes apart.
crofton_status check_stride(const void* first, std::size_t count, std::size_t bytes, std::size_t stride,
                            const char* function) {
    if (!first && count > 0) return report(CROFTON_INVALID_ARGUMENT, function, "an array is NULL");
    if (stride < bytes) return report(CROFTON_INVALID_ARGUMENT, function, "a stride is smaller than its element");
    if (count > PTRDIFF_MAX / stride) return report(CROFTON_OUT_OF_RANGE, function, "a count is larger than any array");
    return CROFTON_OK;
}

bool is_aligned(const void* first, std::size_t alignment) {
    return reinterpret_cast<std::uintptr_t>(first) % alignment == 0;
}

// Reads the caller's array of C structs as their C++ twins.
template <class Twin, class Struct>
crofton_status to_strided(const Struct* first, std::size_t count, std::size_t stride, const char* function,
                          Strided<Twin>& result) {
    static_assert(sizeof(Twin) == sizeof(Struct) && alignof(Twin) == alignof(Struct));
    if (stride == 0) stride = sizeof(Struct);
    CROFTON_CHECK(check_stride(first, count, sizeof(Struct), stride, function));
    if (stride % alignof(Struct) != 0 || !is_aligned(first, alignof(Struct)))
        return report(CROFTON_INVALID_ARGUMENT, function, "an array or its stride is not aligned to its type");
    result = {reinterpret_cast<const Twin*>(first), count, stride};
    return CROFTON_OK;
}

// Many items of two arrays: what the calls with strides have in common.
template <class First, class Second, class A, class B, class Change>
crofton_status change_many(crofton_world* world, const A* a, std::size_t a_stride, const B* b, std::size_t b_stride,
                           std::size_t count, const char* function, Change apply) {
    const ExclusiveUse use(world, function);
    if (use.failed()) return use.status();
    Strided<First> first;
    Strided<Second> second;
    CROFTON_CHECK(to_strided(a, count, a_stride, function, first));
    CROFTON_CHECK(to_strided(b, count, b_stride, function, second));
    return status_of(apply(world->world, first, second), function);
}

template <class Change>
crofton_status change(crofton_world* world, const char* function, Change apply) {
    const ExclusiveUse use(world, function);
    if (use.failed()) return use.status();
    return status_of(apply(world->world), function);
}

// Writes a handle where the call succeeded.
template <class Handle, class Given>
crofton_status hand_out(const Result<Handle>& result, Given* given, const char* function) {
    if (!result) return report(result.error(), function);
    *given = {result->index, result->generation};
    return CROFTON_OK;
}

crofton_status to_points(const crofton_mesh_data& data, const char* function, PointsView& points) {
    const std::size_t packed = 3 * (data.is_double ? sizeof(double) : sizeof(float));
    const std::size_t stride = data.position_stride ? data.position_stride : packed;
    CROFTON_CHECK(check_stride(data.positions, data.position_count, packed, stride, function));
    if (data.is_double)
        points = {static_cast<const double*>(data.positions), data.position_count, stride};
    else
        points = {static_cast<const float*>(data.positions), data.position_count, stride};
    return CROFTON_OK;
}

crofton_status to_indices(const crofton_mesh_data& data, const char* function, IndicesView& indices) {
    const std::size_t bytes = data.is_short ? sizeof(std::uint16_t) : sizeof(std::uint32_t);
    CROFTON_CHECK(check_stride(data.indices, data.index_count, bytes, bytes, function));
    if (!is_aligned(data.indices, bytes))
        return report(CROFTON_INVALID_ARGUMENT, function, "the indices are not aligned to their type");
    if (data.is_short)
        indices = {static_cast<const std::uint16_t*>(data.indices), data.index_count};
    else
        indices = {static_cast<const std::uint32_t*>(data.indices), data.index_count};
    return CROFTON_OK;
}

crofton_status read_mesh_description(const crofton_mesh_data* given, const char* function,
                                     MeshDescription& description) {
    crofton_mesh_data data;
    CROFTON_CHECK(read_growing(given, function, data));
    return to_mesh_description(data, function, description);
}

}  // namespace

crofton_status capi::to_mesh_description(const crofton_mesh_data& data, const char* function,
                                         MeshDescription& description) {
    CROFTON_CHECK(to_points(data, function, description.positions));
    CROFTON_CHECK(to_indices(data, function, description.indices));
    description.triangles = data.triangles != 0;
    description.clusters = data.clusters != 0;
    description.one_sided = data.one_sided != 0;
    if (data.clusters != 0 && data.precut != nullptr) {
        const SharedUse use(data.precut, function);
        if (use.failed()) return use.status();
        description.precut = &data.precut->mesh;
    }
    return CROFTON_OK;
}

crofton_status capi::to_bound(const crofton_bound& given, const char* function, Bound& bound) {
    switch (given.kind) {
        case CROFTON_BOUND_NONE:
            bound = Bound();
            return CROFTON_OK;
        case CROFTON_BOUND_BOX:
            bound = Bound(to_box(&given.box));
            return CROFTON_OK;
        case CROFTON_BOUND_ALIGNED_BOX:
            bound = Bound(Aabb{to_vector(given.min), to_vector(given.max)});
            return CROFTON_OK;
        case CROFTON_BOUND_SPHERE:
            bound = Bound(Sphere{to_vector(given.center), given.radius});
            return CROFTON_OK;
        default:
            return report(CROFTON_INVALID_ARGUMENT, function, "unknown kind of bound");
    }
}

namespace {

crofton_status to_object_description(const crofton_object_description* first, std::size_t i, const char* function,
                                     crofton_object_description& given, ObjectDescription& description) {
    CROFTON_CHECK(read_growing_at(first, i, function, given));
    if (given.has_mesh) description.mesh = to_handle(given.mesh);
    if (given.has_node) description.node = to_handle(given.node);
    if (given.transform) description.transform = to_transform(*given.transform);
    if (given.bound) CROFTON_CHECK(to_bound(*given.bound, function, description.bound));
    description.user = given.user;
    description.layers = given.layers;
    description.collides_with = given.collides_with;
    description.occludes = given.occludes != 0;
    description.only_occludes = given.only_occludes != 0;
    description.hidden = given.hidden != 0;
    return CROFTON_OK;
}

constexpr std::uint32_t kShapeMembers = CROFTON_SET_OCCLUDES | CROFTON_SET_MESH | CROFTON_SET_BOUND | CROFTON_SET_SHAPE;
constexpr std::uint32_t kAllMembers = 2 * CROFTON_SET_SHAPE - 1;

crofton_status check_members(std::uint32_t members, const char* function) {
    if (members > kAllMembers) return report(CROFTON_INVALID_ARGUMENT, function, "unknown members of an object");
    if (std::popcount(members & kShapeMembers) > 1)
        return report(CROFTON_INVALID_ARGUMENT, function, "set mesh, bound, shape and occludes one at a time");
    return CROFTON_OK;
}

crofton_status set_shape(crofton_world& world, crofton_object object, const crofton_shape* shape,
                         const char* function) {
    if (!shape) return status_of(world.world.set_shape(to_handle(object), nullptr), function);
    const SharedUse use(shape, function);
    if (use.failed()) return use.status();
    CROFTON_CHECK(status_of(world.world.set_shape(to_handle(object), &*shape->data->shape), function));
    world.keep(object.index, shape->data);
    return CROFTON_OK;
}

// Adds the object of the i-th description of an array.
crofton_status add_one(crofton_world& world, const crofton_object_description* first, std::size_t i,
                       crofton_object& object, const char* function) {
    crofton_object_description given;
    ObjectDescription made;
    CROFTON_CHECK(to_object_description(first, i, function, given, made));
    if (!given.shape) return hand_out(world.world.add(made), &object, function);
    const SharedUse use_shape(given.shape, function);
    if (use_shape.failed()) return use_shape.status();
    made.shape = &*given.shape->data->shape;
    CROFTON_CHECK(hand_out(world.world.add(made), &object, function));
    world.keep(object.index, given.shape->data);
    return CROFTON_OK;
}

// At most one of the members that may be refused.
crofton_status set_shape(crofton_world& world, crofton_object object, std::uint32_t members,
                         const crofton_object_description& given, const char* function) {
    World& w = world.world;
    if (members & CROFTON_SET_OCCLUDES)
        return status_of(w.set_occludes(to_handle(object), given.occludes != 0), function);
    if (members & CROFTON_SET_MESH) {
        if (!given.has_mesh) return report(CROFTON_INVALID_ARGUMENT, function, "the description has no mesh");
        return status_of(w.set_mesh(to_handle(object), to_handle(given.mesh)), function);
    }
    if (members & CROFTON_SET_BOUND) {
        CROFTON_CHECK(check_pointer(given.bound, function));
        Bound bound;
        CROFTON_CHECK(to_bound(*given.bound, function, bound));
        return status_of(w.set_bound(to_handle(object), bound), function);
    }
    if (members & CROFTON_SET_SHAPE) return set_shape(world, object, given.shape, function);
    return CROFTON_OK;
}

std::uint64_t next_serial() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace

crofton_status crofton_world_create(const crofton_world_options* options, crofton_world** world) {
    CROFTON_CHECK(check_pointer(world, __func__));
    crofton_world_options given = crofton_default_world_options();
    if (options) CROFTON_CHECK(read_growing(options, __func__, given));
    CROFTON_CHECK(check_length(given.contact_margin, "contact_margin", __func__));
    const char* const function = __func__;
    return recover(function, [&] { return create(world, function, World(to_world_options(given)), next_serial()); });
}

crofton_status crofton_world_destroy(crofton_world* world) {
    return destroy(world, __func__);
}

crofton_status crofton_world_add_mesh(crofton_world* world, const crofton_mesh_data* data, crofton_world_mesh* mesh) {
    CROFTON_CHANGE(world);
    CROFTON_CHECK(check_pointer(mesh, __func__));
    MeshDescription description;
    CROFTON_CHECK(read_mesh_description(data, __func__, description));
    return hand_out(world->world.add_mesh(description), mesh, __func__);
}

crofton_status crofton_world_replace_mesh(crofton_world* world, crofton_world_mesh mesh,
                                          const crofton_mesh_data* data) {
    CROFTON_CHANGE(world);
    MeshDescription description;
    CROFTON_CHECK(read_mesh_description(data, __func__, description));
    return status_of(world->world.replace_mesh(to_handle(mesh), description), __func__);
}

crofton_status crofton_world_set_vertices(crofton_world* world, crofton_world_mesh mesh,
                                          const crofton_mesh_data* data) {
    CROFTON_CHANGE(world);
    crofton_mesh_data given;
    PointsView positions;
    CROFTON_CHECK(read_growing(data, __func__, given));
    CROFTON_CHECK(to_points(given, __func__, positions));
    return status_of(world->world.set_vertices(to_handle(mesh), positions), __func__);
}

crofton_status crofton_world_remove_mesh(crofton_world* world, crofton_world_mesh mesh) {
    return change(world, __func__, [&](World& w) { return w.remove(to_handle(mesh)); });
}

crofton_status crofton_world_add_node(crofton_world* world, const crofton_node* parent,
                                      const crofton_transform* transform, uint32_t layers, crofton_node* node) {
    CROFTON_CHANGE(world);
    CROFTON_CHECK(check_pointer(node, __func__));
    NodeDescription description;
    if (parent) description.parent = to_handle(*parent);
    if (transform) description.transform = to_transform(*transform);
    description.layers = layers;
    return hand_out(world->world.add_node(description), node, __func__);
}

crofton_status crofton_world_remove_node(crofton_world* world, crofton_node node) {
    return change(world, __func__, [&](World& w) { return w.remove(to_handle(node)); });
}

crofton_status crofton_world_set_parent(crofton_world* world, crofton_node node, const crofton_node* parent) {
    return change(world, __func__,
                  [&](World& w) { return w.set_parent(to_handle(node), parent ? to_handle(*parent) : NodeHandle()); });
}

crofton_status crofton_world_set_node_layers(crofton_world* world, crofton_node node, uint32_t layers) {
    return change(world, __func__, [&](World& w) { return w.set_layers(to_handle(node), layers); });
}

crofton_status crofton_world_set_node_transforms(crofton_world* world, const crofton_node* nodes, size_t node_stride,
                                                 const crofton_transform* transforms, size_t transform_stride,
                                                 size_t count) {
    return change_many<NodeHandle, Transform>(
        world, nodes, node_stride, transforms, transform_stride, count, __func__,
        [](World& w, Strided<NodeHandle> n, Strided<Transform> t) { return w.set_transforms(n, t); });
}

crofton_status crofton_world_add(crofton_world* world, const crofton_object_description* description,
                                 crofton_object* object) {
    CROFTON_CHANGE(world);
    CROFTON_CHECK(check_pointer(object, __func__));
    return add_one(*world, description, 0, *object, __func__);
}

crofton_status crofton_world_add_many(crofton_world* world, const crofton_object_description* descriptions,
                                      size_t count, crofton_object* objects) {
    CROFTON_CHANGE(world);
    if (count == 0) return CROFTON_OK;
    CROFTON_CHECK(check_pointer(objects, __func__));
    CROFTON_CHECK(check_growing(descriptions, __func__));
    std::size_t failed = count;  // the first
    for (std::size_t i = 0; i < count; ++i) {
        objects[i] = {};
        if (add_one(*world, descriptions, i, objects[i], __func__) != CROFTON_OK) failed = std::min(failed, i);
    }
    // Fails again, so that its error is the last.
    return failed == count ? CROFTON_OK
                           : of_item(add_one(*world, descriptions, failed, objects[failed], __func__), failed);
}

crofton_status crofton_world_reserve(crofton_world* world, size_t objects) {
    return change(world, __func__, [&](World& w) { return w.reserve(objects); });
}

crofton_status crofton_world_remove(crofton_world* world, crofton_object object) {
    return change(world, __func__, [&](World& w) { return w.remove(to_handle(object)); });
}

crofton_status crofton_world_set_transforms(crofton_world* world, const crofton_object* objects, size_t object_stride,
                                            const crofton_transform* transforms, size_t transform_stride,
                                            size_t count) {
    return change_many<ObjectHandle, Transform>(
        world, objects, object_stride, transforms, transform_stride, count, __func__,
        [](World& w, Strided<ObjectHandle> o, Strided<Transform> t) { return w.set_transforms(o, t); });
}

crofton_status crofton_world_set_boxes(crofton_world* world, const crofton_object* objects, size_t object_stride,
                                       const crofton_box* boxes, size_t box_stride, size_t count) {
    return change_many<ObjectHandle, Obb>(
        world, objects, object_stride, boxes, box_stride, count, __func__,
        [](World& w, Strided<ObjectHandle> o, Strided<Obb> b) { return w.set_bounds(o, b); });
}

crofton_status crofton_world_set(crofton_world* world, crofton_object object, uint32_t members,
                                 const crofton_object_description* description) {
    CROFTON_CHANGE(world);
    crofton_object_description given;
    CROFTON_CHECK(read_growing(description, __func__, given));
    CROFTON_CHECK(check_members(members, __func__));
    // What may be refused comes first; what is left then only needs the object.
    CROFTON_CHECK(set_shape(*world, object, members, given, __func__));
    World& w = world->world;
    const ObjectHandle handle = to_handle(object);
    if (!w.contains(handle)) return status_of(w.set_user(handle, given.user), __func__);
    if (members & CROFTON_SET_USER) CROFTON_CHECK(status_of(w.set_user(handle, given.user), __func__));
    if (members & CROFTON_SET_LAYERS) CROFTON_CHECK(status_of(w.set_layers(handle, given.layers), __func__));
    if (members & CROFTON_SET_COLLIDES_WITH)
        CROFTON_CHECK(status_of(w.set_collides_with(handle, given.collides_with), __func__));
    if (members & CROFTON_SET_HIDDEN) CROFTON_CHECK(status_of(w.set_hidden(handle, given.hidden != 0), __func__));
    return CROFTON_OK;
}

crofton_status crofton_world_update(crofton_world* world, const crofton_jobs* jobs) {
    CROFTON_CHANGE(world);
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    world->serial = next_serial();  // indices may be other objects' now
    return status_of(world->world.update(executor), __func__);
}

crofton_status crofton_world_get_statistics(const crofton_world* world, crofton_world_statistics* statistics) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_growing(statistics, __func__));
    const WorldStatistics& s = world->world.statistics();
    write_growing({sizeof *statistics, s.objects, s.resting, s.moving, s.box_pairs_tested, s.contact_pairs_tested,
                   s.boxes_changed, s.nodes_updated, s.out_of_range, s.tree_built ? 1u : 0u,
                   world->world.object_count(), s.occluders_waiting},
                  statistics);
    return CROFTON_OK;
}
