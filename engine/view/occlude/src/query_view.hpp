// SPDX-License-Identifier: MIT
// A drawn buffer as the query kernels read it.
#pragma once
#include <algorithm>
#include <cmath>

#include "buffer_data.hpp"
#include "query_kernel.hpp"

namespace crofton::occlude {

[[nodiscard]] inline QueryView query_view_of(const OcclusionBuffer::Data& data) {
    const PixelMap& map = data.map;
    QueryView view{};
    std::copy_n(map.origin, 3, view.origin);
    for (std::size_t r = 0; r < 3; ++r) {
        const double(&form)[4] = map.form[r == 2 && !map.perspective ? 3 : r];
        double max_abs = 0.0;
        for (std::size_t k = 0; k < 4; ++k) view.form[r][k] = static_cast<float>(form[k]);
        for (std::size_t k = 0; k < 3; ++k) max_abs = std::max(max_abs, std::fabs(form[k]));
        view.max_abs[r] = static_cast<float>(max_abs * (1.0 + 0x1p-20));
    }
    view.least_w = static_cast<float>(map.least_w);
    view.half_width = static_cast<float>(map.half_width);
    view.half_height = static_cast<float>(map.half_height);
    view.width = map.width;
    view.height = map.height;
    view.tile_columns = data.tile_columns;
    view.padded_rows = data.padded_rows;
    view.perspective = map.perspective;
    view.pixels = data.pixels.data();
    view.least = data.least.data();
    view.front = data.front.data();
    view.covers = data.covers.data();
    view.shadows = data.shadows.data();
    return view;
}

}  // namespace crofton::occlude
