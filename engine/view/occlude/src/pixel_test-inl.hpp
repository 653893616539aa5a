// SPDX-License-Identifier: MIT
// One projected box against pixels, and against the shadows of bodies. Compiled once per instruction set (Highway).
#include <hwy/highway.h>

#include "projection-inl.hpp"

#if defined(CROFTON_OCCLUDE_PIXEL_TEST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_OCCLUDE_PIXEL_TEST_INL
#undef CROFTON_OCCLUDE_PIXEL_TEST_INL
#else
#define CROFTON_OCCLUDE_PIXEL_TEST_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::occlude::HWY_NAMESPACE {

// The pixels of the tile that are not nearer than `nearness`, a bit each.
HWY_INLINE std::uint64_t farther_pixels(const float* pixels, float nearness) {
    const DF d;
    const VF limit = hn::Set(d, nearness);
    std::uint64_t farther = 0;
    for (std::size_t i = 0; i < 64; i += hn::Lanes(d))
        farther |= std::uint64_t{mask_bits(d, hn::Le(hn::Load(d, pixels + i), limit))} << i;
    return farther;
}

// The pixels [x0, x1] × [y0, y1] that a box may touch.
struct PixelRectangle {
    std::int32_t x0, y0, x1, y1;

    HWY_INLINE PixelRectangle(const Projection& boxes, std::size_t box)
        : x0(static_cast<std::int32_t>(boxes.low_x[box])),
          y0(static_cast<std::int32_t>(boxes.low_y[box])),
          x1(static_cast<std::int32_t>(boxes.high_x[box])),
          y1(static_cast<std::int32_t>(boxes.high_y[box])) {}
};

// Whether a box is in the shadow of a body.
class ShadowTest {
  public:
    HWY_INLINE ShadowTest(const QueryView& view, const Projection& boxes, std::size_t box)
        : perspective_(view.perspective), forms_(&boxes.forms[0][0][box]), errors_(&boxes.errors[0][box]) {}

    // As a whole.
    HWY_INLINE bool is_inside(const BodyShadow& shadow) const {
        for (std::size_t first = 0; first < shadow.count; first += hn::Lanes(DF()))
            if (!hn::AllTrue(DF(), hold(Planes(shadow, first, perspective_)))) return false;
        return shadow.count != 0;
    }
    // Whether it is behind all of the body's faces.
    HWY_INLINE bool is_behind(const BodyShadow& shadow) const {
        for (std::size_t first = 0; first < (std::min)(shadow.faces, shadow.count); first += hn::Lanes(DF())) {
            const std::uint32_t missed = ~mask_bits(DF(), hold(Planes(shadow, first, perspective_)));
            if ((missed & ((1u << (std::min)(shadow.faces - first, hn::Lanes(DF()))) - 1)) != 0) return false;
        }
        return shadow.count != 0;
    }

  private:
    // The third form is w, and z is 1; or, in a parallel view, it is z, and w is 1.
    struct Planes {
        VF x, y, third, constant;

        HWY_INLINE Planes(const BodyShadow& shadow, std::size_t first, bool perspective) {
            const DF d;
            const float* const rows = shadow.groups + first / kShadowLanes * 4 * kShadowLanes + first % kShadowLanes;
            x = hn::Load(d, rows);
            y = hn::Load(d, rows + kShadowLanes);
            const VF w = hn::Load(d, rows + 2 * kShadowLanes), z = hn::Neg(hn::Load(d, rows + 3 * kShadowLanes));
            third = perspective ? w : z;
            constant = perspective ? z : w;
        }
        // At the centre (0), or along a half edge but for the constant.
        HWY_INLINE VF along(const float* forms, std::size_t k) const {
            const DF d;
            const auto form = [&](std::size_t r) HWY_ATTR { return hn::Set(d, forms[(4 * r + k) * kLanes]); };
            return hn::Add(hn::Add(hn::Mul(x, form(0)), hn::Mul(y, form(1))), hn::Mul(third, form(2)));
        }
        HWY_INLINE VF at(const float* forms, std::size_t k) const { return hn::Add(along(forms, k), constant); }
    };

    // Each plane's form is least at a corner of the box. Its error is those of three forms and that of the number that
    // they are compared with. The forms' count twice, for the roundings here and of the plane's numbers to float.
    HWY_INLINE hn::Mask<DF> hold(const Planes& planes) const {
        const DF d;
        VF least = planes.at(forms_, 0);
        for (std::size_t k = 1; k < 4; ++k) least = hn::Sub(least, hn::Abs(planes.along(forms_, k)));
        const auto error = [&](std::size_t r) HWY_ATTR { return hn::Set(d, errors_[r * kLanes]); };
        const VF forms = hn::Add(hn::Add(hn::Mul(hn::Abs(planes.x), error(0)), hn::Mul(hn::Abs(planes.y), error(1))),
                                 hn::Mul(hn::Abs(planes.third), error(2)));
        const VF constant = hn::Max(hn::Abs(planes.constant), hn::Set(d, 1.0f));
        return hn::Gt(least, hn::Add(hn::Mul(forms, hn::Set(d, 2.0f)), hn::Mul(constant, hn::Set(d, 0x1p-20f))));
    }

    bool perspective_;
    const float *forms_, *errors_;
};

// Each pixel must be nearer than all of the box, or be covered by a body that has all of the box behind its faces.
class PixelTest {
  public:
    HWY_INLINE PixelTest(const QueryView& view, const Projection& boxes, std::size_t box)
        : view_(view), shadow_(view, boxes, box), nearness_(boxes.nearness[box]) {}

    // Whether the box is in the shadow of one of the bodies that cover a pixel of the tile. Those that cover one of
    // `first` are asked before others.
    HWY_INLINE bool is_in_shadow(std::size_t tile, std::uint64_t first) const {
        const TileCovers& covers = view_.covers[tile];
        std::uint32_t candidates = 0, there = 0;
        for (std::uint32_t i = 0; i < TileCovers::kCount; ++i) {
            candidates |= static_cast<std::uint32_t>((covers.pixels[i] & first) != 0) << i;
            there |= static_cast<std::uint32_t>(covers.pixels[i] != 0) << i;
        }
        if (candidates == 0) candidates = there;
        for (; candidates != 0; candidates &= candidates - 1) {
            const std::size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero32(candidates);
            if (shadow_.is_inside(view_.shadows[covers.bodies[i]])) return true;
        }
        return false;
    }

    // Returns false if the buffer shows the box in one of the pixels whose bits are set.
    HWY_INLINE bool hides(std::size_t tile, std::uint64_t mask) {
        if (view_.least[tile] > nearness_) return true;
        std::uint64_t open = farther_pixels(view_.pixels + kTilePixels * tile, nearness_) & mask;
        const TileCovers& covers = view_.covers[tile];
        for (std::size_t i = 0; i < TileCovers::kCount && open != 0; ++i)
            if ((open & covers.pixels[i]) != 0 && is_behind(covers.bodies[i])) open &= ~covers.pixels[i];
        return open == 0;
    }

  private:
    // Caches the last few answers.
    HWY_INLINE bool is_behind(std::uint32_t body) {
        for (const Known& known : known_)
            if (known.body == body) return known.behind;
        Known& known = known_[next_++ % kKnown];
        known = {body, shadow_.is_behind(view_.shadows[body])};
        return known.behind;
    }

    struct Known {
        std::uint32_t body;
        bool behind;
    };
    static constexpr std::size_t kKnown = 4;

    const QueryView& view_;
    ShadowTest shadow_;
    float nearness_;
    Known known_[kKnown] = {{~0u, false}, {~0u, false}, {~0u, false}, {~0u, false}};
    std::size_t next_ = 0;
};

}  // namespace crofton::occlude::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
