// SPDX-License-Identifier: MIT
// Regions: prepared on any thread, attached to a World.
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <crofton/world/region.hpp>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_FIRST_REGION_INDEX == kFirstRegionIndex);

struct crofton_region {
    static constexpr std::uint32_t kKind = 0x43724f12;
    Header header;
    Region region;
};

namespace {

struct AskedToStop {
    int (*should_stop)(void* user, double share_done);
    void* user;
};

Result<Region> prepare(std::span<const RegionObject> objects, const crofton_region_options& given,
                       const crofton_jobs* jobs) {
    AskedToStop asked{given.should_stop, given.stop_user};
    RegionOptions options;
    options.max_objects = static_cast<std::size_t>(std::min<std::uint64_t>(given.max_objects, SIZE_MAX));
    options.stop_user = &asked;
    if (given.should_stop)
        options.should_stop = [](void* user, double share_done) {
            const AskedToStop& of_caller = *static_cast<AskedToStop*>(user);
            return of_caller.should_stop(of_caller.user, share_done) != 0;
        };
    HostJobs executor(jobs);
    return Region::prepare(objects, options, executor);
}

}  // namespace

crofton_status crofton_region_prepare(const crofton_region_object* objects, size_t count,
                                      const crofton_region_options* options, const crofton_jobs* jobs,
                                      crofton_region** region) {
    CROFTON_CHECK(check_pointer(region, __func__));
    if (count > 0) CROFTON_CHECK(check_pointer(objects, __func__));
    crofton_region_options given = crofton_default_region_options();
    if (options) CROFTON_CHECK(read_growing(options, __func__, given));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    if (count > given.max_objects)
        return report(CROFTON_OUT_OF_RANGE, __func__, "more objects than `max_objects`: prepare several regions");
    const char* const function = __func__;
    return recover(function, [&] {
        Vector<RegionObject> read(count);
        for (std::size_t i = 0; i < count; ++i) {
            CROFTON_CHECK(of_item(to_bound(objects[i].bound, function, read[i].bound), i));
            read[i].user = objects[i].user;
            read[i].layers = objects[i].layers;
            read[i].collides_with = objects[i].collides_with;
        }
        auto prepared = prepare(read, given, jobs);
        if (!prepared) return report(prepared.error(), function);
        return create(region, function, std::move(*prepared));
    });
}

crofton_status crofton_region_destroy(crofton_region* region) {
    return destroy(region, __func__);
}

crofton_status crofton_world_attach(crofton_world* world, const crofton_region* region, const double origin[3],
                                    crofton_attached_region* attached) {
    const ExclusiveUse use(world, __func__);
    if (use.failed()) return use.status();
    const SharedUse use_of_region(region, __func__);
    if (use_of_region.failed()) return use_of_region.status();
    CROFTON_CHECK(check_pointer(origin, __func__));
    CROFTON_CHECK(check_pointer(attached, __func__));
    const auto handle = world->world.attach(region->region, {origin[0], origin[1], origin[2]});
    if (!handle) return report(handle.error(), __func__);
    *attached = {handle->index, handle->generation};
    return CROFTON_OK;
}

crofton_status crofton_world_detach(crofton_world* world, crofton_attached_region region) {
    const ExclusiveUse use(world, __func__);
    if (use.failed()) return use.status();
    return status_of(world->world.detach({region.index, region.generation}), __func__);
}

crofton_status crofton_world_object_in(const crofton_world* world, crofton_attached_region region, uint32_t place,
                                       crofton_object* object) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(object, __func__));
    const auto handle = world->world.object_in({region.index, region.generation}, place);
    if (!handle) return report(handle.error(), __func__);
    *object = {handle->index, handle->generation};
    return CROFTON_OK;
}

crofton_status crofton_world_place_of(const crofton_world* world, crofton_object object,
                                      crofton_attached_region* region, uint32_t* place) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(region, __func__));
    CROFTON_CHECK(check_pointer(place, __func__));
    const auto found = world->world.place_of(to_handle(object));
    if (!found) return report(found.error(), __func__);
    *region = {found->region.index, found->region.generation};
    *place = found->index;
    return CROFTON_OK;
}
