// SPDX-License-Identifier: MIT
// Boxes as the builder of hierarchies takes them: four floats at a time, the fourth of which is never read.
#pragma once
#include <crofton/geometry/float_lanes.hpp>
#include <limits>

namespace crofton::mesh {

struct WideBox {
    detail::Lanes4 low = detail::all_lanes(std::numeric_limits<float>::infinity());
    detail::Lanes4 high = detail::all_lanes(-std::numeric_limits<float>::infinity());

    void include(const detail::Lanes4& low_corner, const detail::Lanes4& high_corner) {
        low = detail::lesser(low_corner, low);
        high = detail::larger(high_corner, high);
    }
    void include(const WideBox& box) { include(box.low, box.high); }
    [[nodiscard]] detail::Lanes4 middle() const {
        return detail::all_lanes(0.5f) * low + detail::all_lanes(0.5f) * high;
    }
    // The same bits, of one lane.
    [[nodiscard]] float middle(int axis) const { return 0.5f * low[axis] + 0.5f * high[axis]; }
};

// 0 of an empty box.
[[nodiscard]] inline double half_area(const WideBox& box) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = static_cast<double>(box.high[k]) - static_cast<double>(box.low[k]);
    return d[0] >= 0.0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0;
}

}  // namespace crofton::mesh
