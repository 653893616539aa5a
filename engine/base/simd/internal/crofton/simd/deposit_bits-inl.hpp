// SPDX-License-Identifier: MIT
// Consecutive bits moved to where a mask has its bits. Compiled once per instruction set (Highway).
#include <hwy/highway.h>
#include <cstddef>
#include <cstdint>

#if defined(CROFTON_SIMD_DEPOSIT_BITS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_SIMD_DEPOSIT_BITS_INL
#undef CROFTON_SIMD_DEPOSIT_BITS_INL
#else
#define CROFTON_SIMD_DEPOSIT_BITS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::simd::HWY_NAMESPACE {

// Bit n of `bits` at the place of the n-th set bit of `mask`; 0 elsewhere.
HWY_INLINE std::uint64_t deposit_bits(std::uint64_t bits, std::uint64_t mask) {
#if HWY_ARCH_X86_64 && HWY_TARGET <= HWY_AVX2
    return _pdep_u64(bits, mask);
#else
    std::uint64_t result = 0;
    for (; bits != 0 && mask != 0; mask &= mask - 1, bits >>= 1)
        result |= mask & (~mask + 1) & (~(bits & 1) + 1);  // no branch on the bit, which would be mispredicted
    return result;
#endif
}

// 64 bits from bit `at` on. Reads one word more than they lie in.
HWY_INLINE std::uint64_t bits_from(const std::uint64_t* words, std::size_t at) {
    const std::size_t shift = at % 64;
    return words[at / 64] >> shift | words[at / 64 + 1] << 1 << (63 - shift);
}

}  // namespace crofton::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
