// SPDX-License-Identifier: MIT
// Views of a World.
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <array>
#include <span>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/requests.hpp>
#include <crofton/capi/view_result.hpp>
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;
using Of = crofton_view_result::Of;

namespace {

// The result's objects are looked up in the World that was viewed, as it was then.
crofton_status check_viewed(const crofton_view_result& result, const crofton_world& world, const char* function) {
    if (result.serial == world.serial) return CROFTON_OK;
    return report(CROFTON_INVALID_ARGUMENT, function,
                  "the result is not of a view of this world, or the world has been updated since");
}

crofton_status view_one(const crofton_world& world, const crofton_view_request* request, Executor& executor,
                        const char* function, crofton_view_result& result) {
    crofton_view_request given;
    ViewRequest asked;
    cull::DrawLimits limits;
    CROFTON_CHECK(read_growing(request, function, given));
    CROFTON_CHECK(read_request(given, result, function, asked, limits));
    CROFTON_CHECK(status_of(world.world.view(asked, result.one, executor), function));
    result.of = Of::world;
    result.is_counted = !asked.occlusion || asked.occlusion->list_occluded || asked.order == cull::ResultOrder::tree;
    return CROFTON_OK;
}

crofton_status view_many(const crofton_world& world, const crofton_view_request* requests, std::size_t count,
                         Executor& executor, const char* function, crofton_view_result& result) {
    if (count > cull::kMaxViews) return report(CROFTON_OUT_OF_RANGE, function, "more than 32 views", cull::kMaxViews);
    std::array<ViewRequest, cull::kMaxViews> asked;
    std::array<cull::DrawLimits, cull::kMaxViews> limits;
    for (std::size_t v = 0; v < count; ++v) {
        crofton_view_request given;
        CROFTON_CHECK(read_growing_at(requests, v, function, given));
        CROFTON_CHECK(of_item(read_request(given, result, function, asked[v], limits[v]), v));
        // Views with the same limits are answered in one walk.
        for (std::size_t w = 0; w < v && asked[v].limits == &limits[v]; ++w) {
            crofton_view_request earlier;
            CROFTON_CHECK(read_growing_at(requests, w, function, earlier));
            if (earlier.limits == given.limits) asked[v].limits = asked[w].limits;
        }
    }
    CROFTON_CHECK(
        status_of(world.world.view(std::span<const ViewRequest>(asked).first(count), result.many, executor), function));
    result.of = Of::many_of_world;
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_world_view(const crofton_world* world, const crofton_view_request* requests, size_t count,
                                  const crofton_jobs* jobs, crofton_view_result* result) {
    CROFTON_READ(world);
    CROFTON_CHANGE(result);
    CROFTON_CHECK(check_array(requests, count, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    if (count == 1)
        CROFTON_CHECK(view_one(*world, requests, executor, __func__, *result));
    else
        CROFTON_CHECK(view_many(*world, requests, count, executor, __func__, *result));
    result->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_view_result_list(const crofton_view_result* result, const crofton_world* world, size_t first,
                                        crofton_object_ref* objects, uint32_t* view_masks, size_t capacity) {
    CROFTON_READ(result);
    CROFTON_READ(world);
    CROFTON_CHECK(check_room(objects, capacity, __func__));
    CROFTON_CHECK(check_viewed(*result, *world, __func__));
    const bool is_many = result->of == Of::many_of_world;
    const std::size_t size = is_many ? result->many.size() : result->one.size();
    if (first > size)
        return report(CROFTON_OUT_OF_RANGE, __func__, "`first` is beyond the number of visible objects", first);
    for (std::size_t i = 0; i < std::min(capacity, size - first); ++i) {
        objects[i] = to_c_ref(is_many ? result->many[first + i] : result->one[first + i]);
        if (view_masks) view_masks[i] = is_many ? result->many.view_mask(first + i) : 1u;
    }
    return CROFTON_OK;
}

crofton_status crofton_view_result_occluders(const crofton_view_result* result, const crofton_world* world,
                                             const crofton_object* hidden, crofton_occluder_ref* occluders,
                                             size_t capacity, size_t* count) {
    CROFTON_READ(world);
    CROFTON_READ(result);
    CROFTON_CHECK(check_pointer(count, __func__));
    CROFTON_CHECK(check_room(occluders, capacity, __func__));
    CROFTON_CHECK(check_viewed(*result, *world, __func__));
    if (result->of == Of::many_of_world)
        return report(CROFTON_UNSUPPORTED, __func__, "the result is of several views; ask with the result of one");
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(hidden ? world->world.hidden_by(to_handle(*hidden), result->one, found)
                                   : world->world.drawn_occluders(result->one, found),
                            __func__));
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i)
        occluders[i] = {{found[i].object.index, found[i].object.generation}, found[i].user, found[i].place, 0};
    *count = found.size();
    return CROFTON_OK;
}
