// SPDX-License-Identifier: MIT
// Requests of views, read and checked.
#pragma once
#include <crofton/capi/view.h>

#include <crofton/cull/cull.hpp>
#include <crofton/world/inputs.hpp>

#include <crofton/capi/view_result.hpp>

namespace crofton::capi {

// A request of a World. `limits` is room for those of the request; `answer` is where the answer goes.
[[nodiscard]] crofton_status read_request(const crofton_view_request& given, const crofton_view_result& answer,
                                          const char* function, ViewRequest& request, cull::DrawLimits& limits);

[[nodiscard]] crofton_status read_picture(const crofton_picture_view* picture, const char* function,
                                          depth::PictureView& view);

// What a list of boxes or a tree of them is asked with. `options` points to `limits` where there are any.
struct BoxQuery {
    cull::CullOptions options;
    cull::DrawLimits limits;

    BoxQuery() = default;
    BoxQuery(const BoxQuery&) = delete;
    BoxQuery& operator=(const BoxQuery&) = delete;
};
// The view is written to the result, which then is one of boxes.
[[nodiscard]] crofton_status read_box_request(const crofton_view_request* request, const crofton_jobs* jobs,
                                              const char* function, crofton_view_result& result, BoxQuery& query);

}  // namespace crofton::capi
