// SPDX-License-Identifier: MIT
// One triangle against the tiles: may it own a sample, and which samples does it surely cover? Compiled once per
// instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "tiles-inl.hpp"

#if defined(CROFTON_DEPTH_RASTER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_RASTER_INL
#undef CROFTON_DEPTH_RASTER_INL
#else
#define CROFTON_DEPTH_RASTER_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// across · (x − at_x) + constant + up · (y − at_y), positive inside. Two triangles that share an edge have the same
// numbers but for the sign of `across`, `constant` and `up`, and get the same value but for the sign.
struct Edge {
    float across, up, constant, at_x, at_y;
    float inner;  // samples with at least this are surely inside
    float outer;  // those with less are surely outside
};

// Inside everywhere.
inline constexpr Edge kEverywhere{
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

struct Raster {
    static constexpr std::size_t kMaxEdges = 6;

    // At least three; where there are more than four, those beyond edge_count are kEverywhere.
    Edge edges[kMaxEdges];
    std::uint32_t edge_count;
    std::int32_t x0, y0, x1, y1;         // samples; within the picture
    float across, up, at_x, at_y, base;  // nearness = base + across · (x − at_x) + up · (y − at_y)
    float below;                         // the picture's nearness is at most this much less
    float above;                         // and at most this much more
    float farthest;                      // and never less than this, nor more than `nearest`
    float nearest;
    bool asks;  // whether it may own a sample is to be found out
    bool draws;
};

class Rasterizer {
  public:
    Rasterizer(const PictureData& picture, const Raster& raster, const std::uint32_t* excluded,
               std::uint32_t excluded_count)
        : tiles_(picture.tiles),
          far_(picture.infinitely_far),
          r_(raster),
          excluded_(excluded),
          excluded_count_(excluded_count),
          asks_(raster.asks) {}

    // True if a sample may be the triangle's.
    HWY_INLINE bool run() {
        if (is_wide()) set_slopes();
        const std::int32_t last_row = r_.y1 / 8;
        for (std::int32_t ty = r_.y0 / 8; ty <= last_row; ++ty) {
            draw_tile_row(ty);
            if (is_done()) break;
        }
        return visible_;
    }

  private:
    // More tiles wide than are worth asking one by one.
    [[nodiscard]] HWY_INLINE bool is_wide() const { return r_.x1 / 8 - r_.x0 / 8 > kNarrow; }
    static constexpr std::int32_t kNarrow = 1;

    struct Interval {
        std::int32_t first, last;  // empty where first > last
    };

    // Of an edge: columns per unit, 0 where it lies along the row; a share of a pixel, in its unit.
    struct Slopes {
        float per_across, slack;
    };
    HWY_INLINE void set_slopes() {
        for (std::size_t k = 0; k < r_.edge_count; ++k) {
            const Edge& e = r_.edges[k];
            const float l1 = std::abs(e.across) + std::abs(e.up);
            slopes_[k] = {std::abs(e.across) < l1 * 0x1p-12f ? 0.0f : 1.0f / e.across, l1 * 0x1p-6f};
        }
    }

    // Nothing is left to find out or to draw.
    [[nodiscard]] HWY_INLINE bool is_done() const { return !r_.draws && (visible_ || !asks_); }

    HWY_INLINE void draw_tile_row(std::int32_t ty) {
        Interval touched{r_.x0 / 8, r_.x1 / 8}, whole{1, 0};
        if (is_wide()) find_intervals(ty, touched, whole);
        for (std::int32_t tx = touched.first; tx <= touched.last; ++tx) {
            if (tx == whole.first && whole.last >= whole.first) {
                draw_whole(whole, ty);
                tx = whole.last;
            } else {
                draw_part(tx, ty);
            }
            if (is_done()) return;
        }
    }

    // The tiles of a row that the triangle may touch, and those within that it surely covers.
    HWY_INLINE void find_intervals(std::int32_t ty, Interval& touched, Interval& whole) {
        const float bottom = static_cast<float>(8 * ty) + 0.5f;
        // Samples' columns, relative to the first at 0.5: floats of this size are exact to far less than the margins.
        auto low = static_cast<float>(r_.x0), high = static_cast<float>(r_.x1);
        float inner_low = low, inner_high = high;
        bool inside = r_.y0 <= 8 * ty && r_.y1 >= 8 * ty + 7;
        for (std::uint32_t k = 0; k < r_.edge_count; ++k) {
            const Edge& e = r_.edges[k];
            const float y0 = e.up * (bottom - e.at_y), y1 = e.up * (bottom + 7.0f - e.at_y);
            const float slack = slopes_[k].slack;
            const float most = e.constant + std::max(y0, y1) - e.outer + slack;
            const float least = e.constant + std::min(y0, y1) - e.inner - slack;
            const float origin = e.at_x - 0.5f;
            // All samples of the row's tiles are inside: none needs to ask.
            const float x0 = e.across * (static_cast<float>(r_.x0 / 8 * 8) - origin);
            const float x1 = e.across * (static_cast<float>(r_.x1 / 8 * 8 + 7) - origin);
            if (least + std::min(x0, x1) > 0.0f) continue;
            const float inverse = slopes_[k].per_across;
            if (inverse == 0.0f) {
                // Along the row: no column tells apart, but for what a picture's width makes of it.
                const float change = std::abs(e.across) * (static_cast<float>(tiles_.width) + std::abs(origin));
                if (most + change < 0.0f) touched.last = touched.first - 1;
                inside = inside && least - change > 0.0f;
                continue;
            }
            const float outer_end = origin - most * inverse, inner_end = origin - least * inverse;
            if (e.across > 0.0f) {
                low = std::max(low, outer_end), inner_low = std::max(inner_low, inner_end);
            } else {
                high = std::min(high, outer_end), inner_high = std::min(inner_high, inner_end);
            }
        }
        // A sample on either side for the rounding of these ends.
        touched.first = std::max(touched.first, static_cast<std::int32_t>(low - 1.0f) / 8);
        touched.last =
            high < low - 2.0f ? touched.first - 1 : std::min(touched.last, static_cast<std::int32_t>(high + 1.0f) / 8);
        if (!inside || inner_high < inner_low || has_excluded(ty)) return;
        whole.first = std::max(touched.first, (static_cast<std::int32_t>(inner_low) + 1 + 7) / 8);
        whole.last = std::min(touched.last, static_cast<std::int32_t>(inner_high) / 8 - 1);
    }

    [[nodiscard]] HWY_INLINE bool has_excluded(std::int32_t ty) const {
        for (std::uint32_t i = 0; i < excluded_count_; ++i)
            if (static_cast<std::int32_t>(excluded_[i] >> 16) / 8 == ty) return true;
        return false;
    }

    // Tiles that the triangle covers: where it is not steep, a floor is enough.
    HWY_INLINE void draw_whole(const Interval& whole, std::int32_t ty) {
        const DF d;
        const float up = r_.base + r_.up * (static_cast<float>(8 * ty) + 4.0f - r_.at_y);
        const float spread = 3.5f * (std::abs(r_.across) + std::abs(r_.up));
        const std::size_t row = static_cast<std::size_t>(ty) * tiles_.columns;
        for (std::int32_t tx = whole.first; tx <= whole.last; ++tx) {
            if (!asks_ || visible_) break;
            const std::size_t t = row + static_cast<std::size_t>(tx);
            const float middle = up + r_.across * (static_cast<float>(8 * tx) + 4.0f - r_.at_x);
            if (std::min(middle + spread + r_.above, r_.nearest) >= least_of(tiles_, t)) draw_rows(tx, ty, t, false);
        }
        if (!r_.draws) return;
        for (std::int32_t tx = whole.first; tx <= whole.last; tx += static_cast<std::int32_t>(hn::Lanes(d))) {
            const auto count = std::min<std::size_t>(hn::Lanes(d), static_cast<std::size_t>(whole.last - tx) + 1);
            const std::size_t t = row + static_cast<std::size_t>(tx);
            const VF x = steps_from(static_cast<float>(tx));
            const VF from = hn::Sub(hn::Add(hn::Mul(x, hn::Set(d, 8.0f)), hn::Set(d, 4.0f)), hn::Set(d, r_.at_x));
            const VF middle = hn::Add(hn::Set(d, up), hn::Mul(hn::Set(d, r_.across), from));
            const VF lower =
                hn::Max(hn::Sub(hn::Sub(middle, hn::Set(d, spread)), hn::Set(d, r_.below)), hn::Set(d, r_.farthest));
            const VF far = hn::Abs(hn::Sub(middle, hn::Set(d, far_)));
            const auto within = hn::FirstN(d, count);
            const auto flat = hn::And(within, hn::Lt(hn::Set(d, spread), hn::Mul(far, hn::Set(d, 0.03125f))));
            // The lists are padded by a vector.
            const VF floors = hn::LoadU(d, tiles_.floors + t), least = hn::LoadU(d, tiles_.least + t);
            hn::StoreU(hn::IfThenElse(flat, hn::Max(floors, lower), floors), d, tiles_.floors + t);
            hn::StoreU(hn::IfThenElse(flat, hn::Max(least, lower), least), d, tiles_.least + t);
            if (hn::CountTrue(d, flat) == count) continue;
            alignas(32) float steep[kTile];
            hn::Store(hn::IfThenElse(flat, hn::Zero(d), hn::Set(d, 1.0f)), d, steep);
            for (std::size_t i = 0; i < count; ++i)
                if (steep[i] != 0.0f) draw_part(tx + static_cast<std::int32_t>(i), ty);
        }
    }

    HWY_INLINE void draw_part(std::int32_t tx, std::int32_t ty) {
        const std::size_t t = static_cast<std::size_t>(ty) * tiles_.columns + static_cast<std::size_t>(tx);
        const float middle = (r_.base + r_.across * (static_cast<float>(8 * tx) + 4.0f - r_.at_x)) +
                             r_.up * (static_cast<float>(8 * ty) + 4.0f - r_.at_y);
        const float spread = 3.5f * (std::abs(r_.across) + std::abs(r_.up));
        const float upper = std::min(r_.nearest, middle + spread + r_.above + r_.below);
        if (is_nearer(tiles_, t, upper)) return;
        draw_rows(tx, ty, t, r_.draws);
    }

    HWY_INLINE void draw_rows(std::int32_t tx, std::int32_t ty, std::size_t t, bool draws) {
        // Alike for all tiles of a triangle: what the processor guesses is right then.
        if (r_.edge_count <= 3)
            draw_rows_of<3>(tx, ty, t, draws);
        else if (r_.edge_count == 4)
            draw_rows_of<4>(tx, ty, t, draws);
        else
            draw_rows_of<Raster::kMaxEdges>(tx, ty, t, draws);
    }

    // kEdges: at least how many there are.
    template <std::size_t kEdges>
    HWY_INLINE void draw_rows_of(std::int32_t tx, std::int32_t ty, std::size_t t, bool draws) {
        const DF d;
        if (tiles_.states[t] == TileState::unused)
            begin_tile(tiles_, static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty), t);
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF y = steps_from(static_cast<float>(8 * ty) + 0.5f + static_cast<float>(i));
            hn::Store(hn::Mul(hn::Set(d, r_.up), hn::Sub(y, hn::Set(d, r_.at_y))), d, depth_ups_ + i);
            for (std::size_t k = 0; k < kEdges; ++k) {
                const Edge& e = r_.edges[k];
                hn::Store(hn::Mul(hn::Set(d, e.up), hn::Sub(y, hn::Set(d, e.at_y))), d, ups_[k] + i);
            }
        }
        const std::int32_t first = std::max(r_.y0 - 8 * ty, 0), last = std::min(r_.y1 - 8 * ty, 7);
        if (asks_ && !visible_) {
            visible_ = shows_in_rows<kEdges>(tx, t, first, last);
            // Nor is it nearer than the tile anywhere then.
            if (!visible_) return;
        }
        if (draws && write_rows<kEdges>(tx, ty, t, first, last)) tiles_.states[t] = TileState::changed;
    }

    // The edges and the plane along eight columns.
    template <std::size_t kEdges>
    struct Columns {
        VF edges[kEdges], depth;
    };
    template <std::size_t kEdges>
    HWY_INLINE Columns<kEdges> columns_at(VF x) const {
        const DF d;
        Columns<kEdges> at;
        for (std::size_t k = 0; k < kEdges; ++k) {
            const Edge& e = r_.edges[k];
            at.edges[k] =
                hn::Add(hn::Mul(hn::Set(d, e.across), hn::Sub(x, hn::Set(d, e.at_x))), hn::Set(d, e.constant));
        }
        at.depth = hn::Add(hn::Set(d, r_.base), hn::Mul(hn::Set(d, r_.across), hn::Sub(x, hn::Set(d, r_.at_x))));
        return at;
    }
    // Whether a sample may be the triangle's.
    template <std::size_t kEdges>
    HWY_INLINE bool shows_in_rows(std::int32_t tx, std::size_t t, std::int32_t first, std::int32_t last) const {
        const DF d;
        const float* const pixels = tiles_.pixels + t * kTilePixels;
        const VF floor = hn::Set(d, tiles_.floors[t]);
        const VF above = hn::Set(d, r_.above), nearest = hn::Set(d, r_.nearest);
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const auto at = columns_at<kEdges>(steps_from(static_cast<float>(8 * tx) + 0.5f + static_cast<float>(i)));
            for (auto row = static_cast<std::size_t>(first); row <= static_cast<std::size_t>(last); ++row) {
                const VF before = hn::Max(hn::Load(d, pixels + row * kTile + i), floor);
                const VF depth = hn::Add(at.depth, hn::Set(d, depth_ups_[row]));
                auto shows = hn::Ge(hn::Min(hn::Add(depth, above), nearest), before);
                for (std::size_t k = 0; k < kEdges; ++k) {
                    const VF value = hn::Add(at.edges[k], hn::Set(d, ups_[k][row]));
                    shows = hn::And(shows, hn::Ge(value, hn::Set(d, r_.edges[k].outer)));
                }
                if (!hn::AllFalse(d, shows)) return true;
            }
        }
        return false;
    }

    // True if it wrote.
    template <std::size_t kEdges>
    HWY_INLINE bool write_rows(std::int32_t tx, std::int32_t ty, std::size_t t, std::int32_t first,
                               std::int32_t last) const {
        const DF d;
        float* const pixels = tiles_.pixels + t * kTilePixels;
        const VF floor = hn::Set(d, tiles_.floors[t]);
        const VF below = hn::Set(d, r_.below), farthest = hn::Set(d, r_.farthest);
        const std::uint32_t excluded = excluded_rows(tx, ty);
        VF inner_at[kEdges];
        for (std::size_t k = 0; k < kEdges; ++k) inner_at[k] = hn::Set(d, r_.edges[k].inner);
        auto wrote = hn::FirstN(d, 0);
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF x = steps_from(static_cast<float>(8 * tx) + 0.5f + static_cast<float>(i));
            const auto at = columns_at<kEdges>(x);
            for (auto row = static_cast<std::size_t>(first); row <= static_cast<std::size_t>(last); ++row) {
                float* const pixel = pixels + row * kTile + i;
                const VF before = hn::Load(d, pixel);
                const VF depth = hn::Add(at.depth, hn::Set(d, depth_ups_[row]));
                const VF lower = hn::Max(hn::Sub(depth, below), farthest);
                auto writes = hn::Gt(lower, hn::Max(before, floor));
                for (std::size_t k = 0; k < kEdges; ++k)
                    writes = hn::And(writes, hn::Ge(hn::Add(at.edges[k], hn::Set(d, ups_[k][row])), inner_at[k]));
                if ((excluded >> row & 1) != 0)
                    writes = without_excluded(writes, x, static_cast<float>(8 * ty + static_cast<int>(row)) + 0.5f);
                hn::Store(hn::IfThenElse(writes, lower, before), d, pixel);
                wrote = hn::Or(wrote, writes);
            }
        }
        return !hn::AllFalse(d, wrote);
    }

    // The rows of a tile that have excluded samples, one bit each.
    [[nodiscard]] HWY_INLINE std::uint32_t excluded_rows(std::int32_t tx, std::int32_t ty) const {
        const std::uint32_t tile = static_cast<std::uint32_t>(8 * ty) << 16 | static_cast<std::uint32_t>(8 * tx);
        std::uint32_t rows = 0;
        for (std::uint32_t i = 0; i < excluded_count_; ++i)
            if ((excluded_[i] & 0xfff8fff8u) == tile) rows |= 1u << (excluded_[i] >> 16 & 7);
        return rows;
    }

    HWY_INLINE hn::Mask<DF> without_excluded(hn::Mask<DF> mask, VF x, float y) const {
        const DF d;
        for (std::uint32_t i = 0; i < excluded_count_; ++i) {
            if (static_cast<float>(excluded_[i] >> 16) + 0.5f != y) continue;
            mask = hn::And(mask, hn::Ne(x, hn::Set(d, static_cast<float>(excluded_[i] & 0xffff) + 0.5f)));
        }
        return mask;
    }

    const Tiles& tiles_;
    float far_;
    const Raster& r_;
    const std::uint32_t* excluded_;  // samples that no triangle is drawn to: row · 2^16 + column
    std::uint32_t excluded_count_;
    bool asks_;
    bool visible_ = false;
    Slopes slopes_[Raster::kMaxEdges];
    alignas(32) float ups_[Raster::kMaxEdges][kTile];  // of those edges, and of the plane: up · (y − at_y) by row
    alignas(32) float depth_ups_[kTile];
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
