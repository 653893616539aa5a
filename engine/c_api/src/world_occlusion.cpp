// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <optional>
#include <span>

#include <crofton/capi/convert.hpp>
#include "growing.hpp"
#include "queries.hpp"
#include "visible.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

crofton_status read_occlusion(const crofton_occlusion_options* argument, const char* function,
                              std::optional<OcclusionOptions>& result) {
    crofton_occlusion_options given{};
    if (argument) CROFTON_CHECK(read_growing(argument, function, given));
    if (given.disabled != 0) return CROFTON_OK;
    result.emplace();
    if (given.width) result->size.width = given.width;
    if (given.height) result->size.height = given.height;
    if (given.max_occluders) result->max_occluders = given.max_occluders;
    if (given.least_cover != 0.0f) result->least_cover = given.least_cover;
    result->list_occluded = given.list_occluded != 0;
    return CROFTON_OK;
}

crofton_status read_eye(const crofton_occluding_view& given, const char* function, ViewRequest& result) {
    result.layers = ~given.hidden_layers;
    if (given.camera) {
        CROFTON_CHECK(check_camera(given.camera, function));
        result.camera = to_camera(*given.camera);
        return CROFTON_OK;
    }
    CROFTON_CHECK(check_pointer(given.to_clip, function));
    if (given.depth > CROFTON_DEPTH_MINUS_ONE_TO_ONE)
        return report(CROFTON_INVALID_ARGUMENT, function, "unknown depth range");
    result.matrix = ViewMatrix{matrix_of(std::span<const double, 16>(given.to_clip, 16), MatrixOrder::columns),
                               static_cast<DepthRange>(given.depth), to_vector(given.origin)};
    return CROFTON_OK;
}

// What a call is asked with besides its views.
struct Asked {
    std::optional<OcclusionOptions> occlusion;
    CullAsked cull;
};

crofton_status to_asked(const crofton_draw_limits* limits, const crofton_occlusion_options* occlusion,
                        const crofton_cull_options* options, const crofton_jobs* jobs, const char* function,
                        Asked& asked) {
    CROFTON_CHECK(read_occlusion(occlusion, function, asked.occlusion));
    CROFTON_CHECK(read_options(options, function, asked.cull));
    CROFTON_CHECK(check_jobs(jobs, function));
    return read_limits(limits, function, asked.cull);
}

void add_options(const Asked& asked, ViewRequest& request) {
    request.occlusion = asked.occlusion;
    request.limits = asked.cull.options.limits;
    request.candidate_mask = asked.cull.options.candidate_mask;
    request.order = asked.cull.options.order;
    request.mode = asked.cull.options.mode;
}

crofton_status write_statistics(const OcclusionStatistics& s, crofton_occlusion_statistics* result,
                                const char* function) {
    CROFTON_CHECK(check_growing(result, function));
    write_growing(
        {sizeof *result, s.occluders_drawn, s.drawn.pieces_drawn, s.drawn.triangles_drawn, s.asked.nodes_tested,
         s.asked.nodes_outside, s.asked.nodes_hidden, s.asked.items_tested, s.asked.items_hidden},
        result);
    return CROFTON_OK;
}

crofton_status write_depth(const occlude::OcclusionBuffer& buffer, uint32_t* width, uint32_t* height, float* nearness,
                           size_t capacity, const char* function) {
    CROFTON_CHECK(check_pointer(width, function));
    CROFTON_CHECK(check_pointer(height, function));
    const occlude::BufferSize size = buffer.size();
    const std::size_t count = std::size_t{size.width} * size.height;
    if (nearness && capacity < count)
        return report(CROFTON_OUT_OF_RANGE, function, "the depth buffer has more pixels than `capacity`", count);
    *width = size.width;
    *height = size.height;
    if (nearness) buffer.read({nearness, count});
    return CROFTON_OK;
}

// `visible` is a result of this world's; there is room for occluders of it.
crofton_status check_asked_of(const crofton_world& world, const crofton_visible_objects& visible,
                              const crofton_occluder_ref* occluders, size_t capacity, const size_t* count,
                              const char* function) {
    CROFTON_CHECK(check_pointer(count, function));
    CROFTON_CHECK(check_room(occluders, capacity, function));
    return check_viewed(visible, world, function);
}

void write_occluders(const Vector<OccluderRef>& found, crofton_occluder_ref* occluders, size_t capacity,
                     size_t* count) {
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i)
        occluders[i] = {{found[i].object.index, found[i].object.generation}, found[i].user, found[i].place, 0};
    *count = found.size();
}

}  // namespace

crofton_status crofton_world_view_occluding(const crofton_world* world, const crofton_occluding_view* view,
                                            const crofton_occlusion_options* occlusion,
                                            const crofton_cull_options* options, const crofton_jobs* jobs,
                                            crofton_visible_objects* visible) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    crofton_occluding_view given;
    CROFTON_CHECK(read_growing(view, __func__, given));
    Asked asked;
    CROFTON_CHECK(to_asked(given.limits, occlusion, options, jobs, __func__, asked));
    ViewRequest request;
    CROFTON_CHECK(read_eye(given, __func__, request));
    add_options(asked, request);
    HostJobs executor(jobs);
    CROFTON_CHECK(status_of(world->world.view(request, visible->visible, executor), __func__));
    visible->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_world_views_occluding(const crofton_world* world, const crofton_occluding_view* views,
                                             size_t count, const crofton_occlusion_options* occlusion,
                                             const crofton_cull_options* options, const crofton_jobs* jobs,
                                             crofton_visible_in_views* visible) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(views, count, __func__));
    if (count > cull::kMaxViews) return report(CROFTON_OUT_OF_RANGE, __func__, "more than 32 views");
    std::array<ViewRequest, cull::kMaxViews> requests;
    const crofton_draw_limits* limits = nullptr;
    for (std::size_t v = 0; v < count; ++v) {
        crofton_occluding_view given;
        CROFTON_CHECK(read_growing_at(views, v, __func__, given));
        CROFTON_CHECK(of_item(read_eye(given, __func__, requests[v]), v));
        if (v == 0)
            limits = given.limits;
        else if (given.limits && given.limits != limits)
            return report(CROFTON_INVALID_ARGUMENT, __func__,
                          "a view has other limits than the first, whose limits count for all", v);
    }
    Asked asked;
    CROFTON_CHECK(to_asked(limits, occlusion, options, jobs, __func__, asked));
    for (std::size_t v = 0; v < count; ++v) {
        add_options(asked, requests[v]);
    }
    HostJobs executor(jobs);
    CROFTON_CHECK(status_of(
        world->world.view(std::span<const ViewRequest>(requests).first(count), visible->visible, executor), __func__));
    visible->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_visible_objects_occluded_ids(const crofton_visible_objects* visible, const uint32_t** ids,
                                                    size_t* count) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return give_ids(visible->visible.occluded_ids(), ids, count, __func__);
}

crofton_status crofton_visible_objects_get_occlusion_statistics(const crofton_visible_objects* visible,
                                                                crofton_occlusion_statistics* statistics) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    return write_statistics(visible->visible.occlusion_statistics(), statistics, __func__);
}

crofton_status crofton_visible_in_views_get_occlusion_statistics(const crofton_visible_in_views* visible, size_t view,
                                                                 crofton_occlusion_statistics* statistics) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    if (!visible->visible.occlusion_buffer(view))
        return report(CROFTON_OUT_OF_RANGE, __func__, "there are fewer views with occlusion", view);
    return write_statistics(visible->visible.occlusion_statistics(view), statistics, __func__);
}

crofton_status crofton_visible_objects_depth(const crofton_visible_objects* visible, uint32_t* width, uint32_t* height,
                                             float* nearness, size_t capacity) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    const occlude::OcclusionBuffer* buffer = visible->visible.occlusion_buffer();
    if (!buffer) return report(CROFTON_EMPTY, __func__, "the last view was without occlusion");
    return write_depth(*buffer, width, height, nearness, capacity, __func__);
}

crofton_status crofton_visible_in_views_depth(const crofton_visible_in_views* visible, size_t view, uint32_t* width,
                                              uint32_t* height, float* nearness, size_t capacity) {
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    if (!visible->visible.occlusion_buffer(view))
        return report(CROFTON_OUT_OF_RANGE, __func__, "there are fewer views with occlusion", view);
    return write_depth(*visible->visible.occlusion_buffer(view), width, height, nearness, capacity, __func__);
}

crofton_status crofton_world_hidden_by(const crofton_world* world, crofton_object object,
                                       const crofton_visible_objects* visible, crofton_occluder_ref* occluders,
                                       size_t capacity, size_t* count) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_asked_of(*world, *visible, occluders, capacity, count, __func__));
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(world->world.hidden_by(to_handle(object), visible->visible, found), __func__));
    write_occluders(found, occluders, capacity, count);
    return CROFTON_OK;
}

crofton_status crofton_world_drawn_occluders(const crofton_world* world, const crofton_visible_objects* visible,
                                             crofton_occluder_ref* occluders, size_t capacity, size_t* count) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const SharedUse use(visible, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_asked_of(*world, *visible, occluders, capacity, count, __func__));
    Vector<OccluderRef> found;
    CROFTON_CHECK(status_of(world->world.drawn_occluders(visible->visible, found), __func__));
    write_occluders(found, occluders, capacity, count);
    return CROFTON_OK;
}
