// SPDX-License-Identifier: MIT
// The nearness of a picture in tiles of 8 × 8 pixels, and tests of rectangles against it. Compiled once per instruction
// set (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"

#if defined(CROFTON_DEPTH_TILES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_DEPTH_TILES_INL
#undef CROFTON_DEPTH_TILES_INL
#else
#define CROFTON_DEPTH_TILES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::depth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes at most, so that a vector never holds more than a row of a tile.
using DF = hn::CappedTag<float, kTile>;
using VF = hn::Vec<DF>;

// first, first + 1, …; loaded, as hn::Iota stores lane by lane what it then waits for.
HWY_INLINE VF steps_from(float first) {
    alignas(32) static constexpr float kSteps[kTile] = {0, 1, 2, 3, 4, 5, 6, 7};
    const DF d;
    return hn::Add(hn::Set(d, first), hn::Load(d, kSteps));
}

HWY_INLINE void begin_tile(const Tiles& tiles, std::uint32_t tx, std::uint32_t ty, std::size_t t) {
    const DF d;
    float* const pixels = tiles.pixels + t * kTilePixels;
    for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) hn::Store(hn::Set(d, kNothing), d, pixels + i);
    tiles.written[t] = 1;
    const std::uint32_t columns = std::min(kTile, tiles.width - tx * kTile);
    const std::uint32_t rows = std::min(kTile, tiles.height - ty * kTile);
    if (columns == kTile && rows == kTile) return;
    for (std::uint32_t y = 0; y < kTile; ++y)
        for (std::uint32_t x = y < rows ? columns : 0; x < kTile; ++x)
            pixels[y * kTile + x] = std::numeric_limits<float>::infinity();
}

// The least nearness in the tile.
HWY_INLINE float least_of(const Tiles& tiles, std::size_t t) {
    const DF d;
    const float* const pixels = tiles.pixels + t * kTilePixels;
    VF least = hn::Load(d, pixels);
    for (std::size_t i = hn::Lanes(d); i < kTilePixels; i += hn::Lanes(d))
        least = hn::Min(least, hn::Load(d, pixels + i));
    return std::max(hn::GetLane(hn::MinOfLanes(d, least)), tiles.floors[t]);
}

// A pixel of the rectangle is not nearer than `nearness`. The rectangle meets the tile.
HWY_INLINE bool shows_in_tile(const Tiles& tiles, const Projection& p, std::int32_t tx, std::int32_t ty,
                              std::size_t t) {
    const DF d;
    const std::int32_t left = tx * 8, bottom = ty * 8;
    const VF nearest = hn::Set(d, p.nearest);
    const VF first = hn::Set(d, static_cast<float>(p.x0 - left)), last = hn::Set(d, static_cast<float>(p.x1 - left));
    const std::int32_t end = std::min(p.y1 - bottom, 7);
    for (std::int32_t y = std::max(p.y0 - bottom, 0); y <= end; ++y)
        for (std::size_t x = 0; x < kTile; x += hn::Lanes(d)) {
            const VF column = steps_from(static_cast<float>(x));
            const auto within = hn::And(hn::Ge(column, first), hn::Le(column, last));
            const VF pixels = hn::Load(d, tiles.pixels + t * kTilePixels + static_cast<std::size_t>(y) * kTile + x);
            if (!hn::AllFalse(d, hn::And(within, hn::Le(pixels, nearest)))) return true;
        }
    return false;
}

// Whether a tile leaves the rectangle, which meets it, a chance to show.
HWY_INLINE bool may_show_in_tile(const Tiles& tiles, const Projection& p, std::int32_t tx, std::int32_t ty,
                                 std::size_t t) {
    if (tiles.least[t] > p.nearest) return false;
    if (tiles.written[t] == 0) return true;
    if (p.x0 <= 8 * tx && p.y0 <= 8 * ty && p.x1 >= 8 * tx + 7 && p.y1 >= 8 * ty + 7) return true;
    return shows_in_tile(tiles, p, tx, ty, t);
}

// True if all samples of the rectangle that the tiles have are nearer.
HWY_INLINE bool hides(const Tiles& tiles, const Projection& p) {
    const DF d;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
    const VF nearest = hn::Set(d, p.nearest);
    const std::int32_t first = std::max<std::int32_t>(p.x0, tiles.first_x) / 8;
    const std::int32_t last = std::min<std::int32_t>(p.x1, tiles.last_x) / 8;
    for (std::int32_t ty = p.y0 / 8; ty <= p.y1 / 8; ++ty) {
        const std::size_t row = static_cast<std::size_t>(ty) * tiles.columns;
        for (std::int32_t from = first; from <= last; from += lanes) {
            const std::int32_t count = std::min(lanes, last - from + 1);
            // The list is padded by a vector.
            const auto nearer = hn::Gt(hn::LoadU(d, tiles.least + row + static_cast<std::size_t>(from)), nearest);
            if (hn::AllFalse(d, hn::AndNot(nearer, hn::FirstN(d, static_cast<std::size_t>(count))))) continue;
            for (std::int32_t tx = from; tx < from + count; ++tx)
                if (may_show_in_tile(tiles, p, tx, ty, row + static_cast<std::size_t>(tx))) return false;
        }
    }
    return true;
}

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
