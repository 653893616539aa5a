// SPDX-License-Identifier: MIT
// Marks where a triangle of the receivers lies in a shadow map, row by row of tiles. Compiled once per instruction set
// (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_MAP_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_MAP_ROWS_INL
#undef CROFTON_DEPTH_MAP_ROWS_INL
#else
#define CROFTON_DEPTH_MAP_ROWS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Columns between the triangle's edges, and its farthest nearness, in rows of tiles that begin at `row`: one a lane.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void find_rows(const MapTriangle& t, V row, V& first, V& last, V& farthest) {
    const D d;
    const V low = hn::Sub(hn::Add(hn::Mul(row, hn::Set(d, double{kTile})), hn::Set(d, 0.5)), hn::Set(d, t.reach));
    const V high = hn::Add(hn::Add(low, hn::Set(d, kTile - 1.0)), hn::Set(d, 2.0 * t.reach));
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t n = k == 2 ? 0 : k + 1;
        const double bottom = std::min(t.y[k], t.y[n]), top = std::max(t.y[k], t.y[n]);
        const auto meets = hn::And(hn::Ge(hn::Set(d, top), low), hn::Le(hn::Set(d, bottom), high));
        for (const std::uint32_t end : {k, n}) {
            // The end of the edge, or where it leaves the rows.
            const V y = hn::Set(d, t.y[end]);
            const V up = hn::Sub(hn::Min(hn::Max(y, low), high), y);
            const V x = hn::Add(hn::Set(d, t.x[end]), hn::Mul(up, hn::Set(d, t.x_per_row[k])));
            const V z = hn::Add(hn::Set(d, t.z[end]), hn::Mul(up, hn::Set(d, t.z_per_row[k])));
            first = hn::IfThenElse(meets, hn::Min(first, x), first);
            last = hn::IfThenElse(meets, hn::Max(last, x), last);
            farthest = hn::IfThenElse(meets, hn::Max(farthest, z), farthest);
        }
    }
}

// Lowers floors[first … last] to `floor`; nothing else changes.
HWY_INLINE void lower_floors(float* floors, std::uint32_t first, std::uint32_t last, float floor) {
    const DF d;
    const VF limit = hn::Set(d, floor);
    std::uint32_t at = first;
    for (; at + hn::Lanes(d) <= last + 1; at += static_cast<std::uint32_t>(hn::Lanes(d)))
        hn::StoreU(hn::Min(hn::LoadU(d, floors + at), limit), d, floors + at);
    for (; at <= last; ++at) floors[at] = std::min(floors[at], floor);
}

HWY_INLINE bool mark_triangle(const MapTriangle& t, std::uint32_t first_row, std::uint32_t last_row,
                              std::uint32_t width, float* floors) {
    const hn::CappedTag<double, kTile> d;
    const std::uint32_t columns = (width + kTile - 1) / kTile;
    const auto size = static_cast<double>(width);
    const auto reach = hn::Set(d, t.reach), half = hn::Set(d, 0.5);
    alignas(64) static constexpr double kSteps[kTile] = {0, 1, 2, 3, 4, 5, 6, 7};
    alignas(64) double firsts[kTile], lasts[kTile], farthests[kTile];
    bool marked = false;
    for (std::uint32_t row = first_row; row <= last_row; row += static_cast<std::uint32_t>(hn::Lanes(d))) {
        auto first = hn::Set(d, size), last = hn::Set(d, -1.0);
        auto farthest = hn::Set(d, -std::numeric_limits<double>::infinity());
        find_rows<decltype(d)>(t, hn::Add(hn::Set(d, static_cast<double>(row)), hn::Load(d, kSteps)), first, last,
                               farthest);
        hn::Store(hn::Max(hn::Ceil(hn::Sub(hn::Sub(first, reach), half)), hn::Zero(d)), d, firsts);
        hn::Store(hn::Min(hn::Floor(hn::Sub(hn::Add(last, reach), half)), hn::Set(d, size - 1.0)), d, lasts);
        hn::Store(hn::Sub(hn::Neg(farthest), hn::Set(d, t.depth_error)), d, farthests);
        const std::uint32_t count = std::min(static_cast<std::uint32_t>(hn::Lanes(d)), last_row - row + 1);
        for (std::uint32_t i = 0; i < count; ++i) {
            if (!(firsts[i] <= lasts[i])) continue;
            marked = true;
            lower_floors(floors + std::size_t{row + i} * columns, static_cast<std::uint32_t>(firsts[i]) / kTile,
                         static_cast<std::uint32_t>(lasts[i]) / kTile, static_cast<float>(farthests[i]));
        }
    }
    return marked;
}

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
