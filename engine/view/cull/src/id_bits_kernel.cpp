// SPDX-License-Identifier: MIT
#include "id_bits_kernel.hpp"

#include <bit>
#include <cstring>

// Also compile for AVX-512 VBMI2, which compresses bytes.
#define HWY_WANT_AVX3_DL 1
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "tree/block_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR
// Most ids come sixteen at a time from a leaf. Where items are numbered along the tree these lie within a word's
// length.
constexpr std::uint32_t kBefore = 24;  // how far below the first of them the word begins

// The OR of the bits; as they are distinct, their sum.
HWY_INLINE std::uint64_t word_of(VU positions) {
    const hn::Repartition<std::uint64_t, DU> d64;
    const auto one = hn::Set(d64, 1);
    const auto even = hn::And(hn::BitCast(d64, positions), hn::Set(d64, 0xffffffffu)),
               odd = hn::ShiftRight<32>(hn::BitCast(d64, positions));
    return hn::GetLane(hn::SumOfLanes(d64, hn::Add(hn::Shl(one, even), hn::Shl(one, odd))));
}
#endif

HWY_INLINE void mark(std::uint32_t id, std::uint64_t* bits) {
    bits[id / 64] |= std::uint64_t{1} << (id % 64);
}

// Four parts of the list in turn. Neighbours in the list are often in one word, and loading a word right after storing
// it stalls.
void mark_scattered(const std::uint32_t* ids, std::size_t count, std::uint64_t* bits) {
    constexpr std::size_t kParts = 4;
    const std::size_t part = count / kParts;
    for (std::size_t i = 0; i < part; ++i)
        for (std::size_t p = 0; p < kParts; ++p) mark(ids[p * part + i], bits);
    for (std::size_t i = kParts * part; i < count; ++i) mark(ids[i], bits);
}

#if HWY_TARGET != HWY_SCALAR
// Whether the ids of a vector mostly lie within a word's length. Judged once, by some of them: a branch for each vector
// would often be mispredicted.
bool are_together(const std::uint32_t* ids, std::size_t count) {
    const DU du;
    constexpr std::size_t kSamples = 16;
    std::size_t together = 0;
    for (std::size_t s = 0; s < kSamples; ++s) {
        const std::uint32_t* const from = ids + s * (count / kSamples);
        const VU positions = hn::Sub(hn::LoadU(du, from), hn::Set(du, from[0] < kBefore ? 0 : from[0] - kBefore));
        together += hn::AllTrue(du, hn::Lt(positions, hn::Set(du, 64)));
    }
    return 4 * together >= 3 * kSamples;
}
#endif

void mark_ids(const std::uint32_t* ids, std::size_t count, std::uint64_t* bits) {
#if HWY_TARGET == HWY_SCALAR
    mark_scattered(ids, count, bits);
#else
    const DU du;
    if (count < 16 * hn::Lanes(du) || !are_together(ids, count)) return mark_scattered(ids, count, bits);
    const VU in_order = hn::Iota(du, kBefore), word_length = hn::Set(du, 64);
    const std::uint64_t run = ((std::uint64_t{1} << hn::Lanes(du)) - 1) << kBefore;
    std::size_t i = 0;
    for (; i + hn::Lanes(du) <= count; i += hn::Lanes(du)) {
        const std::uint32_t first = ids[i] < kBefore ? 0 : ids[i] - kBefore;
        const VU positions = hn::Sub(hn::LoadU(du, ids + i), hn::Set(du, first));
        std::uint64_t word;
        if (hn::AllTrue(du, hn::Eq(positions, in_order))) {
            word = run;
        } else if (hn::AllTrue(du, hn::Lt(positions, word_length))) {
            word = word_of(positions);
        } else {
            for (std::size_t l = 0; l < hn::Lanes(du); ++l) mark(ids[i + l], bits);
            continue;
        }
        std::uint64_t* to = bits + first / 64;
        to[0] |= word << (first % 64);
        to[1] |= word >> 1 >> (63 - first % 64);
    }
    for (; i < count; ++i) mark(ids[i], bits);
#endif
}

// Visits the ids of one word.
HWY_INLINE std::size_t list_word(std::uint64_t word, std::uint32_t base, std::uint32_t* ids) {
    const DU du;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
    const hn::Full512<std::uint8_t> d8;
    const auto positions = hn::Compress(hn::Iota(d8, 0), hn::LoadMaskBits(d8, reinterpret_cast<std::uint8_t*>(&word)));
    const hn::Half<decltype(d8)> half;
    const hn::Half<decltype(half)> quarter;
    const std::size_t count = hwy::PopCount(word);
    const VU from = hn::Set(du, base);
    const auto store = [&](std::size_t at, auto bytes)
                           HWY_ATTR { hn::StoreU(hn::Add(hn::PromoteTo(du, bytes), from), du, ids + at); };
    const auto lower = hn::LowerHalf(half, positions);
    store(0, hn::LowerHalf(quarter, lower));
    if (count > 16) store(16, hn::UpperHalf(quarter, lower));
    if (count > 32) {
        const auto upper = hn::UpperHalf(half, positions);
        store(32, hn::LowerHalf(quarter, upper));
        if (count > 48) store(48, hn::UpperHalf(quarter, upper));
    }
    return count;
#else
    constexpr std::uint32_t kLanes = hn::MaxLanes(DU()), kAll = (std::uint32_t{1} << kLanes) - 1;
    // If few items are visible, most words have few bits. Four are stored without a branch on their number.
    constexpr std::size_t kFew = 4;
    std::size_t count = hwy::PopCount(word);
    if (count <= kFew) {
        std::uint64_t rest = word;
        for (std::size_t i = 0; i < kFew; ++i, rest &= rest - 1)
            ids[i] = base + static_cast<std::uint32_t>(std::countr_zero(rest));
        return count;
    }
    count = 0;
    for (std::uint32_t l = 0; l < 64; l += kLanes) {  // always to the word's end: an earlier exit would be mispredicted
        const std::uint32_t bits = static_cast<std::uint32_t>(word >> l) & kAll;
        count += simd::store_positions(du, bits, base + l, ids + count);
    }
    return count;
#endif
}

// The bytes of one word's ids.
HWY_INLINE void mark_word(std::uint64_t word, std::uint64_t marks, MarkBytes values, std::uint8_t* bytes) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
    const hn::Full512<std::uint8_t> d8;
    const auto mask = hn::LoadMaskBits(d8, reinterpret_cast<std::uint8_t*>(&word)),
               marked = hn::LoadMaskBits(d8, reinterpret_cast<std::uint8_t*>(&marks));
    const auto all = hn::IfThenElse(marked, hn::Set(d8, values.marked), hn::Set(d8, values.others));
    hn::StoreU(hn::Compress(all, mask), d8, bytes);
#else
    // Few are marked. Leaves room for the length of a word.
    std::memset(bytes, values.others, 64);
    for (std::uint64_t rest = word & marks; rest; rest &= rest - 1) {
        const std::uint64_t below = (rest & (~rest + 1)) - 1;
        bytes[hwy::PopCount(word & below)] = values.marked;
    }
#endif
}

std::size_t list_ids(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w)
        if (bits[w] != 0) count += list_word(bits[w], static_cast<std::uint32_t>(64 * w), ids + count);
    return count;
}

std::size_t list_placed_ids(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids, std::uint64_t* before) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        before[w] = count;
        if (bits[w] != 0) count += list_word(bits[w], static_cast<std::uint32_t>(64 * w), ids + count);
    }
    return count;
}

std::size_t list_marked_ids(const std::uint64_t* bits, const std::uint64_t* marks, std::size_t words, MarkBytes values,
                            std::uint32_t* ids, std::uint8_t* bytes) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        if (bits[w] == 0) continue;
        mark_word(bits[w], marks[w], values, bytes + count);
        count += list_word(bits[w], static_cast<std::uint32_t>(64 * w), ids + count);
    }
    return count;
}

void mark_placed(const std::uint32_t* ids, std::size_t count, const std::uint64_t* bits, const std::uint64_t* before,
                 std::uint8_t value, std::uint8_t* bytes) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = ids[i];
        const std::uint64_t below = bits[id / 64] & ((std::uint64_t{1} << (id % 64)) - 1);
        bytes[before[id / 64] + hwy::PopCount(below)] = value;
    }
}

// Works in place: the write position never passes the read position.
std::size_t keep_ids(std::uint32_t* ids, std::size_t count, const std::uint64_t* bits, std::size_t words) {
    std::size_t kept = 0, i = 0;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    const DU du;
    const auto* const halves = reinterpret_cast<const int*>(bits);  // of words
    const VU last = hn::Set(du, static_cast<std::uint32_t>(2 * words - 1)), in_half = hn::Set(du, 31),
             one = hn::Set(du, 1);
    const hn::RebindToSigned<DU> di;
    for (; i + hn::Lanes(du) <= count; i += hn::Lanes(du)) {
        const VU id = hn::LoadU(du, ids + i), half = hn::ShiftRight<5>(id);
        const VU from = hn::BitCast(du, hn::GatherIndex(di, halves, hn::BitCast(di, hn::Min(half, last))));
        const VU bit = hn::Shl(one, hn::And(id, in_half));
        const auto keep = hn::Or(hn::TestBit(from, bit), hn::Gt(half, last));
        kept += simd::compress_store(du, id, keep, ids + kept);
    }
#endif
    for (; i < count; ++i) {
        const std::uint32_t id = ids[i];
        ids[kept] = id;
        kept += id / 64 >= words || (bits[id / 64] >> (id % 64) & 1) != 0;
    }
    return kept;
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(mark_ids);
HWY_EXPORT(list_ids);
HWY_EXPORT(list_placed_ids);
HWY_EXPORT(list_marked_ids);
HWY_EXPORT(mark_placed);
HWY_EXPORT(keep_ids);

void mark_ids_kernel(const std::uint32_t* ids, std::size_t count, std::uint64_t* bits) {
    HWY_DYNAMIC_DISPATCH(mark_ids)(ids, count, bits);
}

std::size_t list_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    return HWY_DYNAMIC_DISPATCH(list_ids)(bits, words, ids);
}

std::size_t list_placed_bits_kernel(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids,
                                    std::uint64_t* before) {
    return HWY_DYNAMIC_DISPATCH(list_placed_ids)(bits, words, ids, before);
}

std::size_t list_marked_bits_kernel(const std::uint64_t* bits, const std::uint64_t* marks, std::size_t words,
                                    MarkBytes values, std::uint32_t* ids, std::uint8_t* bytes) {
    return HWY_DYNAMIC_DISPATCH(list_marked_ids)(bits, marks, words, values, ids, bytes);
}

void mark_placed_kernel(const std::uint32_t* ids, std::size_t count, const std::uint64_t* bits,
                        const std::uint64_t* before, std::uint8_t value, std::uint8_t* bytes) {
    HWY_DYNAMIC_DISPATCH(mark_placed)(ids, count, bits, before, value, bytes);
}

std::size_t keep_ids_kernel(std::uint32_t* ids, std::size_t count, const std::uint64_t* bits, std::size_t words) {
    return HWY_DYNAMIC_DISPATCH(keep_ids)(ids, count, bits, words);
}

}  // namespace crofton::cull
#endif
