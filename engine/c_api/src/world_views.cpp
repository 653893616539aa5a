// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <crofton/capi/convert.hpp>
#include "growing.hpp"
#include "queries.hpp"
#include "view_result.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

crofton_status read_occlusion(const crofton_occlusion_options* argument, const char* function,
                              std::optional<OcclusionOptions>& result) {
    if (!argument) return CROFTON_OK;
    crofton_occlusion_options given;
    CROFTON_CHECK(read_growing(argument, function, given));
    result.emplace();
    if (given.width) result->size.width = given.width;
    if (given.height) result->size.height = given.height;
    if (given.max_occluders) result->max_occluders = given.max_occluders;
    if (given.least_cover != 0.0f) result->least_cover = given.least_cover;
    result->list_occluded = given.list_occluded != 0;
    return CROFTON_OK;
}

crofton_status read_matrix(const crofton_view_matrix* argument, const char* function,
                           std::optional<ViewMatrix>& result) {
    if (!argument) return CROFTON_OK;
    crofton_view_matrix given;
    CROFTON_CHECK(read_growing(argument, function, given));
    if ((given.doubles == nullptr) == (given.floats == nullptr))
        return report(CROFTON_INVALID_ARGUMENT, function, "a matrix has either `doubles` or `floats`");
    if (given.depth > CROFTON_DEPTH_MINUS_ONE_TO_ONE)
        return report(CROFTON_INVALID_ARGUMENT, function, "unknown depth range");
    const MatrixOrder order = given.is_row_major ? MatrixOrder::rows : MatrixOrder::columns;
    result = ViewMatrix{given.doubles ? matrix_of(std::span<const double, 16>(given.doubles, 16), order)
                                      : matrix_of(std::span<const float, 16>(given.floats, 16), order),
                        static_cast<DepthRange>(given.depth), to_vector(given.origin)};
    return CROFTON_OK;
}

// `limits` is room for those of the request.
crofton_status read_request(const crofton_view_request& given, const char* function, ViewRequest& request,
                            cull::DrawLimits& limits) {
    if (given.camera) {
        CROFTON_CHECK(check_camera(given.camera, function));
        request.camera = to_camera(*given.camera);
    }
    CROFTON_CHECK(read_matrix(given.matrix, function, request.matrix));
    if (given.volume) {
        CROFTON_CHECK(check_frustum(given.volume, function));
        copy_frustum(*given.volume, request.volume.emplace());
    }
    request.layers = given.layers;
    CROFTON_CHECK(read_occlusion(given.occlusion, function, request.occlusion));
    if (given.limits) {
        CROFTON_CHECK(read_limits(*given.limits, function, limits));
        request.limits = &limits;
    }
    CROFTON_CHECK(check_array(given.candidate_mask, given.candidate_words, function));
    request.candidate_mask = std::span(given.candidate_mask, given.candidate_mask ? given.candidate_words : 0);
    request.order = given.tree_order ? cull::ResultOrder::tree : cull::ResultOrder::ascending;
    request.mode = given.conservative ? cull::CullMode::conservative : cull::CullMode::exact;
    return CROFTON_OK;
}

crofton_status check_view_number(const crofton_view_result& result, std::size_t view, const char* function) {
    if (view < (result.is_many ? result.many.view_count() : 1)) return CROFTON_OK;
    return report(CROFTON_OUT_OF_RANGE, function, "there are fewer views", view);
}

const occlude::OcclusionBuffer* buffer_of(const crofton_view_result& result, std::size_t view) {
    return result.is_many ? result.many.occlusion_buffer(view) : result.one.occlusion_buffer();
}

}  // namespace

crofton_status crofton_view_result_create(crofton_view_result** result) {
    CROFTON_CHECK(check_pointer(result, __func__));
    return create(result, __func__);
}

crofton_status crofton_view_result_destroy(crofton_view_result* result) {
    return destroy(result, __func__);
}

crofton_status crofton_world_view(const crofton_world* world, const crofton_view_request* request,
                                  const crofton_jobs* jobs, crofton_view_result* result) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(result, __func__);
    if (use.failed()) return use.status();
    crofton_view_request given;
    CROFTON_CHECK(read_growing(request, __func__, given));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    ViewRequest asked;
    cull::DrawLimits limits;
    CROFTON_CHECK(read_request(given, __func__, asked, limits));
    HostJobs executor(jobs);
    CROFTON_CHECK(status_of(world->world.view(asked, result->one, executor), __func__));
    result->is_many = false;
    result->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_world_view_many(const crofton_world* world, const crofton_view_request* requests, size_t count,
                                       const crofton_jobs* jobs, crofton_view_result* result) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(result, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(requests, count, __func__));
    if (count > cull::kMaxViews) return report(CROFTON_OUT_OF_RANGE, __func__, "more than 32 views", cull::kMaxViews);
    CROFTON_CHECK(check_jobs(jobs, __func__));
    std::array<ViewRequest, cull::kMaxViews> asked;
    std::array<cull::DrawLimits, cull::kMaxViews> limits;
    for (std::size_t v = 0; v < count; ++v) {
        crofton_view_request given;
        CROFTON_CHECK(read_growing_at(requests, v, __func__, given));
        CROFTON_CHECK(of_item(read_request(given, __func__, asked[v], limits[v]), v));
        // Views with the same limits are answered in one walk.
        for (std::size_t w = 0; w < v && asked[v].limits == &limits[v]; ++w) {
            crofton_view_request earlier;
            CROFTON_CHECK(read_growing_at(requests, w, __func__, earlier));
            if (earlier.limits == given.limits) asked[v].limits = asked[w].limits;
        }
    }
    HostJobs executor(jobs);
    CROFTON_CHECK(status_of(world->world.view(std::span<const ViewRequest>(asked).first(count), result->many, executor),
                            __func__));
    result->is_many = true;
    result->serial = world->serial;
    return CROFTON_OK;
}

crofton_status crofton_view_result_ids(const crofton_view_result* result, const uint32_t** ids, size_t* count,
                                       const uint8_t** verdicts, size_t* inside_count) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    if (!result->is_many) {
        CROFTON_CHECK(give_seen(result->one, ids, count, verdicts, __func__));
        if (inside_count) *inside_count = result->one.inside_count();
        return CROFTON_OK;
    }
    CROFTON_CHECK(give_ids(result->many.ids(), ids, count, __func__));
    if (verdicts) *verdicts = nullptr;
    if (inside_count) *inside_count = 0;
    return CROFTON_OK;
}

crofton_status crofton_view_result_list(const crofton_view_result* result, const crofton_world* world, size_t first,
                                        crofton_object_ref* objects, uint32_t* view_masks, size_t capacity) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    CROFTON_CHECK(check_room(objects, capacity, __func__));
    CROFTON_CHECK(check_viewed(*result, *world, __func__));
    const std::size_t size = result->is_many ? result->many.size() : result->one.size();
    if (first > size) return report(CROFTON_OUT_OF_RANGE, __func__, "fewer objects are seen than `first`", first);
    for (std::size_t i = 0; i < std::min(capacity, size - first); ++i) {
        objects[i] = to_c_ref(result->is_many ? result->many[first + i] : result->one[first + i]);
        if (view_masks) view_masks[i] = result->is_many ? result->many.view_mask(first + i) : 1u;
    }
    return CROFTON_OK;
}

crofton_status crofton_view_result_get_statistics(const crofton_view_result* result,
                                                  crofton_cull_statistics* statistics) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    if (result->is_many) return report(CROFTON_UNSUPPORTED, __func__, "the last call viewed many at once");
    return give_statistics(result->one.statistics(), statistics, __func__);
}

crofton_status crofton_view_result_occluded_ids(const crofton_view_result* result, const uint32_t** ids,
                                                size_t* count) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    return give_ids(result->is_many ? std::span<const std::uint32_t>() : result->one.occluded_ids(), ids, count,
                    __func__);
}

crofton_status crofton_view_result_get_occlusion_statistics(const crofton_view_result* result, size_t view,
                                                            crofton_occlusion_statistics* statistics) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_view_number(*result, view, __func__));
    CROFTON_CHECK(check_growing(statistics, __func__));
    const OcclusionStatistics s =
        result->is_many ? result->many.occlusion_statistics(view) : result->one.occlusion_statistics();
    write_growing(
        {sizeof *statistics, s.occluders_drawn, s.drawn.pieces_drawn, s.drawn.triangles_drawn, s.asked.nodes_tested,
         s.asked.nodes_outside, s.asked.nodes_hidden, s.asked.items_tested, s.asked.items_hidden},
        statistics);
    return CROFTON_OK;
}

crofton_status crofton_view_result_depth(const crofton_view_result* result, size_t view, uint32_t* width,
                                         uint32_t* height, float* nearness, size_t capacity) {
    const SharedUse use(result, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_view_number(*result, view, __func__));
    CROFTON_CHECK(check_pointer(width, __func__));
    CROFTON_CHECK(check_pointer(height, __func__));
    const occlude::OcclusionBuffer* const buffer = buffer_of(*result, view);
    if (!buffer) return report(CROFTON_EMPTY, __func__, "the view was without occlusion", view);
    const occlude::BufferSize size = buffer->size();
    const std::size_t count = std::size_t{size.width} * size.height;
    if (nearness && capacity < count)
        return report(CROFTON_OUT_OF_RANGE, __func__, "the depth buffer has more pixels than `capacity`", count);
    *width = size.width;
    *height = size.height;
    if (nearness) buffer->read({nearness, count});
    return CROFTON_OK;
}
