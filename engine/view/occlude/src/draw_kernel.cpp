// SPDX-License-Identifier: MIT
#include "draw_kernel.hpp"

#include <algorithm>

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

// Eight lanes at most, so that a vector never holds more than a row of a tile.
using DT = hn::CappedTag<float, kTile>;
using VT = hn::Vec<DT>;

// The columns [begin, end) that a body covers, in each row of a tile row.
struct Spans {
    alignas(32) std::int32_t begin[kTile], end[kTile];
    std::int32_t first, last;                // of any row: columns [first, last)
    std::int32_t common_first, common_last;  // of all rows
};

// No operation is contracted, so every target gives the same bits.
class BodyDrawer {
  public:
    BodyDrawer(const DrawBody& body, const DrawTarget& target) : body_(body), target_(target) {
        const DT d;
        const PreparedBody& b = *body.body;
        plane_count_ = b.plane_count;
        for (std::size_t p = 0; p < plane_count_; ++p) {
            const DepthPlane& plane = body.planes[p];
            rises_[p] = 8.0f * (std::max(plane.across, 0.0f) + std::max(plane.up, 0.0f)) -
                        (std::min(plane.across, 0.0f) + std::min(plane.up, 0.0f));
            const VT across = hn::Set(d, plane.across), up = hn::Set(d, plane.up);
            for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) {
                const VT column = hn::Iota(d, static_cast<float>(i % kTile));
                const VT row = hn::Set(d, static_cast<float>(i / kTile));
                hn::Store(hn::Add(hn::Mul(across, column), hn::Mul(up, row)), d, steps_[p] + i);
            }
        }
    }

    void run() {
        const PreparedBody& b = *body_.body;
        const std::uint32_t first = std::max(b.first_row / kTile, target_.first_tile_row);
        const std::uint32_t end = std::min((b.end_row + kTile - 1) / kTile, target_.end_tile_row);
        for (std::uint32_t row = first; row < end; ++row) draw_tile_row(row);
    }

  private:
    void draw_tile_row(std::uint32_t row) {
        Spans spans;
        if (!find_spans(row, spans)) return;
        if (spans.first >= spans.last) return;
        const std::size_t at = std::size_t{row - target_.first_tile_row} * target_.tile_columns;
        const auto last = static_cast<std::uint32_t>(spans.last - 1) / kTile;
        for (std::uint32_t column = static_cast<std::uint32_t>(spans.first) / kTile; column <= last; ++column) {
            if (target_.least[at + column] >= body_.body->most_nearness) continue;
            const std::uint64_t mask = mask_of(spans, static_cast<std::int32_t>(column * kTile));
            if (mask == 0) continue;
            target_.covers[at + column].add(mask, body_.place);
            float* const pixels = target_.pixels + (at + column) * kTilePixels;
            set_bases(static_cast<float>(column * kTile), static_cast<float>(row * kTile));
            const float front = nearest();
            target_.front[at + column] = std::max(target_.front[at + column], front);
            if (front <= target_.least[at + column]) continue;  // all that is there is nearer
            target_.least[at + column] = ~mask == 0 ? draw_whole(pixels) : draw_part(pixels, mask);
        }
    }

    // Rows outside of the body's get empty spans.
    bool find_spans(std::uint32_t tile_row, Spans& spans) const {
        const DT d;
        const hn::RebindToSigned<DT> di;
        const PreparedBody& b = *body_.body;
        const VT most = hn::Set(d, static_cast<float>(target_.width));
        bool any = false;
        VT first = most, last = hn::Zero(d), common_first = last, common_last = most;
        for (std::size_t r = 0; r < kTile; r += hn::Lanes(d)) {
            const VT row = hn::Iota(d, static_cast<float>(tile_row * kTile + r));
            VT left = hn::Zero(d), right = most;
            for (std::size_t s = 0; s < b.left_count; ++s) left = hn::Max(left, column_of(body_.sides[s], row));
            for (std::size_t s = 0; s < b.right_count; ++s)
                right = hn::Min(right, column_of(body_.sides[b.left_count + s], row));
            const auto outside = hn::Or(hn::Lt(row, hn::Set(d, static_cast<float>(b.first_row))),
                                        hn::Ge(row, hn::Set(d, static_cast<float>(b.end_row))));
            right = hn::IfThenElse(outside, hn::Zero(d), hn::Max(right, hn::Zero(d)));
            left = hn::Min(left, most);
            any = any || !hn::AllTrue(d, hn::Ge(left, right));
            left = hn::Ceil(left);
            right = hn::Floor(right);
            first = hn::Min(first, left);
            last = hn::Max(last, right);
            common_first = hn::Max(common_first, left);
            common_last = hn::Min(common_last, right);
            hn::Store(hn::ConvertTo(di, left), di, spans.begin + r);
            hn::Store(hn::ConvertTo(di, right), di, spans.end + r);
        }
        spans.first = static_cast<std::int32_t>(hn::GetLane(hn::MinOfLanes(d, first)));
        spans.last = static_cast<std::int32_t>(hn::GetLane(hn::MaxOfLanes(d, last)));
        spans.common_first = static_cast<std::int32_t>(hn::GetLane(hn::MaxOfLanes(d, common_first)));
        spans.common_last = static_cast<std::int32_t>(hn::GetLane(hn::MinOfLanes(d, common_last)));
        return any;
    }

    static HWY_INLINE VT column_of(const Side& side, VT row) {
        const DT d;
        return hn::Add(hn::Set(d, side.x), hn::Mul(hn::Set(d, side.slope), hn::Sub(row, hn::Set(d, side.y))));
    }

    // Bit 8 r + c for row r, column c.
    static HWY_INLINE std::uint64_t mask_of(const Spans& spans, std::int32_t column) {
        if (spans.common_first <= column && spans.common_last >= column + 8) return ~std::uint64_t{0};
        std::uint64_t mask = 0;
        for (std::size_t r = 0; r < kTile; ++r) {
            const std::int32_t begin = std::clamp(spans.begin[r] - column, 0, 8);
            const std::int32_t end = std::clamp(spans.end[r] - column, 0, 8);
            const std::uint32_t bits = (0xffu << begin) & ~(0xffffffffu << end);
            mask |= std::uint64_t{bits & 0xffu} << (8 * r);
        }
        return mask;
    }

    HWY_INLINE void set_bases(float column, float row) {
        for (std::size_t p = 0; p < plane_count_; ++p) {
            const DepthPlane& plane = body_.planes[p];
            const float across = plane.across * column, up = plane.up * row;
            bases_[p] = (plane.base + across) + up;
        }
    }

    // Over the tile, for a convex body.
    HWY_INLINE float nearest() const {
        float nearest = bases_[0] + rises_[0];
        for (std::size_t p = 1; p < plane_count_; ++p) nearest = std::min(nearest, bases_[p] + rises_[p]);
        return nearest;
    }

    HWY_INLINE VT depth_at(std::size_t i) const {
        const DT d;
        VT depth = hn::Add(hn::Set(d, bases_[0]), hn::Load(d, steps_[0] + i));
        for (std::size_t p = 1; p < plane_count_; ++p)
            depth = hn::Min(depth, hn::Add(hn::Set(d, bases_[p]), hn::Load(d, steps_[p] + i)));
        return depth;
    }

    // Both return the least nearness of the tile's pixels after drawing.
    HWY_INLINE float draw_whole(float* pixels) const {
        const DT d;
        VT least = hn::Set(d, 3e38f);
        for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) {
            const VT depth = hn::Max(hn::Load(d, pixels + i), depth_at(i));
            hn::Store(depth, d, pixels + i);
            least = hn::Min(least, depth);
        }
        return hn::GetLane(hn::MinOfLanes(d, least));
    }
    HWY_INLINE float draw_part(float* pixels, std::uint64_t mask) const {
        const DT d;
        VT least = hn::Set(d, 3e38f);
        for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) {
            const VT before = hn::Load(d, pixels + i);
            const auto covered = simd::HWY_NAMESPACE::mask_from_bits(d, mask >> i & 0xffu);
            const VT depth = hn::IfThenElse(covered, hn::Max(before, depth_at(i)), before);
            hn::Store(depth, d, pixels + i);
            least = hn::Min(least, depth);
        }
        return hn::GetLane(hn::MinOfLanes(d, least));
    }

    const DrawBody& body_;
    const DrawTarget& target_;
    std::size_t plane_count_ = 0;
    float bases_[kMaxPlanes], rises_[kMaxPlanes];  // in a tile's first pixel; from there to the nearest point
    alignas(64) float steps_[kMaxPlanes][kTilePixels];
};

void draw_body(const DrawBody& body, const DrawTarget& target) {
    BodyDrawer(body, target).run();
}

}  // namespace
}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::occlude {

HWY_EXPORT(draw_body);

void draw_body_kernel(const DrawBody& body, const DrawTarget& target) {
    HWY_DYNAMIC_DISPATCH(draw_body)(body, target);
}

void clear_tile_row(float* pixels, float* least, std::uint32_t tile_columns, std::uint32_t width, std::uint32_t rows) {
    std::fill_n(pixels, std::size_t{tile_columns} * kTilePixels, kUncovered);
    std::fill_n(least, tile_columns, kUncovered);
    const std::uint32_t columns_in_last = width - (tile_columns - 1) * kTile;
    for (std::uint32_t c = rows < kTile ? 0 : tile_columns - 1; c < tile_columns; ++c)
        for (std::uint32_t i = 0; i < kTilePixels; ++i)
            if (i / kTile >= rows || (c + 1 == tile_columns && i % kTile >= columns_in_last))
                pixels[std::size_t{c} * kTilePixels + i] = 3e38f;
}

}  // namespace crofton::occlude
#endif
