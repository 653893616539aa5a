// SPDX-License-Identifier: MIT
#include "mesh_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "buffer_data.hpp"

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <crofton/simd/mask_bits-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace masks = crofton::simd::HWY_NAMESPACE;

// Rows of a tile, or its columns. No operation is contracted here: the bits are those of any target.
using DD = hn::CappedTag<double, kTile>;
using VD = hn::Vec<DD>;
using DS = hn::Rebind<float, DD>;
using DN = hn::Rebind<std::int32_t, DD>;
using DT = hn::CappedTag<float, kTile>;

// The columns [from, to] of each row of a row of tiles.
struct TouchedColumns {
    alignas(64) std::int32_t from[kTile], to[kTile];
};

// The pixels whose squares a polygon's edges enclose or touch, or nearly touch; row by row of tiles.
template <std::size_t N>
class TouchedPixels {
  public:
    HWY_INLINE TouchedPixels(const double (&x)[N], const double (&y)[N], const PatchTarget& target)
        : x_(x), y_(y), target_(target) {
        const double low = *std::min_element(y, y + N), high = *std::max_element(y, y + N);
        first_ = std::max(target.low_y, std::floor(low - target.margin));
        last_ = std::min(target.high_y, std::floor(high + target.margin));
    }

    HWY_INLINE bool any() const { return first_ <= last_; }
    HWY_INLINE std::uint32_t first_tile_row() const { return static_cast<std::uint32_t>(first_) / kTile; }
    HWY_INLINE std::uint32_t last_tile_row() const { return static_cast<std::uint32_t>(last_) / kTile; }

    HWY_INLINE void find(std::uint32_t tile_row, TouchedColumns& columns) const {
        const DD d;
        const DN dn;
        for (std::size_t r = 0; r < kTile; r += hn::Lanes(d)) {
            const VD row = hn::Iota(d, static_cast<double>(tile_row * kTile + r));
            VD left = hn::Inf(d), right = hn::Neg(hn::Inf(d));
            for (std::size_t i = 0; i < (N == 2 ? 1 : N); ++i) widen(i, (i + 1) % N, row, left, right);
            const VD margin = hn::Set(d, target_.margin);
            left = hn::Floor(hn::Min(hn::Sub(left, margin), hn::Set(d, 1e9)));
            right = hn::Floor(hn::Max(hn::Add(right, margin), hn::Set(d, -1e9)));
            left = hn::Max(left, hn::Set(d, target_.low_x));
            right = hn::Min(right, hn::Set(d, target_.high_x));
            const auto beside = hn::Or(hn::Lt(row, hn::Set(d, first_)), hn::Gt(row, hn::Set(d, last_)));
            right = hn::IfThenElse(beside, hn::Set(d, -1.0), right);
            hn::Store(hn::DemoteTo(dn, left), dn, columns.from + r);
            hn::Store(hn::DemoteTo(dn, right), dn, columns.to + r);
        }
    }

  private:
    // By the part of an edge within each row.
    HWY_INLINE void widen(std::size_t a, std::size_t b, VD row, VD& left, VD& right) const {
        const DD d;
        const VD margin = hn::Set(d, target_.margin);
        const VD from = hn::Max(hn::Sub(row, margin), hn::Set(d, std::min(y_[a], y_[b])));
        const VD to = hn::Min(hn::Add(hn::Add(row, hn::Set(d, 1.0)), margin), hn::Set(d, std::max(y_[a], y_[b])));
        const auto meets = hn::Le(from, to);
        const VD low = hn::Set(d, std::min(x_[a], x_[b])), high = hn::Set(d, std::max(x_[a], x_[b]));
        const double up = y_[b] - y_[a];
        if (std::fabs(up) < 0x1p-20) {
            left = hn::IfThenElse(meets, hn::Min(left, low), left);
            right = hn::IfThenElse(meets, hn::Max(right, high), right);
            return;
        }
        for (const VD y : {from, to}) {
            const VD part = hn::Div(hn::Sub(y, hn::Set(d, y_[a])), hn::Set(d, up));
            VD x = hn::Add(hn::Set(d, x_[a]), hn::Mul(hn::Set(d, x_[b] - x_[a]), part));
            x = hn::Min(hn::Max(x, low), high);
            left = hn::IfThenElse(meets, hn::Min(left, x), left);
            right = hn::IfThenElse(meets, hn::Max(right, x), right);
        }
    }

    const double (&x_)[N];
    const double (&y_)[N];
    const PatchTarget& target_;
    double first_, last_;
};

// Calls visit(tile, row, column, bits) for each row of pixels of a tile, `bits` being those that are touched.
template <std::size_t N, class Visit>
HWY_INLINE void for_each_touched(const double (&x)[N], const double (&y)[N], const PatchTarget& target,
                                 const Visit& visit) {
    const TouchedPixels<N> touched(x, y, target);
    if (!touched.any()) return;
    TouchedColumns columns;
    for (std::uint32_t tile_row = touched.first_tile_row(); tile_row <= touched.last_tile_row(); ++tile_row) {
        touched.find(tile_row, columns);
        const std::size_t tiles = std::size_t{tile_row - target.first_row} * target.columns;
        for (std::uint32_t r = 0; r < kTile; ++r) {
            if (columns.from[r] > columns.to[r]) continue;
            const auto from = static_cast<std::uint32_t>(columns.from[r]),
                       to = static_cast<std::uint32_t>(columns.to[r]);
            for (std::uint32_t column = from / kTile; column <= to / kTile; ++column) {
                const std::uint32_t first = std::max(from, column * kTile) - column * kTile;
                const std::uint32_t last = std::min(to, column * kTile + kTile - 1) - column * kTile;
                const std::uint32_t bits = (0xffu << first) & (0xffu >> (kTile - 1 - last));
                visit(tiles + column - target.first_column, tile_row * kTile + r, column * kTile, bits);
            }
        }
    }
}

// A triangle's numbers, in each lane.
struct TriangleLanes {
    VD plane[3], lower, farthest, sides[3][3], weights[3], line, limit;

    HWY_INLINE explicit TriangleLanes(const PatchTriangle& t) {
        const DD d;
        for (std::size_t k = 0; k < 3; ++k) {
            plane[k] = hn::Set(d, t.nearness[k]);
            weights[k] = hn::Set(d, t.weights[k]);
            for (std::size_t j = 0; j < 3; ++j) sides[k][j] = hn::Set(d, t.sides[k][j]);
        }
        lower = hn::Set(d, t.lower);
        farthest = hn::Set(d, t.farthest);
        line = hn::Set(d, t.line);
        limit = hn::Set(d, t.limit);
    }

    static HWY_INLINE VD at(const VD (&v)[3], VD x, VD y) {
        return hn::Add(hn::Add(hn::Mul(v[0], x), hn::Mul(v[1], y)), v[2]);
    }

    // The depth in floats, rounded down.
    HWY_INLINE hn::Vec<DS> depth(VD x, VD y) const {
        const DD d;
        VD depth = hn::Sub(at(plane, x, y), lower);
        depth = hn::IfThenElse(hn::Lt(depth, farthest), farthest, depth);
        return hn::DemoteTo(DS(), hn::Sub(depth, hn::Mul(hn::Set(d, 0x1p-23), hn::Abs(depth))));
    }

    HWY_INLINE hn::Mask<DD> meets(VD x, VD y) const {
        VD beyond = hn::Zero(DD());
        for (std::size_t k = 0; k < 3; ++k) {
            const VD inside = hn::Sub(at(sides[k], x, y), line);
            const VD outside = hn::Mul(hn::Neg(inside), weights[k]);
            beyond = hn::Add(beyond, hn::IfThenElseZero(hn::Lt(inside, hn::Zero(DD())), outside));
        }
        return hn::Le(beyond, limit);
    }
};

void draw_triangle(const PatchTriangle& triangle, const PatchTarget& target) {
    const TriangleLanes lanes(triangle);
    for_each_touched(triangle.x, triangle.y, target,
                     [&](std::size_t tile, std::uint32_t row, std::uint32_t column, std::uint32_t bits) HWY_ATTR {
                         const DD d;
                         const DS ds;
                         const VD half = hn::Set(d, 0.5);
                         const VD y = hn::Set(d, static_cast<double>(row) + 0.5 - target.half_height);
                         float* const values = target.values + tile * kTilePixels + row % kTile * kTile;
                         std::uint32_t reached = 0;
                         for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
                             const std::uint32_t part = bits >> i & ((1u << hn::Lanes(d)) - 1);
                             if (part == 0) continue;
                             const VD at = hn::Iota(d, static_cast<double>(column + i));
                             const VD x = hn::Sub(hn::Add(at, half), hn::Set(d, target.half_width));
                             const auto depth = lanes.depth(x, y), before = hn::Load(ds, values + i);
                             const auto less = hn::And(hn::Lt(depth, before), masks::mask_from_bits(ds, part));
                             hn::Store(hn::IfThenElse(less, depth, before), ds, values + i);
                             reached |= masks::mask_bits(d, lanes.meets(x, y)) << i;
                         }
                         target.reached[tile] |= std::uint64_t{reached & bits} << (row % kTile * kTile);
                     });
}

void draw_contour(const PatchEdge& edge, const PatchTarget& target) {
    for_each_touched(edge.x, edge.y, target,
                     [&](std::size_t tile, std::uint32_t row, std::uint32_t, std::uint32_t bits)
                         HWY_ATTR { target.contour[tile] |= std::uint64_t{bits} << (row % kTile * kTile); });
}

void finish_patch(const PatchTarget& target, std::size_t tiles) {
    const DT d;
    const auto uncovered = hn::Set(d, kUncovered);
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        const std::uint64_t covered = target.reached[tile] & ~target.contour[tile];
        target.reached[tile] = covered;
        float* const values = target.values + tile * kTilePixels;
        for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) {
            const auto mask = masks::mask_from_bits(d, covered >> i & ((1u << hn::Lanes(d)) - 1));
            hn::Store(hn::IfThenElse(mask, hn::Load(d, values + i), uncovered), d, values + i);
        }
    }
}

}  // namespace
}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::occlude {

HWY_EXPORT(draw_triangle);

void draw_triangle_kernel(const PatchTriangle& triangle, const PatchTarget& target) {
    HWY_DYNAMIC_DISPATCH(draw_triangle)(triangle, target);
}

HWY_EXPORT(draw_contour);

void draw_contour_kernel(const PatchEdge& edge, const PatchTarget& target) {
    HWY_DYNAMIC_DISPATCH(draw_contour)(edge, target);
}

HWY_EXPORT(finish_patch);

void finish_patch_kernel(const PatchTarget& target, std::size_t tiles) {
    HWY_DYNAMIC_DISPATCH(finish_patch)(target, tiles);
}

}  // namespace crofton::occlude
#endif
