// SPDX-License-Identifier: MIT
// Masks of vectors as bits of integers. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <cstdint>
#include <cstring>

#if defined(CROFTON_SIMD_MASK_BITS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_SIMD_MASK_BITS_INL
#undef CROFTON_SIMD_MASK_BITS_INL
#else
#define CROFTON_SIMD_MASK_BITS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Bit l for lane l, of up to 32 lanes of 32 or 64 bits. On x86 and in WebAssembly one instruction: Highway's
// StoreMaskBits goes through memory, where a load that is wider than the store waits for it.
template <class D>
HWY_INLINE std::uint32_t mask_bits([[maybe_unused]] D d, hn::Mask<D> mask) {
    constexpr std::size_t kLanes = hn::MaxLanes(D()), kLaneBytes = sizeof(hn::TFromD<D>);
    [[maybe_unused]] constexpr bool kFloats = kLaneBytes == 4, kDoubles = kLaneBytes == 8;
    static_assert((kFloats || kDoubles) && kLanes <= 32);
#if HWY_TARGET == HWY_AVX2
    if constexpr (kLanes * kLaneBytes == 32) {
        const auto signs = hn::VecFromMask(d, mask);
        if constexpr (kFloats)
            return static_cast<std::uint32_t>(_mm256_movemask_ps(hn::BitCast(hn::Full256<float>(), signs).raw));
        else
            return static_cast<std::uint32_t>(_mm256_movemask_pd(hn::BitCast(hn::Full256<double>(), signs).raw));
    }
#endif
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3
    if constexpr (kLanes * kLaneBytes == 16) {
        const auto signs = hn::VecFromMask(d, mask);
        if constexpr (kFloats)
            return static_cast<std::uint32_t>(_mm_movemask_ps(hn::BitCast(hn::Full128<float>(), signs).raw));
        else
            return static_cast<std::uint32_t>(_mm_movemask_pd(hn::BitCast(hn::Full128<double>(), signs).raw));
    }
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    if constexpr (kLanes * kLaneBytes == 64) return static_cast<std::uint32_t>(mask.raw);
#endif
#if HWY_TARGET == HWY_WASM
    if constexpr (kLanes * kLaneBytes == 16) {
        const auto signs = hn::VecFromMask(d, mask).raw;
        return static_cast<std::uint32_t>(kFloats ? wasm_i32x4_bitmask(signs) : wasm_i64x2_bitmask(signs));
    }
#endif
    constexpr std::size_t kBytes = (kLanes + 7) / 8;
    std::uint8_t bytes[8];
    hn::StoreMaskBits(d, mask, bytes);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kBytes; ++i) bits |= std::uint32_t{bytes[i]} << (8 * i);
    return bits;
}

// The lowest bits as a mask.
template <class D>
HWY_INLINE hn::Mask<D> mask_from_bits(D d, std::uint64_t bits) {
    // Eight bytes are stored and loaded as one: parts would wait for each other.
    alignas(8) std::uint8_t bytes[8];
    std::memcpy(bytes, &bits, 8);
    return hn::LoadMaskBits(d, bytes);
}

}  // namespace crofton::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
