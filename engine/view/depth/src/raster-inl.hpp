// SPDX-License-Identifier: MIT
// Tests one triangle against the tiles, and finds the samples that it surely covers. Compiled once per instruction set
// (Highway).
#include <hwy/highway.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/simd/mask_bits-inl.hpp>
#include <cstdint>
#include <limits>

#include "culler_data.hpp"
#include "faces-inl.hpp"
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

// Samples that nothing of a cluster is drawn to.
struct ExcludedSamples {
    static constexpr std::uint32_t kMax = 32;

    struct Sample {
        std::uint16_t x, y;
    };
    Sample samples[kMax];
    std::uint32_t count = 0;

    void add(std::int32_t x, std::int32_t y) {
        samples[count++] = {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
        columns_ |= bit_of(x / 8), rows_ |= bit_of(y / 8);
    }
    // False only if there is none in the tiles of that column or row.
    [[nodiscard]] bool may_be_in_column(std::int32_t tx) const { return (columns_ & bit_of(tx)) != 0; }
    [[nodiscard]] bool may_be_in_row(std::int32_t ty) const { return (rows_ & bit_of(ty)) != 0; }

  private:
    static std::uint64_t bit_of(std::int32_t tile) { return std::uint64_t{1} << (tile & 63); }

    std::uint64_t columns_ = 0, rows_ = 0;
};

// Holds, for eight rows, the samples between the lines and the part of the plane's depth that depends on the row.
struct Band {
    alignas(32) float low[kTile], high[kTile], ups[kTile];
};

class Rasterizer {
  public:
    Rasterizer(const Tiles& tiles, Band& band, float infinitely_far, const Faces& faces, std::uint32_t lane)
        : tiles_(tiles),
          band_(band),
          far_(infinitely_far),
          f_(faces),
          i_(lane),
          x0_(std::max(faces.x0[lane], tiles.first_x)),
          x1_(std::min(faces.x1[lane], tiles.last_x)),
          y0_(faces.y0[lane]),
          y1_(faces.y1[lane]),
          spread_(3.5f * (std::abs(faces.across[lane]) + std::abs(faces.up[lane]))) {}

    [[nodiscard]] HWY_INLINE bool covers_nothing() const { return x0_ > x1_ || y0_ > y1_; }

    // True if a sample may be the triangle's.
    HWY_INLINE bool shows() {
        if (shows_in_middle()) return true;
        Line lines[3];
        for (std::uint32_t k = 0; k < 3; ++k)
            lines[k] = {f_.per_row[k][i_], f_.at_y[k][i_], f_.ask_low[k][i_], f_.ask_high[k][i_]};
        for (std::int32_t first = x0_ / 8; first <= x1_ / 8; first += static_cast<std::int32_t>(hn::Lanes(DF())))
            if (shows_in_columns(first, lines)) return true;
        return false;
    }

    // Raises the tiles where the lines leave samples: they are surely covered.
    HWY_INLINE void draw(const Line* lines, std::uint32_t count, const ExcludedSamples& excluded) {
        // Of the whole triangle, so that what is drawn does not depend on which tiles are here.
        const bool wide = f_.x1[i_] / 8 - f_.x0[i_] / 8 > kNarrow;
        for (std::int32_t ty = y0_ / 8; ty <= y1_ / 8; ++ty) {
            find_band(ty, lines, count);
            at_row_ = plane_at_row(ty);
            spares_ = excluded.may_be_in_row(ty);
            Interval touched{x0_ / 8, x1_ / 8};
            if (!wide) {
                for (std::int32_t tx = touched.first; tx <= touched.last; ++tx) draw_part(tx, ty, excluded);
                continue;
            }
            touched = touched_tiles();
            if (touched.first > touched.last) continue;
            Interval whole{touched.last + 1, touched.last};
            if (y0_ <= 8 * ty && y1_ >= 8 * ty + 7 && !spares_) whole = whole_tiles(touched);
            for (std::int32_t tx = touched.first; tx < whole.first; ++tx) draw_part(tx, ty, excluded);
            if (whole.first > whole.last) continue;
            draw_whole(whole, ty, excluded);
            for (std::int32_t tx = whole.last + 1; tx <= touched.last; ++tx) draw_part(tx, ty, excluded);
        }
    }

    static constexpr std::uint32_t kMaxLines = 6;

  private:
    // More tiles wide than are worth asking one by one.
    static constexpr std::int32_t kNarrow = 1;

    struct Interval {
        std::int32_t first, last;  // empty where first > last
    };

    [[nodiscard]] HWY_INLINE float plane_at_row(std::int32_t ty) const {
        return f_.base[i_] + f_.up[i_] * (static_cast<float>(8 * ty) + 4.0f - f_.plane_y[i_]);
    }
    // In the middle of a tile.
    [[nodiscard]] HWY_INLINE float plane_at_column(float at_row, std::int32_t tx) const {
        return at_row + f_.across[i_] * (static_cast<float>(8 * tx) + 4.0f - f_.plane_x[i_]);
    }

    // True if a sample may be the triangle's in the tiles from column `first` on, as many as there are lanes.
    HWY_INLINE bool shows_in_columns(std::int32_t first, const Line (&lines)[3]) {
        const DF d;
        const auto last = std::min(static_cast<std::int32_t>(hn::Lanes(d)) - 1, x1_ / 8 - first);
        const std::uint32_t those = (2u << last) - 1;
        const VF x = hn::Add(hn::Mul(steps_from(static_cast<float>(first)), hn::Set(d, 8.0f)), hn::Set(d, 4.0f));
        const VF across = hn::Mul(hn::Set(d, f_.across[i_]), hn::Sub(x, hn::Set(d, f_.plane_x[i_])));
        const VF reach = hn::Set(d, spread_ + f_.above[i_]), nearest = hn::Set(d, f_.nearest[i_]);
        for (std::int32_t ty = y0_ / 8; ty <= y1_ / 8; ++ty) {
            const std::size_t at = static_cast<std::size_t>(ty) * tiles_.columns + static_cast<std::size_t>(first);
            const VF plane = hn::Add(hn::Set(d, plane_at_row(ty)), across);
            const VF most = hn::Min(hn::Add(plane, reach), nearest);
            // The list is padded by a vector.
            std::uint32_t left =
                those & ~simd::HWY_NAMESPACE::mask_bits(d, hn::Gt(hn::LoadU(d, tiles_.least + at), most));
            if (left != 0) find_band(ty, lines, 3);
            for (; left != 0; left &= left - 1) {
                const int i = std::countr_zero(left);
                if (meets_tile(first + i) && shows_in_tile(first + i, at + static_cast<std::size_t>(i))) return true;
            }
        }
        return false;
    }

    // The sample near the middle: most triangles that show do so there.
    [[nodiscard]] HWY_INLINE bool shows_in_middle() const {
        const float x = f_.middle_x[i_], y = f_.middle_y[i_];
        if (x < static_cast<float>(x0_) || x > static_cast<float>(x1_ + 1)) return false;
        const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
        const std::size_t t = std::size_t{row / 8} * tiles_.columns + column / 8;
        const float depth = (f_.base[i_] + f_.across[i_] * (x - f_.plane_x[i_])) + f_.up[i_] * (y - f_.plane_y[i_]);
        const float most = std::min(depth + f_.above[i_], f_.nearest[i_]);
        if (tiles_.floors[t] > most) return false;
        if (tiles_.written[t] != 0 && tiles_.pixels[t * kTilePixels + row % 8 * 8 + column % 8] > most) return false;
        bool inside = true;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const float from = f_.per_row[k][i_] * (y - f_.at_y[k][i_]);
            inside = inside && x >= f_.ask_low[k][i_] + from && x <= f_.ask_high[k][i_] + from;
        }
        return inside;
    }

    HWY_INLINE void find_band(std::int32_t ty, const Line* lines, std::uint32_t count) {
        const DF d;
        const VF first = hn::Set(d, static_cast<float>(x0_) + 0.5f), last = hn::Set(d, static_cast<float>(x1_) + 0.5f);
        const VF bottom = hn::Set(d, static_cast<float>(y0_)), top = hn::Set(d, static_cast<float>(y1_ + 1));
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF y = steps_from(static_cast<float>(8 * ty) + 0.5f + static_cast<float>(i));
            VF low = first, high = last;
            for (std::uint32_t k = 0; k < count; ++k) {
                const VF from = hn::Mul(hn::Set(d, lines[k].per_row), hn::Sub(y, hn::Set(d, lines[k].at_y)));
                low = hn::Max(low, hn::Add(hn::Set(d, lines[k].low), from));
                high = hn::Min(high, hn::Add(hn::Set(d, lines[k].high), from));
            }
            const auto within = hn::And(hn::Gt(y, bottom), hn::Lt(y, top));
            const VF infinity = hn::Set(d, std::numeric_limits<float>::infinity());
            hn::Store(hn::IfThenElse(within, low, infinity), d, band_.low + i);
            hn::Store(hn::IfThenElse(within, high, hn::Neg(infinity)), d, band_.high + i);
            hn::Store(hn::Mul(hn::Set(d, f_.up[i_]), hn::Sub(y, hn::Set(d, f_.plane_y[i_]))), d, band_.ups + i);
        }
        HWY_FENCE;  // Otherwise GCC permutes rows out of these vectors, by two instructions each: a load takes one.
    }

    static HWY_INLINE float least_of_rows(const float* rows) {
        const DF d;
        VF least = hn::Load(d, rows);
        for (std::size_t i = hn::Lanes(d); i < kTile; i += hn::Lanes(d)) least = hn::Min(least, hn::Load(d, rows + i));
        return hn::GetLane(hn::MinOfLanes(d, least));
    }
    static HWY_INLINE float most_of_rows(const float* rows) {
        const DF d;
        VF most = hn::Load(d, rows);
        for (std::size_t i = hn::Lanes(d); i < kTile; i += hn::Lanes(d)) most = hn::Max(most, hn::Load(d, rows + i));
        return hn::GetLane(hn::MaxOfLanes(d, most));
    }

    // Those with a sample between the lines.
    [[nodiscard]] HWY_INLINE Interval touched_tiles() const {
        const float first = least_of_rows(band_.low), last = most_of_rows(band_.high);
        if (!(first <= last)) return {1, 0};
        return {static_cast<std::int32_t>(first - 0.5f) / 8, static_cast<std::int32_t>(last - 0.5f) / 8};
    }

    // Those all of whose samples are between the lines: from 8 · first + 0.5 to 8 · last + 7.5.
    [[nodiscard]] HWY_INLINE Interval whole_tiles(const Interval& touched) const {
        const float first = std::min(most_of_rows(band_.low), static_cast<float>(8 * touched.last + 16));
        const float last = std::max(least_of_rows(band_.high), static_cast<float>(8 * touched.first));
        const Interval whole{(static_cast<std::int32_t>(std::ceil(first - 0.5f)) + 7) / 8,
                             (static_cast<std::int32_t>(std::floor(last + 0.5f))) / 8 - 1};
        if (whole.first > whole.last) return {touched.last + 1, touched.last};
        return whole;
    }

    [[nodiscard]] HWY_INLINE bool shows_in_tile(std::int32_t tx, std::size_t t) const {
        const DF d;
        const float* const pixels = tiles_.pixels + t * kTilePixels;
        const bool written = tiles_.written[t] != 0;
        const VF floor = hn::Set(d, tiles_.floors[t]);
        const VF above = hn::Set(d, f_.above[i_]), nearest = hn::Set(d, f_.nearest[i_]);
        auto shows = hn::FirstN(d, 0);
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF x = steps_from(static_cast<float>(8 * tx) + 0.5f + static_cast<float>(i));
            const VF depth = plane_at(x);
            for (std::size_t row = 0; row < kTile; ++row) {
                const VF before = written ? hn::Max(hn::Load(d, pixels + row * kTile + i), floor) : floor;
                const VF most = hn::Min(hn::Add(hn::Add(depth, hn::Set(d, band_.ups[row])), above), nearest);
                const auto within =
                    hn::And(hn::Ge(x, hn::Set(d, band_.low[row])), hn::Le(x, hn::Set(d, band_.high[row])));
                shows = hn::Or(shows, hn::And(within, hn::Ge(most, before)));
            }
        }
        return !hn::AllFalse(d, shows);
    }

    // The plane along a row of samples, but for the row's share.
    [[nodiscard]] HWY_INLINE VF plane_at(VF x) const {
        const DF d;
        return hn::Add(hn::Set(d, f_.base[i_]),
                       hn::Mul(hn::Set(d, f_.across[i_]), hn::Sub(x, hn::Set(d, f_.plane_x[i_]))));
    }

    // Tiles that the triangle covers: where it is not steep, a floor is enough.
    HWY_INLINE void draw_whole(const Interval& whole, std::int32_t ty, const ExcludedSamples& excluded) {
        const DF d;
        const VF up = hn::Set(d, at_row_), spread = hn::Set(d, spread_);
        const std::size_t row = static_cast<std::size_t>(ty) * tiles_.columns;
        for (std::int32_t tx = whole.first; tx <= whole.last; tx += static_cast<std::int32_t>(hn::Lanes(d))) {
            const auto count = std::min<std::size_t>(hn::Lanes(d), static_cast<std::size_t>(whole.last - tx) + 1);
            const std::size_t t = row + static_cast<std::size_t>(tx);
            const VF x = hn::Add(hn::Mul(steps_from(static_cast<float>(tx)), hn::Set(d, 8.0f)), hn::Set(d, 4.0f));
            const VF middle = hn::Add(up, hn::Mul(hn::Set(d, f_.across[i_]), hn::Sub(x, hn::Set(d, f_.plane_x[i_]))));
            const VF lower = hn::Sub(hn::Sub(middle, spread), hn::Set(d, f_.below[i_]));
            const VF far = hn::Abs(hn::Sub(middle, hn::Set(d, far_)));
            const auto within = hn::FirstN(d, count);
            const auto flat = hn::And(within, hn::Lt(spread, hn::Mul(far, hn::Set(d, 0x1p-5f))));
            // The lists are padded by a vector.
            const VF floors = hn::LoadU(d, tiles_.floors + t), least = hn::LoadU(d, tiles_.least + t);
            hn::StoreU(hn::IfThenElse(flat, hn::Max(floors, lower), floors), d, tiles_.floors + t);
            hn::StoreU(hn::IfThenElse(flat, hn::Max(least, lower), least), d, tiles_.least + t);
            if (hn::CountTrue(d, flat) == count) continue;
            alignas(32) float steep[kTile];
            hn::Store(hn::IfThenElse(flat, hn::Zero(d), hn::Set(d, 1.0f)), d, steep);
            for (std::size_t i = 0; i < count; ++i)
                if (steep[i] != 0.0f) draw_part(tx + static_cast<std::int32_t>(i), ty, excluded);
        }
    }

    HWY_INLINE void draw_part(std::int32_t tx, std::int32_t ty, const ExcludedSamples& excluded) {
        const std::size_t t = static_cast<std::size_t>(ty) * tiles_.columns + static_cast<std::size_t>(tx);
        if (tiles_.least[t] > plane_at_column(at_row_, tx) + spread_) return;  // nothing to raise
        if (!meets_tile(tx)) return;
        const bool spares = spares_ && excluded.may_be_in_column(tx);
        if (tiles_.written[t] == 0) {
            if (!spares && is_whole(tx, ty)) {
                tiles_.written[t] = 1;
                return write_tile<true>(tx, t);
            }
            begin_tile(tiles_, static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty), t);
        }
        if (!spares) return write_tile<false>(tx, t);
        float before[ExcludedSamples::kMax];
        std::uint8_t places[ExcludedSamples::kMax];
        std::uint32_t count = 0;
        float* const pixels = tiles_.pixels + t * kTilePixels;
        for (std::uint32_t k = 0; k < excluded.count; ++k) {
            const ExcludedSamples::Sample& sample = excluded.samples[k];
            if (sample.y / 8 != ty || sample.x / 8 != tx) continue;
            places[count] = static_cast<std::uint8_t>(sample.y % 8 * 8 + sample.x % 8);
            before[count] = pixels[places[count]];
            ++count;
        }
        write_tile<false>(tx, t);
        for (std::uint32_t k = 0; k < count; ++k) pixels[places[k]] = before[k];
        if (count != 0) tiles_.least[t] = least_of(tiles_, t);
    }

    // True if a sample of the tile lies between the lines.
    [[nodiscard]] HWY_INLINE bool meets_tile(std::int32_t tx) const {
        const DF d;
        const VF first = hn::Set(d, static_cast<float>(8 * tx) + 0.5f);
        const VF last = hn::Set(d, static_cast<float>(8 * tx) + 7.5f);
        auto meets = hn::FirstN(d, 0);
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d))
            meets = hn::Or(
                meets, hn::And(hn::Le(hn::Load(d, band_.low + i), last), hn::Ge(hn::Load(d, band_.high + i), first)));
        return !hn::AllFalse(d, meets);
    }

    // All of it is in the picture.
    [[nodiscard]] HWY_INLINE bool is_whole(std::int32_t tx, std::int32_t ty) const {
        return static_cast<std::uint32_t>(8 * tx + 8) <= tiles_.width &&
               static_cast<std::uint32_t>(8 * ty + 8) <= tiles_.height;
    }

    // kFirst: nothing has been written there.
    template <bool kFirst>
    HWY_INLINE void write_tile(std::int32_t tx, std::size_t t) {
        const DF d;
        float* const pixels = tiles_.pixels + t * kTilePixels;
        const VF below = hn::Set(d, f_.below[i_]);
        VF least = hn::Set(d, std::numeric_limits<float>::infinity());
        for (std::size_t i = 0; i < kTile; i += hn::Lanes(d)) {
            const VF x = steps_from(static_cast<float>(8 * tx) + 0.5f + static_cast<float>(i));
            const VF depth = hn::Sub(plane_at(x), below);
            for (std::size_t row = 0; row < kTile; ++row) {
                float* const pixel = pixels + row * kTile + i;
                const VF before = kFirst ? hn::Set(d, kNothing) : hn::Load(d, pixel);
                const auto within =
                    hn::And(hn::Ge(x, hn::Set(d, band_.low[row])), hn::Le(x, hn::Set(d, band_.high[row])));
                const VF here = hn::Add(depth, hn::Set(d, band_.ups[row]));
                const VF after = hn::IfThenElse(within, kFirst ? here : hn::Max(here, before), before);
                hn::Store(after, d, pixel);
                least = hn::Min(least, after);
            }
        }
        tiles_.least[t] = std::max(hn::GetLane(hn::MinOfLanes(d, least)), tiles_.floors[t]);
    }

    const Tiles& tiles_;
    Band& band_;
    float far_;
    const Faces& f_;
    std::uint32_t i_;
    std::int32_t x0_, x1_, y0_, y1_;
    float at_row_ = 0.0f;  // the plane in the middle of the rows at hand, but for the column's share
    bool spares_ = false;  // a sample of the rows at hand is excluded
    float spread_;         // of the plane over half a tile
};

}  // namespace crofton::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
