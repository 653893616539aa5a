// SPDX-License-Identifier: MIT
// Lanes of floats and of pairs of 16-bit integers. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <crofton/boxtree/layout.hpp>
#include <crofton/simd/compress-inl.hpp>
#include <crofton/simd/mask_bits-inl.hpp>

#if defined(CROFTON_CULL_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LANES_INL
#undef CROFTON_CULL_LANES_INL
#else
#define CROFTON_CULL_LANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using DF = hn::CappedTag<float, boxtree::kWidth>;
using DU = hn::RebindToUnsigned<DF>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VU = hn::Vec<DU>;
using VI = hn::Vec<DI>;
using MF = hn::Mask<DF>;

// The halves of pairs as floats.
HWY_INLINE VF lower_half(VU pairs) {
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(DI(), pairs))));
}
HWY_INLINE VF upper_half(VU pairs) {
    return hn::ConvertTo(DF(), hn::ShiftRight<16>(hn::BitCast(DI(), pairs)));
}

namespace simd = crofton::simd::HWY_NAMESPACE;

// Bit l for lane l.
HWY_INLINE std::uint32_t bits_of(MF mask) {
    return simd::mask_bits(DF(), mask);
}

template <class Visit>
HWY_INLINE void for_each_bit(std::uint32_t bits, const Visit& visit) {
    for (; bits; bits &= bits - 1) visit(static_cast<unsigned>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
}

// The lowest bits as a mask.
HWY_INLINE hn::Mask<DU> mask_of(std::uint64_t bits) {
    return simd::mask_from_bits(DU(), bits);
}

// sum + Σ of the products of the signed halves of a and b, in each lane. Exact: the planes see to the range.
HWY_INLINE VI add_products(VI sum, VU a, VU b) {
    const DI di;
#if HWY_TARGET == HWY_SCALAR
    const auto low = [&](VU v) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(di, v))); };
    const auto high = [&](VU v) { return hn::ShiftRight<16>(hn::BitCast(di, v)); };
    return hn::Add(sum, hn::Add(hn::Mul(low(a), low(b)), hn::Mul(high(a), high(b))));
#elif HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL && !HWY_COMPILER_MSVC
    // Highway checks for this instruction before it takes the target, but does not let its intrinsic be compiled there.
    asm("vpdpwssd %2, %1, %0" : "+v"(sum.raw) : "v"(a.raw), "v"(b.raw));
    return sum;
#else
    const hn::Repartition<std::int16_t, DI> d16;
    // Where products come out in another order than their lanes', what is rearranged may hold nothing else.
    VI rest = hn::Zero(di);
    const VI products = hn::ReorderWidenMulAccumulate(di, hn::BitCast(d16, a), hn::BitCast(d16, b), hn::Zero(di), rest);
    return hn::Add(sum, hn::RearrangeToOddPlusEven(products, rest));
#endif
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
