// SPDX-License-Identifier: MIT
// Three doubles side by side, in one vector of four, two of two or three of one. Included once per instruction set.
#if defined(CROFTON_COLLIDE_THREE_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_THREE_LANES
#undef CROFTON_COLLIDE_THREE_LANES
#else
#define CROFTON_COLLIDE_THREE_LANES
#endif

#include <hwy/highway.h>

#include <crofton/simd/mask_bits-inl.hpp>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

using D3 = hn::CappedTag<double, 4>;
constexpr std::size_t kWidth = hn::MaxLanes(D3()), kParts = (3 + kWidth - 1) / kWidth;

// Lanes after the third are anything.
struct Three {
    hn::Vec<D3> part[kParts];
};

template <class Operation>
HWY_INLINE Three map3(const Three& u, const Three& v, Operation operation) {
    Three result;
    for (std::size_t i = 0; i < kParts; ++i) result.part[i] = operation(u.part[i], v.part[i]);
    return result;
}

// Single roundings, not fused: the same on every machine.
HWY_INLINE Three operator+(const Three& u, const Three& v) {
    return map3(u, v, [](auto x, auto y) HWY_ATTR { return hn::Add(x, y); });
}
HWY_INLINE Three operator-(const Three& u, const Three& v) {
    return map3(u, v, [](auto x, auto y) HWY_ATTR { return hn::Sub(x, y); });
}
HWY_INLINE Three operator*(const Three& u, const Three& v) {
    return map3(u, v, [](auto x, auto y) HWY_ATTR { return hn::Mul(x, y); });
}
HWY_INLINE Three operator/(const Three& u, const Three& v) {
    return map3(u, v, [](auto x, auto y) HWY_ATTR { return hn::Div(x, y); });
}
HWY_INLINE Three larger(const Three& u, const Three& v) {
    return map3(u, v, [](auto x, auto y) HWY_ATTR { return hn::Max(x, y); });
}
HWY_INLINE Three magnitude(const Three& u) {
    return map3(u, u, [](auto x, auto) HWY_ATTR { return hn::Abs(x); });
}

HWY_INLINE Three all3(double value) {
    Three result;
    for (std::size_t i = 0; i < kParts; ++i) result.part[i] = hn::Set(D3(), value);
    return result;
}

// From four floats, the last of which is anything.
HWY_INLINE Three load3(const float* from) {
    const hn::Rebind<float, D3> floats;
    Three result;
    for (std::size_t i = 0; i < kParts; ++i) result.part[i] = hn::PromoteTo(D3(), hn::LoadU(floats, from + i * kWidth));
    return result;
}

// To four doubles, aligned, the last of which becomes anything.
HWY_INLINE void store3(const Three& u, double* to) {
    for (std::size_t i = 0; i < kParts; ++i) hn::Store(u.part[i], D3(), to + i * kWidth);
}

template <class Comparison>
HWY_INLINE std::uint32_t lanes_where(Comparison comparison) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kParts; ++i) bits |= simd::mask_bits(D3(), comparison(i)) << (i * kWidth);
    return bits & 7u;
}

// Bit i for lane i, where u < v.
HWY_INLINE std::uint32_t lanes_below(const Three& u, const Three& v) {
    return lanes_where([&](std::size_t i) HWY_ATTR { return hn::Lt(u.part[i], v.part[i]); });
}
HWY_INLINE std::uint32_t lanes_equal(const Three& u, const Three& v) {
    return lanes_where([&](std::size_t i) HWY_ATTR { return hn::Eq(u.part[i], v.part[i]); });
}
// u where `size` is above `least`, else `otherwise`.
HWY_INLINE Three where_above(const Three& size, double least, const Three& u, double otherwise) {
    Three result;
    for (std::size_t i = 0; i < kParts; ++i)
        result.part[i] =
            hn::IfThenElse(hn::Gt(size.part[i], hn::Set(D3(), least)), u.part[i], hn::Set(D3(), otherwise));
    return result;
}
// The same where each of five is below v.
HWY_INLINE std::uint32_t lanes_all_below(const Three (&u)[5], const Three& v) {
    return lanes_where([&](std::size_t i) HWY_ATTR {
        const auto below = [&](std::size_t k) HWY_ATTR { return hn::Lt(u[k].part[i], v.part[i]); };
        return hn::And(hn::And(hn::And(below(0), below(1)), hn::And(below(2), below(3))), below(4));
    });
}

// Lane i of the result is lane i + 1, or i + 2, in a circle of three.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Three next(const Three& u) {
    return {{u.part[1], u.part[2], u.part[0]}};
}
HWY_INLINE Three after_next(const Three& u) {
    return {{u.part[2], u.part[0], u.part[1]}};
}
#elif HWY_MAX_BYTES == 16
HWY_INLINE Three next(const Three& u) {
    return {{hn::CombineShiftRightLanes<1>(D3(), u.part[1], u.part[0]), u.part[0]}};
}
HWY_INLINE Three after_next(const Three& u) {
    return {{hn::ConcatLowerLower(D3(), u.part[0], u.part[1]), hn::ConcatUpperUpper(D3(), u.part[0], u.part[0])}};
}
#else
HWY_INLINE Three next(const Three& u) {
    alignas(32) static constexpr std::int64_t kNext[4] = {1, 2, 0, 3};
    return {{hn::TableLookupLanes(u.part[0], hn::SetTableIndices(D3(), kNext))}};
}
HWY_INLINE Three after_next(const Three& u) {
    alignas(32) static constexpr std::int64_t kAfterNext[4] = {2, 0, 1, 3};
    return {{hn::TableLookupLanes(u.part[0], hn::SetTableIndices(D3(), kAfterNext))}};
}
#endif

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
