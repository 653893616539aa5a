// SPDX-License-Identifier: MIT
// A list's rows against planes in integers, 64 bounds at a time. Compiled once per instruction set (Highway).
#include "list/row_planes-inl.hpp"
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_ROW_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_ROW_TESTS_INL
#undef CROFTON_CULL_ROW_TESTS_INL
#else
#define CROFTON_CULL_ROW_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// The rows of four blocks from lane l on, as many as a vector holds.
struct RowLanes {
    VU xy[4], zr[4];
    VI radius[4];  // in units of the planes' values

    HWY_INLINE RowLanes(const RowBlock* blocks, std::size_t l) {
        const DU du;
        for (std::size_t b = 0; b < 4; ++b) {
            xy[b] = hn::Load(du, blocks[b].xy + l);
            zr[b] = hn::Load(du, blocks[b].zr + l);
            const VU upper = hn::And(zr[b], hn::Set(du, 0xffff0000u));
            radius[b] = hn::BitCast(DI(), hn::ShiftRight<16 - kRowNormalBits>(upper));
        }
    }
};

// The bounds that are certainly outside, and those that are certainly inside: a mask for each block.
struct RowTest {
    hn::Mask<DI> outside[4], inside[4];

    HWY_INLINE RowTest(const RowLanes& rows, const RowPlanes& planes) {
        const DI di;
        const DU du;
        VI least[4] = {hn::Set(di, 0x7fffffff), hn::Set(di, 0x7fffffff), hn::Set(di, 0x7fffffff),
                       hn::Set(di, 0x7fffffff)};
        for (std::uint32_t i = 0; i < planes.count; ++i) {
            const VU xy = hn::Set(du, planes.normal_xy[i]), z = hn::Set(du, planes.normal_z[i]);
            const VI offset = hn::Set(di, planes.offset[i]);
            for (std::size_t b = 0; b < 4; ++b)
                least[b] = hn::Min(least[b], add_products(add_products(offset, rows.xy[b], xy), rows.zr[b], z));
        }
        const VI error_bound = hn::Set(di, planes.error_bound);
        for (std::size_t b = 0; b < 4; ++b) {
            const VI grown_radius = hn::Add(rows.radius[b], error_bound);
            outside[b] = hn::Lt(least[b], hn::Neg(grown_radius));
            inside[b] = hn::Gt(least[b], grown_radius);
        }
    }
};

// Bit 16 b + l for lane l of block b.
template <class M>
HWY_INLINE std::uint64_t bits_of_blocks(const M (&masks)[4], std::size_t l) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < 4; ++b) bits |= std::uint64_t{bits_of(hn::RebindMask(DF(), masks[b]))} << (16 * b + l);
    return bits;
}

// Lists the indices of the set bits, which are few. Writes eight for every word, whether it has them or not, and more
// where it has. Needs room for 8 beyond the last.
HWY_INLINE std::size_t list_sparse_bits(const std::uint64_t* bits, std::size_t words, std::uint32_t* ids) {
    std::size_t count = 0;
    for (std::size_t w = 0; w < words; ++w) {
        std::uint64_t word = bits[w];
        const std::size_t found = hwy::PopCount(word);
        const auto base = static_cast<std::uint32_t>(64 * w);
        std::uint32_t* to = ids + count;
        const auto next = [&] {
            *to++ =
                base + static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(word | std::uint64_t{1} << 63));
            word &= word - 1;
        };
        for (int i = 0; i < 8; ++i) next();
        for (std::size_t i = 8; i < found; ++i) next();
        count += found;
    }
    return count;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
