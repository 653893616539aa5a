// SPDX-License-Identifier: MIT
#include "bounds_meet.hpp"

#include <cmath>
#include <crofton/geometry/expansion.hpp>

namespace crofton::collide {
namespace {

// Half widths are sums of products of two floats, which are exact in double.
double half_width_term(const Obb& box, int k, int i) {
    return std::abs(static_cast<double>(box.axes[k][i])) * static_cast<double>(box.half_extents[k]);
}

// Scaled as in obb_obb.cpp, so that every term is in Expansion's range.
bool apart_exactly(const Obb& a, const Obb& b, int i) {
    constexpr double kScale = 0x1p600;
    Expansion<4> gap = exact_difference(b.center[i], a.center[i]) * kScale;
    if (gap.sign() < 0) gap = -gap;
    const auto width = [&](const Obb& box) {
        return exact_sum(half_width_term(box, 0, i) * kScale, half_width_term(box, 1, i) * kScale) +
               exact(half_width_term(box, 2, i) * kScale);
    };
    return (gap - (width(a) + width(b))).sign() > 0;
}

}  // namespace

bool bounds_meet(const Obb& a, const Obb& b) {
    for (int i = 0; i < 3; ++i) {
        const double gap = std::abs(b.center[i] - a.center[i]);
        double width = 0.0;
        for (int k = 0; k < 3; ++k) width += half_width_term(a, k, i) + half_width_term(b, k, i);
        // Seven roundings of 2^-53 of a sum no larger than both.
        const double error = 0x1p-50 * (gap + width);
        if (gap > width + error) return false;
        if (gap < width - error) continue;
        if (apart_exactly(a, b, i)) return false;
    }
    return true;
}

}  // namespace crofton::collide
