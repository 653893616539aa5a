// SPDX-License-Identifier: MIT
// One triangle against the tiles: may it own a sample, and which samples does it surely cover? Compiled once per
// instruction set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cmath>
#include <cstdint>

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

struct Raster {
    static constexpr std::size_t kMaxEdges = 5;

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
        const bool large = r_.x1 - r_.x0 >= 16 || r_.y1 - r_.y0 >= 16;
        for (std::int32_t ty = r_.y0 / 8; ty <= r_.y1 / 8; ++ty)
            for (std::int32_t tx = r_.x0 / 8; tx <= r_.x1 / 8; ++tx) {
                const std::size_t t = static_cast<std::size_t>(ty) * tiles_.columns + static_cast<std::size_t>(tx);
                if (tiles_.least[t] > r_.nearest) continue;
                if (least_of(tiles_, t) > r_.nearest) continue;
                if (large && draw_whole(tx, ty, t)) continue;
                draw_part(tx, ty, t);
                if (!asks_ && !r_.draws) return visible_;
            }
        return visible_;
    }

  private:
    // Where the tile is wholly outside, or wholly inside and the triangle is not steep there.
    HWY_INLINE bool draw_whole(std::int32_t tx, std::int32_t ty, std::size_t t) {
        const float left = static_cast<float>(8 * tx) + 0.5f, bottom = static_cast<float>(8 * ty) + 0.5f;
        bool inside = true;
        for (std::size_t k = 0; k < r_.edge_count; ++k) {
            const Edge& e = r_.edges[k];
            const float corner = (e.across * (left - e.at_x) + e.constant) + e.up * (bottom - e.at_y);
            const float l1 = std::abs(e.across) + std::abs(e.up);
            const float least = corner + 7.0f * (std::min(e.across, 0.0f) + std::min(e.up, 0.0f));
            const float most = corner + 7.0f * (std::max(e.across, 0.0f) + std::max(e.up, 0.0f));
            if (most < e.outer - l1 * 0x1p-8f) return true;
            inside = inside && least > e.inner + l1 * 0x1p-8f;
        }
        if (!inside || excluded_count_ != 0) return false;
        const float middle = (r_.base + r_.across * (left + 3.5f - r_.at_x)) + r_.up * (bottom + 3.5f - r_.at_y);
        const float spread = 3.5f * (std::abs(r_.across) + std::abs(r_.up));
        if (!(spread < 0.03125f * std::abs(middle - far_))) return false;
        if (asks_ && !visible_) {
            if (std::min(middle + spread + r_.above, r_.nearest) >= tiles_.least[t]) {
                draw_rows(tx, ty, t, false);
            }
        }
        if (r_.draws) raise_floor(tiles_, t, std::max(middle - spread - r_.below, r_.farthest));
        return true;
    }

    HWY_INLINE void draw_part(std::int32_t tx, std::int32_t ty, std::size_t t) { draw_rows(tx, ty, t, r_.draws); }

    HWY_INLINE void draw_rows(std::int32_t tx, std::int32_t ty, std::size_t t, bool draws) {
        const DF d;
        if (tiles_.states[t] == TileState::unused)
            begin_tile(tiles_, static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty), t);
        float* const pixels = tiles_.pixels + t * kTilePixels;
        const VF floor = hn::Set(d, tiles_.floors[t]);
        const std::int32_t first = std::max(r_.y0, 8 * ty), last = std::min(r_.y1, 8 * ty + 7);
        bool wrote = false;
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF x = hn::Iota(d, static_cast<float>(8 * tx) + 0.5f + static_cast<float>(i));
            VF at_x[Raster::kMaxEdges];
            for (std::size_t k = 0; k < r_.edge_count; ++k) {
                const Edge& e = r_.edges[k];
                at_x[k] =
                    hn::Add(hn::Mul(hn::Set(d, e.across), hn::Sub(x, hn::Set(d, e.at_x))), hn::Set(d, e.constant));
            }
            const VF depth_at_x =
                hn::Add(hn::Set(d, r_.base), hn::Mul(hn::Set(d, r_.across), hn::Sub(x, hn::Set(d, r_.at_x))));
            for (std::int32_t row = first; row <= last; ++row) {
                const float y = static_cast<float>(row) + 0.5f;
                auto inner = hn::MaskFromVec(hn::Zero(d)), outer = inner;
                for (std::size_t k = 0; k < r_.edge_count; ++k) {
                    const Edge& e = r_.edges[k];
                    const VF value = hn::Add(at_x[k], hn::Set(d, e.up * (y - e.at_y)));
                    const auto in = hn::Ge(value, hn::Set(d, e.inner)), out = hn::Ge(value, hn::Set(d, e.outer));
                    inner = k == 0 ? in : hn::And(inner, in);
                    outer = k == 0 ? out : hn::And(outer, out);
                }
                if (hn::AllFalse(d, outer)) continue;
                const VF depth = hn::Add(depth_at_x, hn::Set(d, r_.up * (y - r_.at_y)));
                float* const at = pixels + static_cast<std::size_t>(row - 8 * ty) * kTile + i;
                const VF before = hn::Max(hn::Load(d, at), floor);
                if (asks_ && !visible_) {
                    const VF upper = hn::Min(hn::Add(depth, hn::Set(d, r_.above)), hn::Set(d, r_.nearest));
                    visible_ = !hn::AllFalse(d, hn::And(outer, hn::Ge(upper, before)));
                }
                if (!draws) {
                    if (visible_) return;
                    continue;
                }
                if (excluded_count_ != 0) inner = without_excluded(inner, x, y);
                const VF lower = hn::Max(hn::Sub(depth, hn::Set(d, r_.below)), hn::Set(d, r_.farthest));
                const auto writes = hn::And(inner, hn::Gt(lower, before));
                if (hn::AllFalse(d, writes)) continue;
                hn::Store(hn::IfThenElse(writes, lower, hn::Load(d, at)), d, at);
                wrote = true;
            }
        }
        if (wrote) tiles_.states[t] = TileState::changed;
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
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
