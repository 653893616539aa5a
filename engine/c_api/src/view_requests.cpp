// SPDX-License-Identifier: MIT
// What views ask.
#include <crofton/capi/crofton.h>

#include <optional>
#include <span>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/queries.hpp>
#include <crofton/capi/requests.hpp>

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

crofton_status read_camera(const crofton_camera* camera, const char* function, std::optional<Camera>& result) {
    if (!camera) return CROFTON_OK;
    CROFTON_CHECK(check_camera(camera, function));
    result = to_camera(*camera);
    return CROFTON_OK;
}

// `answer`: where that to the request goes.
crofton_status read_receivers(const crofton_shadow_receivers* argument, const crofton_view_result& answer,
                              const char* function, std::optional<ShadowReceivers>& result) {
    if (!argument) return CROFTON_OK;
    crofton_shadow_receivers given;
    CROFTON_CHECK(read_growing(argument, function, given));
    if (given.seen == &answer)  // which this call has for itself
        return report(CROFTON_INVALID_ARGUMENT, function,
                      "view: a light's answer cannot replace that of its receivers");
    const SharedUse use(given.seen, function);
    if (use.failed()) return use.status();
    if (given.seen->of != crofton_view_result::Of::world)
        return report(CROFTON_INVALID_ARGUMENT, function, "view: receivers need the answer to one view of a World");
    result = ShadowReceivers{&given.seen->one, static_cast<float>(given.radius)};
    return CROFTON_OK;
}

// What all requests have: limits, candidates, order and mode.
template <class Request>
crofton_status read_options(const crofton_view_request& given, const char* function, Request& request,
                            cull::DrawLimits& limits) {
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

// The volume of a camera, a matrix or its own.
crofton_status read_volume(const crofton_view_request& given, const char* function, Frustum& volume) {
    if ((given.camera != nullptr) + (given.matrix != nullptr) + (given.volume != nullptr) != 1)
        return report(CROFTON_INVALID_ARGUMENT, function, "view: set one of `camera`, `matrix` and `volume`");
    if (given.volume) {
        CROFTON_CHECK(check_frustum(given.volume, function));
        copy_frustum(*given.volume, volume);
        return CROFTON_OK;
    }
    std::optional<Camera> camera;
    std::optional<ViewMatrix> matrix;
    CROFTON_CHECK(read_camera(given.camera, function, camera));
    CROFTON_CHECK(read_matrix(given.matrix, function, matrix));
    const auto found = camera ? frustum_of(*camera) : frustum_of(matrix->to_clip, matrix->depth, matrix->origin);
    if (!found) return report(found.error(), function);
    volume = *found;
    return CROFTON_OK;
}

}  // namespace

crofton_status capi::read_picture(const crofton_picture_view* picture, const char* function, depth::PictureView& view) {
    crofton_picture_view given;
    CROFTON_CHECK(read_growing(picture, function, given));
    if (given.depth > CROFTON_DEPTH_MINUS_ONE_TO_ONE)
        return report(CROFTON_INVALID_ARGUMENT, function, "unknown depth range");
    view = {given.width, given.height, static_cast<DepthRange>(given.depth), given.samples, given.work_limit};
    return CROFTON_OK;
}

crofton_status capi::read_request(const crofton_view_request& given, const crofton_view_result& answer,
                                  const char* function, ViewRequest& request, cull::DrawLimits& limits) {
    CROFTON_CHECK(read_camera(given.camera, function, request.camera));
    CROFTON_CHECK(read_matrix(given.matrix, function, request.matrix));
    if (given.volume) {
        CROFTON_CHECK(check_frustum(given.volume, function));
        copy_frustum(*given.volume, request.volume.emplace());
    }
    request.layers = given.layers;
    CROFTON_CHECK(read_occlusion(given.occlusion, function, request.occlusion));
    if (given.picture) CROFTON_CHECK(read_picture(given.picture, function, request.picture.emplace()));
    CROFTON_CHECK(read_receivers(given.receivers, answer, function, request.receivers));
    return read_options(given, function, request, limits);
}

crofton_status capi::read_box_request(const crofton_view_request* request, const crofton_jobs* jobs,
                                      const char* function, crofton_view_result& result, BoxQuery& query) {
    crofton_view_request given;
    CROFTON_CHECK(read_growing(request, function, given));
    CROFTON_CHECK(check_jobs(jobs, function));
    if (given.occlusion) return report(CROFTON_UNSUPPORTED, function, "view: `occlusion` needs a World");
    if (given.picture) return report(CROFTON_UNSUPPORTED, function, "view: `picture` needs a World");
    CROFTON_CHECK(read_options(given, function, query.options, query.limits));
    CROFTON_CHECK(read_volume(given, function, result.view.frustum));
    result.view.layer_mask = given.layers;
    result.of = crofton_view_result::Of::boxes;
    result.serial = 0;
    return CROFTON_OK;
}
