// SPDX-License-Identifier: MIT
// Requests of a World's view from the parts that tests have at hand.
#pragma once
#include <crofton/cull/cull.hpp>
#include <crofton/world/inputs.hpp>
#include <span>
#include <vector>

namespace crofton {

[[nodiscard]] inline ViewRequest request_of(const cull::View& view,
                                            cull::ResultOrder order = cull::ResultOrder::ascending) {
    ViewRequest request;
    request.volume = view.frustum;
    request.layers = view.layer_mask;
    request.order = order;
    return request;
}

[[nodiscard]] inline std::vector<ViewRequest> requests_of(std::span<const cull::View> views) {
    std::vector<ViewRequest> requests;
    for (const cull::View& view : views) requests.push_back(request_of(view));
    return requests;
}

}  // namespace crofton
