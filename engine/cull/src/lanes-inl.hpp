// Lanes of floats and of pairs of 16-bit integers. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <bit>
#include <crofton/boxtree/layout.hpp>
#include <cstring>

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

// Bit l for lane l. As one load of what was stored: bytes put together one by one cost more than the tests.
template <class M>
HWY_INLINE std::uint32_t bits_of(M mask) {
    static_assert(std::endian::native == std::endian::little);
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DF(), mask, bytes);
    std::uint16_t bits;
    std::memcpy(&bits, bytes, 2);
    return bits;
}

// The lowest bits as a mask. Eight bytes are stored and loaded as one: parts would have to wait for each other.
HWY_INLINE hn::Mask<DU> mask_of(std::uint64_t bits) {
    alignas(8) std::uint8_t bytes[8];
    std::memcpy(bytes, &bits, 8);
    return hn::LoadMaskBits(DU(), bytes);
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
