// SPDX-License-Identifier: MIT
#include "list/row_planes.hpp"

#include <algorithm>

namespace crofton::cull {
namespace {

constexpr double kScale = 1 << kRowNormalBits;
// |normal|₁ ≤ √3 · 1.0005 · 2^14 + 3/2 and coordinates up to 2^14 − 1: |normal · x| < 4.66e8 < kMaxOffset. Larger
// offsets are clamped. At +kMaxOffset s is positive and at most the true value: it rejects nothing, and what it accepts
// is inside. At −kMaxOffset it is negative and at least the true value: it accepts nothing, and what it rejects is
// outside. s stays below 2^14 · kUnboundedRadius + slack in
// magnitude, so that an unbounded radius neither rejects nor accepts; the sums stay within 32 bits.
constexpr double kMaxOffset = 1 << 29;
constexpr double kMaxSlack = 1 << 26;

}  // namespace

void set_row_planes(const KernelView& view, const ListChunk& chunk, RowPlanes& result) {
    result.count = result.planes = 0;
    result.slack = 0;
    result.outside = result.useless = false;
    const LocalOrigin at = local_origin(view, chunk.origin, 0.0f);
    const double per_quantum = kScale / chunk.quantum;
    double lowest[KernelView::kMaxPlanes], highest[KernelView::kMaxPlanes], largest_slack = 0.0;
    std::int32_t normals[KernelView::kMaxPlanes][3];
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        const KernelPlane& plane = view.planes[i];
        const double value =
            plane.normal[0] * at.d[0] + plane.normal[1] * at.d[1] + plane.normal[2] * at.d[2] + plane.offset;
        const double offset = std::clamp(value * per_quantum, -kMaxOffset, kMaxOffset);
        // The value's seven roundings (as in local_plane), and the offset's to an integer.
        double slack = 0x1p-49 * (at.size + std::fabs(plane.offset)) * per_quantum + 1.0, span = 0.0;
        for (int j = 0; j < 3; ++j) {
            const double scaled = plane.normal[j] * kScale;
            normals[i][j] = static_cast<std::int32_t>(scaled + std::copysign(0.5, scaled));
            const double whole = normals[i][j];
            // The normal's rounding, and that of the row: half a quantum, and 2^14 · 2^-24 for the centre's in float.
            slack += std::fabs(scaled - whole) * chunk.extent[j] + std::fabs(scaled) * 0.502;
            span += std::fabs(whole) * chunk.extent[j];
        }
        result.offset[i] = static_cast<std::int32_t>(offset);
        lowest[i] = std::trunc(offset) - span - kScale * chunk.largest_radius;
        highest[i] = std::trunc(offset) + span + kScale * chunk.largest_radius;
        largest_slack = std::max(largest_slack, slack * (1.0 + 0x1p-20) + 1.0);
    }
    result.useless = !(largest_slack < kMaxSlack);
    if (result.useless) {
        result.planes = (1u << view.plane_count) - 1;
        return;
    }
    result.slack = static_cast<std::int32_t>(std::ceil(largest_slack));
    const bool bounded = chunk.largest_radius != kUnboundedRadius;
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        if (bounded && highest[i] < -result.slack) result.outside = true;
        if (bounded && lowest[i] >= result.slack) continue;
        const std::uint32_t n = result.count++;
        const auto half = [&](int j) { return static_cast<std::uint32_t>(normals[i][j]) & 0xffffu; };
        result.normal_xy[n] = half(0) | half(1) << 16;
        result.normal_z[n] = half(2);
        result.offset[n] = result.offset[i];
        result.planes |= 1u << i;
    }
}

}  // namespace crofton::cull
