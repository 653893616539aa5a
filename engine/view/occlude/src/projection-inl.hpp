// SPDX-License-Identifier: MIT
// Projects boxes into a buffer's pixels, rounded outward, and tests them against the coarse levels of depth. Compiled
// once per instruction set (Highway).
#include <hwy/highway.h>

#include <crofton/simd/mask_bits-inl.hpp>

#include "buffer_data.hpp"
#include "query_kernel.hpp"

#if defined(CROFTON_OCCLUDE_PROJECTION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_OCCLUDE_PROJECTION_INL
#undef CROFTON_OCCLUDE_PROJECTION_INL
#else
#define CROFTON_OCCLUDE_PROJECTION_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using simd::HWY_NAMESPACE::mask_bits;

constexpr std::size_t kLanes = 8;  // boxes, or rows of a tile, at a time
using DF = hn::CappedTag<float, kLanes>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

// With u = 2^-24, of a form at a corner the centre, a half edge and a coefficient are rounded (u each), a product is,
// and sums of up to seven terms are. That is 10 u of the sum of the magnitudes, which itself is rounded; 2^-20 is 16 u.
constexpr float kFormError = 0x1p-20f;

// Results for some lanes, a bit each. Lanes in none are visible.
struct LaneBits {
    std::uint32_t hidden, outside_picture, open;

    HWY_INLINE void add(const LaneBits& other, std::size_t first) {
        hidden |= other.hidden << first;
        outside_picture |= other.outside_picture << first;
        open |= other.open << first;
    }
};

// The levels of least nearness, for many rectangles at once.
class Depths {
  public:
    explicit HWY_INLINE Depths(const QueryView& view) : view_(view) {}

    // The least nearness over tiles [x0, x1] × [y0, y1], or over more than those.
    HWY_INLINE VF least_over(VI x0, VI y0, VI x1, VI y1) const {
        const DF d;
        const DI di;
        // 2^level ≥ the longer side: then the rectangle meets two blocks at most along each.
        const VI longer = hn::Max(hn::Sub(x1, x0), hn::Sub(y1, y0));
        const VI below = hn::Max(hn::Sub(longer, hn::Set(di, 1)), hn::Zero(di));
        // For n ≥ 1 the exponent of n as a float is the place of its highest bit.
        const VI exponent = hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(d, below)));
        const VI level = hn::Max(hn::Sub(exponent, hn::Set(di, 126)), hn::Zero(di));
        const VI rows2 = hn::Set(di, static_cast<std::int32_t>(2 * view_.padded_rows));
        const VI base = hn::Sub(rows2, hn::Shr(rows2, level));
        const VI stride = hn::Set(di, static_cast<std::int32_t>(view_.tile_columns));
        const VI low = hn::Mul(hn::Add(base, hn::Shr(y0, level)), stride);
        const VI high = hn::Mul(hn::Add(base, hn::Shr(y1, level)), stride);
        const VI left = hn::Shr(x0, level), right = hn::Shr(x1, level);
        const VF a = hn::Min(hn::GatherIndex(d, view_.least, hn::Add(low, left)),
                             hn::GatherIndex(d, view_.least, hn::Add(low, right)));
        const VF b = hn::Min(hn::GatherIndex(d, view_.least, hn::Add(high, left)),
                             hn::GatherIndex(d, view_.least, hn::Add(high, right)));
        return hn::Min(a, b);
    }

    HWY_INLINE VF front_at(VI tile_x, VI tile_y) const {
        const VI stride = hn::Set(DI(), static_cast<std::int32_t>(view_.tile_columns));
        return hn::GatherIndex(DF(), view_.front, hn::Add(hn::Mul(tile_y, stride), tile_x));
    }

  private:
    const QueryView& view_;
};

// Eight boxes in pixels, counted from the picture's corner.
struct Projection {
    alignas(32) float margin[kLanes];    // each corner is within this of the true one
    alignas(32) float nearness[kLanes];  // of no point is it more
    alignas(32) float low_x[kLanes], low_y[kLanes], high_x[kLanes], high_y[kLanes];  // margins included, in the picture
    alignas(32) float forms[3][4][kLanes];  // column, row, and w or z: at the centre, and along the half edges
    alignas(32) float errors[3][kLanes];    // of a form at a corner

    // Fills lanes [at, at + Lanes) and returns the lanes that are already decided.
    HWY_INLINE LaneBits project(const QueryView& view, const Depths& depths, const VF (&center)[3],
                                const VF (&edge)[3][3], VF l1_radius, std::size_t at) {
        const DF d;
        VF form[3][4];  // at the centre, and along the half edges
        VF error[3];
        for (std::size_t r = 0; r < 3; ++r) {
            form[r][0] = hn::Add(along(view.form[r], center), hn::Set(d, view.form[r][3]));
            for (std::size_t k = 0; k < 3; ++k) form[r][k + 1] = along(view.form[r], edge[k]);
            const VF size =
                hn::Add(hn::Mul(hn::Set(d, view.max_abs[r]), l1_radius), hn::Set(d, hwy_abs(view.form[r][3])));
            error[r] = hn::Mul(size, hn::Set(d, kFormError));
            for (std::size_t k = 0; k < 4; ++k) hn::Store(form[r][k], d, forms[r][k] + at);
            hn::Store(error[r], d, errors[r] + at);
        }
        Bounds bounds(d);
        for (std::size_t c = 0; c < 8; ++c) add_corner(view, form, c, bounds);
        return view.perspective ? finish<true>(view, depths, form, error, bounds, at)
                                : finish<false>(view, depths, form, error, bounds, at);
    }

  private:
    struct Bounds {
        VF low_x, low_y, high_x, high_y, low_v, high_v;

        explicit HWY_INLINE Bounds(DF d)
            : low_x(hn::Set(d, 3e38f)),
              low_y(low_x),
              high_x(hn::Set(d, -3e38f)),
              high_y(high_x),
              low_v(low_x),
              high_v(high_x) {}
    };

    static HWY_INLINE float hwy_abs(float v) { return v < 0.0f ? -v : v; }

    static HWY_INLINE VF along(const float (&form)[4], const VF (&v)[3]) {
        const DF d;
        return hn::Add(hn::Add(hn::Mul(hn::Set(d, form[0]), v[0]), hn::Mul(hn::Set(d, form[1]), v[1])),
                       hn::Mul(hn::Set(d, form[2]), v[2]));
    }

    static HWY_INLINE VF corner_of(const VF (&form)[4], std::size_t c) {
        const VF a = c & 1 ? hn::Add(form[0], form[1]) : hn::Sub(form[0], form[1]);
        const VF b = c & 2 ? hn::Add(a, form[2]) : hn::Sub(a, form[2]);
        return c & 4 ? hn::Add(b, form[3]) : hn::Sub(b, form[3]);
    }

    HWY_INLINE void add_corner(const QueryView& view, const VF (&form)[3][4], std::size_t c, Bounds& bounds) {
        const DF d;
        VF px = corner_of(form[0], c), py = corner_of(form[1], c);
        const VF v = corner_of(form[2], c);
        if (view.perspective) {
            const VF inverse = hn::Div(hn::Set(d, 1.0f), v);
            px = hn::Mul(px, inverse);
            py = hn::Mul(py, inverse);
        }
        px = hn::Add(px, hn::Set(d, view.half_width));
        py = hn::Add(py, hn::Set(d, view.half_height));
        bounds.low_x = hn::Min(bounds.low_x, px);
        bounds.high_x = hn::Max(bounds.high_x, px);
        bounds.low_y = hn::Min(bounds.low_y, py);
        bounds.high_y = hn::Max(bounds.high_y, py);
        bounds.low_v = hn::Min(bounds.low_v, v);
        bounds.high_v = hn::Max(bounds.high_v, v);
    }

    // All corners behind the eye, or beyond one side of the picture: there column > w · half width, whatever w is. Both
    // forms are off by their errors, and their difference and its sums by less than that again.
    static HWY_INLINE hn::Mask<DF> outside_of_sides(const QueryView& view, const VF (&form)[3][4], const VF (&error)[3],
                                                    const Bounds& bounds) {
        const DF d;
        auto outside = hn::Lt(hn::Add(bounds.high_v, error[2]), hn::Set(d, view.least_w));
        for (std::size_t r = 0; r < 2; ++r) {
            const VF half = hn::Set(d, r == 0 ? view.half_width : view.half_height);
            const VF margin = hn::Mul(hn::Add(error[r], hn::Mul(half, error[2])), hn::Set(d, 2.0f));
            const VF w = hn::Mul(half, form[2][0]);
            VF above = hn::Sub(form[r][0], w), below = hn::Sub(hn::Neg(form[r][0]), w);
            for (std::size_t k = 1; k < 4; ++k) {
                const VF edge_w = hn::Mul(half, form[2][k]);
                above = hn::Sub(above, hn::Abs(hn::Sub(form[r][k], edge_w)));
                below = hn::Sub(below, hn::Abs(hn::Add(form[r][k], edge_w)));
            }
            outside = hn::Or(outside, hn::Or(hn::Gt(above, margin), hn::Gt(below, margin)));
        }
        return outside;
    }

    template <bool kPerspective>
    HWY_INLINE LaneBits finish(const QueryView& view, const Depths& depths, const VF (&form)[3][4],
                               const VF (&error)[3], const Bounds& bounds, std::size_t at) {
        const DF d;
        const DI di;
        const VF width = hn::Set(d, static_cast<float>(view.width)),
                 height = hn::Set(d, static_cast<float>(view.height));
        // The largest coordinate, from the middle.
        const VF largest = hn::Add(hn::Max(hn::Max(hn::Abs(bounds.low_x), hn::Abs(bounds.high_x)),
                                           hn::Max(hn::Abs(bounds.low_y), hn::Abs(bounds.high_y))),
                                   hn::Max(width, height));
        VF spread = hn::Max(error[0], error[1]), most, in_front;
        if (kPerspective) {
            // A lower bound on w at all points; every quotient below divides by at least this.
            const VF low_w = hn::Sub(bounds.low_v, error[2]);
            in_front = low_w;
            const VF inverse = hn::Div(hn::Set(d, 1.0f), low_w);
            spread = hn::Mul(hn::Add(spread, hn::Mul(largest, error[2])), inverse);
            most = hn::Mul(inverse, hn::Set(d, 1.0f + 0x1p-20f));
        } else {
            in_front = hn::Set(d, 1.0f);
            most = hn::Add(bounds.high_v, hn::Add(error[2], hn::Mul(hn::Abs(bounds.high_v), hn::Set(d, 0x1p-20f))));
        }
        // The quotient, the product and the sum with half the picture round as well.
        const VF m = hn::Add(hn::Mul(spread, hn::Set(d, 1.0f + 0x1p-10f)), hn::Mul(largest, hn::Set(d, 0x1p-21f)));
        const VF lx = hn::Sub(bounds.low_x, m), hx = hn::Add(bounds.high_x, m);
        const VF ly = hn::Sub(bounds.low_y, m), hy = hn::Add(bounds.high_y, m);
        // All comparisons are false for what is not a number: then nothing is known, and the box is visible.
        const auto usable = hn::And(
            hn::And(hn::Ge(in_front, hn::Set(d, kPerspective ? view.least_w : 0.5f)), hn::Lt(m, hn::Set(d, 0.5f))),
            hn::Lt(largest, hn::Set(d, 1e6f)));
        const auto outside_picture = hn::Or(hn::Or(hn::Lt(hx, hn::Zero(d)), hn::Gt(lx, width)),
                                            hn::Or(hn::Lt(hy, hn::Zero(d)), hn::Gt(ly, height)));
        const auto clamped = [&](VF v, VF end) {
            v = hn::Min(hn::Max(v, hn::Zero(d)), hn::Sub(end, hn::Set(d, 1.0f)));
            return hn::IfThenElseZero(usable, v);
        };
        const VF cx = clamped(lx, width), cy = clamped(ly, height), ex = clamped(hx, width), ey = clamped(hy, height);
        hn::Store(m, d, margin + at);
        hn::Store(most, d, nearness + at);
        hn::Store(cx, d, low_x + at);
        hn::Store(cy, d, low_y + at);
        hn::Store(ex, d, high_x + at);
        hn::Store(ey, d, high_y + at);
        const VI x0 = hn::ConvertTo(di, cx), y0 = hn::ConvertTo(di, cy), x1 = hn::ConvertTo(di, ex),
                 y1 = hn::ConvertTo(di, ey);
        const VF least = depths.least_over(hn::ShiftRight<3>(x0), hn::ShiftRight<3>(y0), hn::ShiftRight<3>(x1),
                                           hn::ShiftRight<3>(y1));
        const auto hidden = hn::Gt(least, most);
        const std::uint32_t usable_bits = mask_bits(d, usable);
        std::uint32_t outside_bits = mask_bits(d, outside_picture) & usable_bits;
        // A box that reaches behind the eye has no rectangle, but may still be outside of the view.
        if (kPerspective && usable_bits != (1u << hn::Lanes(d)) - 1)
            outside_bits |= mask_bits(d, outside_of_sides(view, form, error, bounds)) & ~usable_bits;
        const std::uint32_t hidden_bits = mask_bits(d, hidden) & usable_bits & ~outside_bits;
        // A shortcut: the box is visible if nothing in the tile of its middle is nearer than its centre.
        const VI middle_x = hn::ShiftRight<4>(hn::Add(x0, x1)), middle_y = hn::ShiftRight<4>(hn::Add(y0, y1));
        const VF front = depths.front_at(middle_x, middle_y);
        const auto seen =
            hn::Le(kPerspective ? hn::Mul(front, form[2][0]) : front, kPerspective ? hn::Set(d, 1.0f) : form[2][0]);
        return {hidden_bits, outside_bits, usable_bits & ~outside_bits & ~hidden_bits & ~mask_bits(d, seen)};
    }
};

}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
