// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <array>
#include <span>

#include "queries.hpp"
#include "visible.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

ViewRequest to_request(const CullAsked& asked) {
    return {.limits = asked.options.limits,
            .candidate_mask = asked.options.candidate_mask,
            .order = asked.options.order,
            .mode = asked.options.mode};
}

// How many objects to write: those from place `first` on, of the world that was viewed.
template <class Visible>
crofton_status count_listed(const Visible& visible, const crofton_world& world, std::size_t first,
                            const crofton_object_ref* objects, std::size_t capacity, const char* function,
                            std::size_t& count) {
    CROFTON_CHECK(check_room(objects, capacity, function));
    CROFTON_CHECK(check_viewed(visible, world, function));
    if (first > visible.visible.size())
        return report(CROFTON_OUT_OF_RANGE, function, "fewer objects are seen than `first`", first);
    count = std::min(capacity, visible.visible.size() - first);
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_visible_objects_create(crofton_visible_objects** visible) {
    CROFTON_CHECK(check_pointer(visible, __func__));
    return create(visible, __func__);
}

crofton_status crofton_visible_objects_destroy(crofton_visible_objects* visible) {
    return destroy(visible, __func__);
}

crofton_status crofton_world_view(const crofton_world* world, const crofton_view* view,
                                  const crofton_cull_options* options, const crofton_jobs* jobs,
                                  crofton_visible_objects* visible) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CullAsked asked;
    CROFTON_CHECK(read_query(view, options, jobs, __func__, asked));
    HostJobs executor(jobs);
    ViewRequest request = to_request(asked);
    copy_frustum(view->frustum, request.volume.emplace());
    request.layers = view->layer_mask;
    CROFTON_CHECK(status_of(world->world.view(request, visible->visible, executor), __func__));
    visible->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_world_view_camera(const crofton_world* world, const crofton_camera* camera,
                                         const crofton_cull_options* options, const crofton_jobs* jobs,
                                         crofton_visible_objects* visible) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_camera(camera, __func__));
    CullAsked asked;
    CROFTON_CHECK(read_options(options, __func__, asked));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    ViewRequest request = to_request(asked);
    request.camera = to_camera(*camera);
    CROFTON_CHECK(status_of(world->world.view(request, visible->visible, executor), __func__));
    visible->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_visible_objects_ids(const crofton_visible_objects* visible, const uint32_t** ids, size_t* count,
                                           const uint8_t** verdicts, size_t* inside_count) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(give_seen(visible->visible, ids, count, verdicts, __func__));
    if (inside_count) *inside_count = visible->visible.inside_count();
    return CROFTON_OK;
}

crofton_status crofton_visible_objects_list(const crofton_visible_objects* visible, const crofton_world* world,
                                            size_t first, crofton_object_ref* objects, size_t capacity) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    std::size_t count = 0;
    CROFTON_CHECK(count_listed(*visible, *world, first, objects, capacity, __func__, count));
    for (std::size_t i = 0; i < count; ++i) objects[i] = to_c_ref(visible->visible[first + i]);
    return CROFTON_OK;
}

crofton_status crofton_visible_objects_get_statistics(const crofton_visible_objects* visible,
                                                      crofton_cull_statistics* statistics) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return give_statistics(visible->visible.statistics(), statistics, __func__);
}

crofton_status crofton_visible_in_views_create(crofton_visible_in_views** visible) {
    CROFTON_CHECK(check_pointer(visible, __func__));
    return create(visible, __func__);
}

crofton_status crofton_visible_in_views_destroy(crofton_visible_in_views* visible) {
    return destroy(visible, __func__);
}

crofton_status crofton_world_views(const crofton_world* world, const crofton_view* views, size_t count,
                                   const crofton_cull_options* options, crofton_visible_in_views* visible) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(views, count, __func__));
    if (count > cull::kMaxViews) return report(CROFTON_OUT_OF_RANGE, __func__, "more than 32 views");
    for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(check_view(&views[i], __func__));
    CullAsked asked;
    CROFTON_CHECK(read_options(options, __func__, asked));
    std::array<ViewRequest, cull::kMaxViews> requests;
    for (std::size_t i = 0; i < count; ++i) {
        requests[i] = to_request(asked);
        copy_frustum(views[i].frustum, requests[i].volume.emplace());
        requests[i].layers = views[i].layer_mask;
    }
    CROFTON_CHECK(
        status_of(world->world.view(std::span<const ViewRequest>(requests).first(count), visible->visible), __func__));
    visible->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_visible_in_views_ids(const crofton_visible_in_views* visible, const uint32_t** ids,
                                            size_t* count) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return give_ids(visible->visible.ids(), ids, count, __func__);
}

crofton_status crofton_visible_in_views_list(const crofton_visible_in_views* visible, const crofton_world* world,
                                             size_t first, crofton_object_ref* objects, uint32_t* view_masks,
                                             size_t capacity) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    std::size_t count = 0;
    CROFTON_CHECK(count_listed(*visible, *world, first, objects, capacity, __func__, count));
    for (std::size_t i = 0; i < count; ++i) {
        objects[i] = to_c_ref(visible->visible[first + i]);
        if (view_masks) view_masks[i] = visible->visible.view_mask(first + i);
    }
    return CROFTON_OK;
}
