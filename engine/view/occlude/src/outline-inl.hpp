// SPDX-License-Identifier: MIT
// A projected box against every pixel that its outline touches. Compiled once per instruction set (Highway).
#include <hwy/highway.h>

#include "pixel_test-inl.hpp"

#if defined(CROFTON_OCCLUDE_OUTLINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_OCCLUDE_OUTLINE_INL
#undef CROFTON_OCCLUDE_OUTLINE_INL
#else
#define CROFTON_OCCLUDE_OUTLINE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {

// An edge from its lower end up. An edge that is nearly level has its whole width in each row that it meets.
struct OutlineEdge {
    float x, low, high, slope, width;
};

class Outline {
  public:
    HWY_INLINE Outline(const QueryView& view, const Projection& boxes, std::size_t box) : margin_(boxes.margin[box]) {
        alignas(32) float x[8], y[8];
        find_corners(view, boxes, box, x, y);
        std::size_t n = 0;
        float wide = 0.0f;
        for (std::size_t a = 0; a < 8; ++a)
            for (std::size_t k = 1; k < 8; k *= 2) {
                if (a & k) continue;
                std::size_t p = a, q = a | k;
                if (y[q] < y[p]) std::swap(p, q);
                const float xp = x[p], xq = x[q], yp = y[p], yq = y[q];
                const float across = xq - xp, up = yq - yp, size = across < 0.0f ? -across : across;
                wide = std::max(wide, size);
                const bool level = !(up > kLevel);
                edges_[n++] = {level ? std::min(xp, xq) : xp, yp, yq, level ? 0.0f : across / up, level ? size : 0.0f};
            }
        // A row's end on an edge: a difference, a quotient, a product and a sum round, of the edge's width and of x.
        column_margin_ = margin_ + 0x1p-21f * wide + 0x1p-22f * (boxes.high_x[box] + wide);
    }

    // The columns [begin, end) that the outline touches in eight rows from `row` on, margins included.
    HWY_INLINE void spans(std::int32_t row, std::int32_t width, std::int32_t* begin, std::int32_t* end) const {
        const DF d;
        const DI di;
        for (std::size_t r = 0; r < kLanes; r += hn::Lanes(d)) {
            const VF bottom = hn::Iota(d, static_cast<float>(row + static_cast<std::int32_t>(r)));
            const VF margin = hn::Set(d, margin_ + kRowMargin), column_margin = hn::Set(d, column_margin_);
            const VF from = hn::Sub(bottom, margin), to = hn::Add(hn::Add(bottom, hn::Set(d, 1.0f)), margin);
            VF left = hn::Set(d, 3e8f), right = hn::Set(d, -3e8f);
            for (const OutlineEdge& edge : edges_) {
                const VF low = hn::Set(d, edge.low), x = hn::Set(d, edge.x), slope = hn::Set(d, edge.slope);
                const VF first = hn::Max(from, low), last = hn::Min(to, hn::Set(d, edge.high));
                const auto meets = hn::Le(first, last);
                const VF a = hn::Add(x, hn::Mul(slope, hn::Sub(first, low)));
                const VF b = hn::Add(x, hn::Mul(slope, hn::Sub(last, low)));
                const VF most = hn::Add(hn::Max(a, b), hn::Set(d, edge.width));
                left = hn::IfThenElse(meets, hn::Min(left, hn::Min(a, b)), left);
                right = hn::IfThenElse(meets, hn::Max(right, most), right);
            }
            const VF w = hn::Set(d, static_cast<float>(width)), zero = hn::Zero(d);
            left = hn::Min(hn::Max(hn::Sub(left, column_margin), zero), w);
            right = hn::Min(hn::Max(hn::Add(hn::Add(right, column_margin), hn::Set(d, 1.0f)), zero), w);
            hn::Store(hn::ConvertTo(di, left), di, begin + r);
            hn::Store(hn::ConvertTo(di, right), di, end + r);
        }
    }

  private:
    static HWY_INLINE void find_corners(const QueryView& view, const Projection& boxes, std::size_t box, float (&x)[8],
                                        float (&y)[8]) {
        const DF d;
        const DI di;
        for (std::size_t c = 0; c < 8; c += hn::Lanes(d)) {
            const VI number = hn::Iota(di, static_cast<std::int32_t>(c));
            const auto form = [&](std::size_t r) HWY_ATTR {
                VF sum = hn::Set(d, boxes.forms[r][0][box]);
                for (std::size_t k = 0; k < 3; ++k) {
                    const VF edge = hn::Set(d, boxes.forms[r][k + 1][box]);
                    const auto plus = hn::RebindMask(d, hn::TestBit(number, hn::Set(di, 1 << k)));
                    sum = hn::IfThenElse(plus, hn::Add(sum, edge), hn::Sub(sum, edge));
                }
                return sum;
            };
            VF px = form(0), py = form(1);
            if (view.perspective) {
                const VF inverse = hn::Div(hn::Set(d, 1.0f), form(2));
                px = hn::Mul(px, inverse);
                py = hn::Mul(py, inverse);
            }
            hn::Store(hn::Add(px, hn::Set(d, view.half_width)), d, x + c);
            hn::Store(hn::Add(py, hn::Set(d, view.half_height)), d, y + c);
        }
    }

    static constexpr float kLevel = 0x1p-10f;      // rows
    static constexpr float kRowMargin = 0x1p-11f;  // a row's ends are below 4096 and rounded

    float margin_, column_margin_;
    OutlineEdge edges_[12];
};

// The bits of columns [from, to) in rows [low, high) of a tile.
HWY_INLINE std::uint64_t rectangle_mask(std::int32_t from, std::int32_t to, std::int32_t low, std::int32_t high) {
    const auto clamped = [](std::int32_t v) { return static_cast<std::uint32_t>(std::clamp(v, 0, 8)); };
    const std::uint64_t row = (0xffu << clamped(from)) & ~(0xffffffffu << clamped(to)) & 0xffu;
    const std::uint64_t up = clamped(high) == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * clamped(high)) - 1;
    const std::uint64_t down = clamped(low) == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * clamped(low)) - 1;
    return row * 0x0101010101010101u & up & ~down;
}

HWY_INLINE bool rectangle_is_hidden(const QueryView& view, const PixelRectangle& r, PixelTest& test) {
    for (std::int32_t row = r.y0 / 8; row <= r.y1 / 8; ++row)
        for (std::int32_t column = r.x0 / 8; column <= r.x1 / 8; ++column) {
            const std::size_t tile =
                static_cast<std::size_t>(row) * view.tile_columns + static_cast<std::size_t>(column);
            const std::uint64_t mask =
                rectangle_mask(r.x0 - 8 * column, r.x1 + 1 - 8 * column, r.y0 - 8 * row, r.y1 + 1 - 8 * row);
            if (!test.hides(tile, mask)) return false;
        }
    return true;
}

// Whether the pixels that the box may touch hide it, its rectangle or its outline.
inline bool outline_is_hidden(const QueryView& view, const Projection& boxes, std::size_t box, const PixelRectangle& r,
                              PixelTest& test) {
    if (rectangle_is_hidden(view, r, test)) return true;
    if (r.x1 - r.x0 < 2 || r.y1 - r.y0 < 2) return false;  // no pixel of it is beside the outline, or hardly one
    const Outline outline(view, boxes, box);
    alignas(32) std::int32_t begin[kLanes], end[kLanes];
    for (std::int32_t row = r.y0 / 8; row <= r.y1 / 8; ++row) {
        outline.spans(8 * row, static_cast<std::int32_t>(view.width), begin, end);
        for (std::int32_t column = r.x0 / 8; column <= r.x1 / 8; ++column) {
            const std::size_t tile =
                static_cast<std::size_t>(row) * view.tile_columns + static_cast<std::size_t>(column);
            std::uint64_t mask =
                rectangle_mask(r.x0 - 8 * column, r.x1 + 1 - 8 * column, r.y0 - 8 * row, r.y1 + 1 - 8 * row);
            for (std::size_t i = 0; i < 8; ++i) {
                const std::int32_t from = std::clamp(begin[i] - 8 * column, 0, 8);
                const std::int32_t to = std::clamp(end[i] - 8 * column, 0, 8);
                const std::uint32_t bits = (0xffu << from) & ~(0xffffffffu << to) & 0xffu;
                mask &= std::uint64_t{bits} << (8 * i) | ~(std::uint64_t{0xff} << (8 * i));
            }
            if (!test.hides(tile, mask)) return false;
        }
    }
    return true;
}

}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
