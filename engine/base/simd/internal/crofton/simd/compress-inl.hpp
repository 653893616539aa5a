// SPDX-License-Identifier: MIT
// The selected lanes of a vector, moved to its front. Compiled once per instruction set (Highway).
//
// Instead of Highway's Compress and CompressStore. In version 1.0.3 those of AVX2 and SSE4 copy their table to the
// stack at each call, as does that of AVX-512 for 64-bit lanes. CompressStore of AVX-512 is slow on Zen 4.
#include <hwy/highway.h>
#include <crofton/simd/compress_tables.hpp>
#include <cstddef>
#include <cstdint>

#include "mask_bits-inl.hpp"

#if defined(CROFTON_SIMD_COMPRESS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_SIMD_COMPRESS_INL
#undef CROFTON_SIMD_COMPRESS_INL
#else
#define CROFTON_SIMD_COMPRESS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2
// The lanes' indices from 4 bits each; the permutation reads the lowest 3.
HWY_INLINE hn::Vec<hn::Full256<std::uint32_t>> unpack_lanes(std::uint32_t digits) {
    const hn::Full256<std::uint32_t> d;
    alignas(32) static constexpr std::uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
    return hn::Shr(hn::Set(d, digits), hn::Load(d, kShifts));
}

template <class V>
HWY_INLINE V permute_32(V v, std::uint32_t digits) {
    const hn::DFromV<V> d;
    const auto raw = hn::BitCast(hn::Full256<std::uint32_t>(), v).raw;
    return hn::BitCast(d,
                       hn::Vec<hn::Full256<std::uint32_t>>{_mm256_permutevar8x32_epi32(raw, unpack_lanes(digits).raw)});
}
#endif

// The lanes of `mask` first, in their order; the remaining lanes are unspecified. Lanes of 32 or 64 bits.
template <class D>
HWY_INLINE hn::Vec<D> compress([[maybe_unused]] D d, hn::Vec<D> v, hn::Mask<D> mask) {
    constexpr std::size_t kLaneBytes = sizeof(hn::TFromD<D>);
    static_assert(kLaneBytes == 4 || kLaneBytes == 8);
#if HWY_TARGET == HWY_AVX2
    if constexpr (hn::MaxLanes(D()) * kLaneBytes == 32) {
        const std::uint32_t bits = mask_bits(d, mask);
        return permute_32(v, kLaneBytes == 4 ? kCompressLanes8.lanes[bits] : kCompressLanes4.lanes[bits]);
    }
#endif
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128 && !(HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3)
    if constexpr (hn::MaxLanes(D()) * kLaneBytes == 16) {
        const hn::Repartition<std::uint8_t, D> bytes;
        const auto order = hn::Load(bytes, kCompressBytes16<kLaneBytes>.bytes[mask_bits(d, mask)]);
        return hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(bytes, v), order));
    }
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    if constexpr (hn::MaxLanes(D()) * kLaneBytes == 64 && kLaneBytes == 8) {
        const hn::Full512<std::uint64_t> bits;
        const auto raw = _mm512_maskz_compress_epi64(static_cast<__mmask8>(mask.raw), hn::BitCast(bits, v).raw);
        return hn::BitCast(d, hn::Vec<decltype(bits)>{raw});
    }
#endif
    return hn::Compress(v, mask);
}

// Stores the lanes of `mask` contiguously, followed by unspecified lanes up to a whole vector: `to` needs room for
// that. Returns the number of lanes in `mask`.
template <class D>
HWY_INLINE std::size_t compress_store(D d, hn::Vec<D> v, hn::Mask<D> mask, hn::TFromD<D>* to) {
    hn::StoreU(compress(d, v, mask), d, to);
#if HWY_TARGET == HWY_WASM
    return hwy::PopCount(mask_bits(d, mask));  // Highway's goes through memory
#else
    return hn::CountTrue(d, mask);
#endif
}

// base + the positions of the bits that are set, below the number of lanes, to `to`, which needs room for a whole
// vector. Returns how many bits there are. Requires that no bit beyond is set.
template <class D>
HWY_INLINE std::size_t store_positions(D d, std::uint32_t bits, std::uint32_t base, std::uint32_t* to) {
    static_assert(sizeof(hn::TFromD<D>) == 4);
#if HWY_TARGET == HWY_AVX2
    if constexpr (hn::MaxLanes(D()) == 8) {
        const auto positions = hn::And(unpack_lanes(kCompressLanes8.lanes[bits]), hn::Set(d, 7));
        hn::StoreU(hn::Add(positions, hn::Set(d, base)), d, to);
        return hwy::PopCount(bits);
    }
#endif
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128 && !(HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3)
    if constexpr (hn::MaxLanes(D()) == 4) {
        hn::StoreU(hn::Add(hn::Load(d, kPositions4.lanes[bits]), hn::Set(d, base)), d, to);
        return hwy::PopCount(bits);
    }
#endif
    // Iota from another start would be stored lane by lane.
    const auto lanes = hn::Add(hn::Iota(d, 0), hn::Set(d, base));
    hn::StoreU(compress(d, lanes, mask_from_bits(d, bits)), d, to);
    return hwy::PopCount(bits);
}

}  // namespace crofton::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
