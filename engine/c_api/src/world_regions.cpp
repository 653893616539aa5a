// SPDX-License-Identifier: MIT
// Regions: prepared on any thread, attached to a World.
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <crofton/world/region.hpp>
#include <memory>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/region.hpp>
#include "clusters.hpp"
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_FIRST_REGION_INDEX == kFirstRegionIndex);

namespace {

struct AskedToStop {
    int (*should_stop)(void* user, double share_done);
    void* user;
};

// What a region is prepared from.
struct Contents {
    Vector<RegionObject> objects;
    Vector<RegionMesh> meshes;
    // Which the region keeps.
    std::shared_ptr<Vector<SharedShape>> shapes =
        std::allocate_shared<Vector<SharedShape>>(Allocator<Vector<SharedShape>>());
};

crofton_status read_meshes(const crofton_region_options& given, const char* function, Contents& contents) {
    for (std::size_t i = 0; i < given.mesh_count; ++i) {
        crofton_mesh_data data;
        CROFTON_CHECK(of_item(read_growing_at(given.meshes, i, function, data), i));
        RegionMesh& mesh = contents.meshes.emplace_back();
        CROFTON_CHECK(of_item(to_mesh_description(data, function, mesh.mesh), i));
        mesh.mesh.occluders = given.find_occluders != 0;
    }
    return CROFTON_OK;
}

crofton_status read_shape(const crofton_shape* given, const char* function, Contents& contents, RegionObject& object) {
    const SharedUse use(given, function);
    if (use.failed()) return use.status();
    object.shape = &*given->data->shape;
    if (contents.shapes->empty() || contents.shapes->back() != given->data) contents.shapes->push_back(given->data);
    return CROFTON_OK;
}

crofton_status read_object(const crofton_region_object& given, const char* function, Contents& contents) {
    RegionObject& object = contents.objects.emplace_back();
    CROFTON_CHECK(to_bound(given.bound, function, object.bound));
    object.user = given.user;
    object.layers = given.layers;
    object.collides_with = given.collides_with;
    object.mesh = given.mesh;
    object.occludes = given.occludes != 0;
    object.only_occludes = given.only_occludes != 0;
    if (given.transform) object.transform = to_transform(*given.transform);
    return given.shape ? read_shape(given.shape, function, contents, object) : CROFTON_OK;
}

Result<Region> prepare(const Contents& contents, const crofton_region_options& given, const crofton_jobs* jobs) {
    AskedToStop asked{given.should_stop, given.stop_user};
    RegionOptions options;
    options.max_objects = static_cast<std::size_t>(std::min<std::uint64_t>(given.max_objects, SIZE_MAX));
    options.stop_user = &asked;
    options.meshes = contents.meshes;
    options.max_origin = given.max_origin;
    options.keep = contents.shapes;
    if (given.should_stop)
        options.should_stop = [](void* user, double share_done) {
            const AskedToStop& of_caller = *static_cast<AskedToStop*>(user);
            return of_caller.should_stop(of_caller.user, share_done) != 0;
        };
    HostJobs executor(jobs);
    return Region::prepare(contents.objects, options, executor);
}

}  // namespace

crofton_status crofton_region_prepare(const crofton_region_object* objects, size_t count,
                                      const crofton_region_options* options, const crofton_jobs* jobs,
                                      crofton_region** region) {
    CROFTON_CHECK(check_pointer(region, __func__));
    CROFTON_CHECK(check_array(objects, count, __func__));
    crofton_region_options given = crofton_default_region_options();
    if (options) CROFTON_CHECK(read_growing(options, __func__, given));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    CROFTON_CHECK(check_array(given.meshes, given.mesh_count, __func__));
    if (given.mesh_count > CROFTON_NONE)
        return report(CROFTON_OUT_OF_RANGE, __func__, "32 bits number the meshes of a region");
    if (count > std::min<std::uint64_t>(given.max_objects, kFirstRegionIndex))
        return report(CROFTON_OUT_OF_RANGE, __func__, "more objects than `max_objects`: prepare several regions");
    const char* const function = __func__;
    return recover(function, [&] {
        Contents contents;
        CROFTON_CHECK(read_meshes(given, function, contents));
        contents.objects.reserve(count);
        for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(of_item(read_object(objects[i], function, contents), i));
        auto prepared = prepare(contents, given, jobs);
        if (!prepared) return report(prepared.error(), function);
        return create(region, function, std::move(*prepared));
    });
}

crofton_status crofton_region_destroy(crofton_region* region) {
    return destroy(region, __func__);
}

crofton_status crofton_region_get_info(const crofton_region* region, crofton_region_info* info) {
    CROFTON_READ(region);
    CROFTON_CHECK(check_growing(info, __func__));
    crofton_region_info result{};
    result.object_count = region->region.object_count();
    result.bytes = region->region.bytes();
    const Aabb& bounds = region->region.bounds();
    for (int k = 0; k < 3; ++k) result.min[k] = bounds.min[k], result.max[k] = bounds.max[k];
    write_growing(result, info);
    return CROFTON_OK;
}

crofton_status crofton_region_mesh_of(const crofton_region* region, uint32_t place, uint32_t* mesh) {
    CROFTON_READ(region);
    CROFTON_CHECK(check_pointer(mesh, __func__));
    if (place >= region->region.object_count())
        return report(CROFTON_OUT_OF_RANGE, __func__, "the region has no object at that place", place);
    *mesh = region->region.mesh_of(place);
    return CROFTON_OK;
}

crofton_status crofton_region_clusters_of(const crofton_region* region, uint32_t mesh, crofton_clusters* clusters) {
    CROFTON_READ(region);
    CROFTON_CHECK(check_pointer(clusters, __func__));
    const depth::ClusteredMesh* const cut = region->region.clusters_of(mesh);
    if (cut == nullptr)
        return report(CROFTON_EMPTY, __func__, "the region has no such mesh, or it has no clusters", mesh);
    return recover(__func__, [&] {
        const std::lock_guard lock(region->mutex);
        while (region->cluster_ranges.size() <= mesh) region->cluster_ranges.emplace_back();
        *clusters = to_c_clusters(*cut, region->cluster_ranges[mesh]);
        return CROFTON_OK;
    });
}

crofton_status crofton_world_attach(crofton_world* world, const crofton_region* region, const double origin[3],
                                    crofton_attached_region* attached) {
    CROFTON_CHANGE(world);
    CROFTON_READ(region);
    CROFTON_CHECK(check_pointer(origin, __func__));
    CROFTON_CHECK(check_pointer(attached, __func__));
    const auto handle = world->world.attach(region->region, {origin[0], origin[1], origin[2]});
    if (!handle) return report(handle.error(), __func__);
    *attached = {handle->index, handle->generation};
    return CROFTON_OK;
}

crofton_status crofton_world_detach(crofton_world* world, crofton_attached_region region) {
    CROFTON_CHANGE(world);
    return status_of(world->world.detach({region.index, region.generation}), __func__);
}

crofton_status crofton_world_object_in(const crofton_world* world, crofton_attached_region region, uint32_t place,
                                       crofton_object* object) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_pointer(object, __func__));
    const auto handle = world->world.object_in({region.index, region.generation}, place);
    if (!handle) return report(handle.error(), __func__);
    *object = {handle->index, handle->generation};
    return CROFTON_OK;
}

crofton_status crofton_world_place_of(const crofton_world* world, crofton_object object,
                                      crofton_attached_region* region, uint32_t* place) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_pointer(region, __func__));
    CROFTON_CHECK(check_pointer(place, __func__));
    const auto found = world->world.place_of(to_handle(object));
    if (!found) return report(found.error(), __func__);
    *region = {found->region.index, found->region.generation};
    *place = found->index;
    return CROFTON_OK;
}
