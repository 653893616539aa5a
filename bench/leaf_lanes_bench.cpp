// SPDX-License-Identifier: MIT
// An experiment: sixteen boxes of a leaf against a plane in lanes of 32 bits, as the tree has them, and of 16 bits.
// Both write the same lists. Leaves lie in the cache, so that arithmetic alone is compared.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "leaf_lanes_bench.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "tree/leaf_tests-inl.hpp"

#ifndef CROFTON_LEAF_LANES_BENCH
#define CROFTON_LEAF_LANES_BENCH
namespace crofton::cull {

// A leaf whose numbers each have 16 bits and a register's row to themselves. Positions are up to 2^13 units, so that
// sums of three products and a near plane's offset fit.
struct alignas(64) NarrowLeaf {
    std::int16_t center[3][16], edge[9][16];
};

// A normal in units of 2^-15 and what a plane's value may be off by, in units.
struct NarrowPlane {
    std::int16_t normal[3], offset, error_bound;
};

struct LaneLists {
    std::uint32_t *inside, *straddling, *undecided;
};

struct LaneInput {
    const boxtree::Leaf* wide;
    const NarrowLeaf* narrow;
    const PairPlane* pair_planes;
    const BlockPlane* at;
    const NarrowPlane* planes;
    const std::uint32_t* ids;
    std::size_t leaves, planes_each;
};

}  // namespace crofton::cull
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

struct LaneOutput {
    LaneLists lists;
    std::size_t inside = 0, straddling = 0, undecided = 0;

    // Bits of eight of a leaf's boxes.
    static HWY_INLINE std::size_t append(VU items, std::uint32_t bits, std::uint32_t* to) {
#if HWY_TARGET == HWY_AVX2
        hn::StoreU(simd::permute_32(items, crofton::simd::kCompressLanes8.lanes[bits]), DU(), to);
        return hwy::PopCount(bits);
#else
        return simd::compress_store(DU(), items, mask_of(bits), to);
#endif
    }
    HWY_INLINE void emit(const std::uint32_t* ids, std::uint32_t in, std::uint32_t across, std::uint32_t unsure) {
        const VU items = hn::LoadU(DU(), ids);
        inside += append(items, in, lists.inside + inside);
        straddling += append(items, across, lists.straddling + straddling);
        if (HWY_UNLIKELY(unsure != 0)) undecided += append(items, unsure, lists.undecided + undecided);
    }
};

// As Walk::visit_crossing().
std::size_t wide_lanes(const LaneInput& input, const LaneLists& lists) {
    const DU du;
    LaneOutput out{lists};
    for (std::size_t i = 0; i < input.leaves; ++i) {
        const LeafPlane plane{input.pair_planes + i % input.planes_each, input.at[i]};
        for (std::size_t l = 0; l < 16; l += hn::Lanes(du)) {
            const MF present = hn::FirstN(DF(), input.wide[i].count - l);
            const BoxTest test = test_leaf(LeafRows(input.wide[i], l), present, plane);
            const VU items = hn::LoadU(du, input.ids + 16 * i + l);
            const auto of = [&](MF mask) HWY_ATTR { return hn::RebindMask(du, mask); };
            out.inside += simd::compress_store(du, items, of(test.inside), lists.inside + out.inside);
            out.straddling += simd::compress_store(du, items, of(test.straddling), lists.straddling + out.straddling);
            if (HWY_UNLIKELY(!hn::AllFalse(DF(), test.undecided)))
                out.undecided += simd::compress_store(du, items, of(test.undecided), lists.undecided + out.undecided);
        }
    }
    return out.inside + out.straddling + out.undecided;
}

#if HWY_TARGET == HWY_SCALAR
std::size_t narrow_lanes(const LaneInput& input, const LaneLists& lists) {
    return wide_lanes(input, lists);
}
#else
using D16 = hn::CappedTag<std::int16_t, 16>;
using V16 = hn::Vec<D16>;

HWY_INLINE std::uint32_t bits_of_16(hn::Mask<D16> mask) {
#if HWY_TARGET == HWY_AVX2
    const __m256i lanes = hn::VecFromMask(D16(), mask).raw;
    const __m128i bytes = _mm_packs_epi16(_mm256_castsi256_si128(lanes), _mm256_extracti128_si256(lanes, 1));
    return static_cast<std::uint32_t>(_mm_movemask_epi8(bytes));
#else
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(D16(), mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
#endif
}

// Σ normal · row, each product rounded.
HWY_INLINE V16 narrow_dot(V16 sum, const std::int16_t (*rows)[16], std::size_t l, const V16 (&normal)[3]) {
    for (unsigned j = 0; j < 3; ++j) sum = hn::Add(sum, hn::MulFixedPoint15(hn::Load(D16(), rows[j] + l), normal[j]));
    return sum;
}

std::size_t narrow_lanes(const LaneInput& input, const LaneLists& lists) {
    const D16 d;
    LaneOutput out{lists};
    for (std::size_t i = 0; i < input.leaves; ++i) {
        const NarrowLeaf& leaf = input.narrow[i];
        const NarrowPlane& plane = input.planes[i];
        const V16 normal[3] = {hn::Set(d, plane.normal[0]), hn::Set(d, plane.normal[1]), hn::Set(d, plane.normal[2])};
        const V16 error_bound = hn::Set(d, plane.error_bound);
        const std::uint32_t used = (std::uint32_t{1} << input.wide[i].count) - 1;
        for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
            const V16 middle = narrow_dot(hn::Set(d, plane.offset), leaf.center, l, normal);
            V16 sum = hn::Zero(d);
            for (unsigned k = 0; k < 3; ++k)
                sum = hn::Add(sum, hn::Abs(narrow_dot(hn::Zero(d), leaf.edge + 3 * k, l, normal)));
            const V16 projected_radius = hn::ShiftRightSame(sum, input.wide[i].edge_shift);
            const V16 across = hn::Sub(projected_radius, hn::Abs(middle));
            const V16 bottom = hn::Sub(hn::Max(middle, hn::Zero(d)), projected_radius);
            const auto cuts = hn::Gt(across, error_bound), sure = hn::Gt(hn::Abs(across), error_bound),
                       inside = hn::Gt(bottom, error_bound);
            const std::uint32_t present = used >> l;
            const std::uint32_t in = bits_of_16(inside) & present, cut = bits_of_16(cuts) & present,
                                unsure = ~bits_of_16(sure) & present;
            constexpr std::uint32_t kLanes = hn::MaxLanes(DU()), kMask = (2u << (kLanes - 1)) - 1;
            for (std::uint32_t m = 0; m < hn::Lanes(d); m += kLanes)
                out.emit(input.ids + 16 * i + l + m, in >> m & kMask, cut >> m & kMask, unsure >> m & kMask);
        }
    }
    return out.inside + out.straddling + out.undecided;
}
#endif

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {
HWY_EXPORT(wide_lanes);
HWY_EXPORT(narrow_lanes);
namespace {

// The same random boxes in both forms, and planes that cut each leaf anywhere.
struct Leaves {
    std::vector<boxtree::Leaf> wide;
    std::vector<NarrowLeaf> narrow;
    std::vector<PairPlane> pair_planes;
    std::vector<BlockPlane> at;
    std::vector<NarrowPlane> planes;
    std::vector<std::uint32_t> ids, lists[3];

    explicit Leaves(std::size_t count)
        : wide(count), narrow(count), pair_planes(count), at(count), planes(count), ids(16 * count) {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (auto& list : lists) list.resize(16 * count + 32);
        for (std::size_t i = 0; i < count; ++i) {
            for (unsigned l = 0; l < 16; ++l) fill(i, l, random, unit);
            wide[i].count = 16;
            wide[i].edge_shift = 2;
            double normal[3] = {unit(random), unit(random), unit(random)};
            const double length = std::hypot(normal[0], normal[1], normal[2]);
            for (double& n : normal) n /= length;
            pair_planes[i] = pair_plane_of(normal);
            const double offset = 4000.0 * unit(random);
            at[i] = {static_cast<std::int32_t>(offset * 4 * 0x1p14), 1 << 16};
            for (unsigned j = 0; j < 3; ++j)
                planes[i].normal[j] = static_cast<std::int16_t>(std::lround(normal[j] * 32767.0));
            planes[i].offset = static_cast<std::int16_t>(std::lround(offset));
            planes[i].error_bound = 6;
        }
    }

    void fill(std::size_t i, unsigned l, std::mt19937_64& random, std::uniform_real_distribution<double>& unit) {
        int center[3], edge[9];
        for (int& c : center) c = static_cast<int>(8191.0 * unit(random));
        for (int& e : edge) e = static_cast<int>(4000.0 * unit(random));
        for (unsigned j = 0; j < 3; ++j) narrow[i].center[j][l] = static_cast<std::int16_t>(center[j]);
        for (unsigned j = 0; j < 9; ++j) narrow[i].edge[j][l] = static_cast<std::int16_t>(edge[j]);
        boxtree::Leaf& leaf = wide[i];
        using boxtree::pair_of;
        leaf.xy[l] = pair_of(4 * center[0], 4 * center[1]);
        leaf.z_edge2_z[l] = pair_of(4 * center[2], 4 * edge[8]);
        for (unsigned k = 0; k < 3; ++k) leaf.edge_xy[k][l] = pair_of(4 * edge[3 * k], 4 * edge[3 * k + 1]);
        leaf.edge01_z[l] = pair_of(4 * edge[2], 4 * edge[5]);
        ids[16 * i + l] = static_cast<std::uint32_t>(16 * i + l);
    }
};

template <class Run>
void leaf_lanes(benchmark::State& state, const Run& run) {
    Leaves leaves(static_cast<std::size_t>(state.range(0)));
    const LaneInput input{leaves.wide.data(),   leaves.narrow.data(), leaves.pair_planes.data(), leaves.at.data(),
                          leaves.planes.data(), leaves.ids.data(),    leaves.wide.size(),        leaves.wide.size()};
    const LaneLists lists{leaves.lists[0].data(), leaves.lists[1].data(), leaves.lists[2].data()};
    std::size_t listed = 0;
    for (auto _ : state) {
        listed = run(input, lists);
        benchmark::DoNotOptimize(leaves.lists[0].data());
    }
    state.counters["listed"] = static_cast<double>(listed);
    state.counters["ns_a_leaf"] =
        benchmark::Counter(static_cast<double>(leaves.wide.size()) * 1e-9,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void leaf_lanes_wide(benchmark::State& state) {
    leaf_lanes(state, [](const LaneInput& input, const LaneLists& lists) {
        return HWY_DYNAMIC_DISPATCH(wide_lanes)(input, lists);
    });
}
void leaf_lanes_narrow(benchmark::State& state) {
    leaf_lanes(state, [](const LaneInput& input, const LaneLists& lists) {
        return HWY_DYNAMIC_DISPATCH(narrow_lanes)(input, lists);
    });
}
// In the innermost cache, the second and the last.
BENCHMARK(leaf_lanes_wide)->Arg(32)->Arg(256)->Arg(4096);
BENCHMARK(leaf_lanes_narrow)->Arg(32)->Arg(256)->Arg(4096);

}  // namespace
}  // namespace crofton::cull
#endif
