// SPDX-License-Identifier: MIT
// A World, as the functions of several headers see it.
#pragma once
#include <crofton/capi/crofton.h>

#include <crofton/core/memory.hpp>
#include <crofton/world/world.hpp>
#include <mutex>

#include <crofton/capi/call.hpp>
#include <crofton/capi/clustered_mesh.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/shapes.hpp>

struct crofton_world {
    static constexpr std::uint32_t kKind = 0x43724f08;
    crofton::capi::Header header;
    crofton::World world;
    std::uint64_t serial;  // of its state after an update: unlike any other of the process, and not 0
    crofton::Vector<crofton::capi::SharedShape> shapes{};  // by object, so that they live as long as they are used

    mutable std::mutex mutex{};
    mutable crofton::Vector<crofton::capi::ClusterRanges> cluster_ranges{};  // by mesh; guarded

    // Until the object's index has another shape.
    void keep(std::uint32_t object, const crofton::capi::SharedShape& shape) {
        if (shapes.size() <= object) shapes.resize(object + std::size_t{1});
        shapes[object] = shape;
    }
};

namespace crofton::capi {

static_assert(sizeof(crofton_object) == sizeof(ObjectHandle) && alignof(crofton_object) == alignof(ObjectHandle));
static_assert(offsetof(crofton_object, generation) == offsetof(ObjectHandle, generation));

[[nodiscard]] inline ObjectHandle to_handle(crofton_object object) {
    return {object.index, object.generation};
}
[[nodiscard]] inline NodeHandle to_handle(crofton_node node) {
    return {node.index, node.generation};
}
[[nodiscard]] inline MeshHandle to_handle(crofton_world_mesh mesh) {
    return {mesh.index, mesh.generation};
}
[[nodiscard]] crofton_status to_mesh_description(const crofton_mesh_data& data, const char* function,
                                                 MeshDescription& description);
[[nodiscard]] crofton_status to_bound(const crofton_bound& given, const char* function, Bound& bound);

// NULL stands for a filter of all objects.
[[nodiscard]] inline crofton_status to_filter(const crofton_query_filter* filter, const char* function,
                                              QueryFilter& result) {
    if (!filter) return CROFTON_OK;
    crofton_query_filter given{};
    CROFTON_CHECK(read_growing(filter, function, given));
    CROFTON_CHECK(check_array(given.ignored, given.ignored_count, function));
    result = {given.layers, {reinterpret_cast<const ObjectHandle*>(given.ignored), given.ignored_count}};
    return CROFTON_OK;
}

[[nodiscard]] inline crofton_object_ref to_c_ref(const ObjectRef& ref) {
    return {{ref.object.index, ref.object.generation}, ref.user};
}

[[nodiscard]] inline crofton_status check_mesh(const crofton_world& world, crofton_world_mesh mesh,
                                               const char* function) {
    if (world.world.contains(to_handle(mesh))) return CROFTON_OK;
    return report(CROFTON_STALE_HANDLE, function, "the mesh has been removed, or never was in this world", mesh.index);
}

}  // namespace crofton::capi
