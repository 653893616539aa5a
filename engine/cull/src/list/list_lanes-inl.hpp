// SPDX-License-Identifier: MIT
// A list's records, gathered from wherever they lie and turned into lanes. Compiled once per instruction set (Highway).
#include <crofton/cull/list_layout.hpp>
#include <cstring>

#include "list/ball_tests-inl.hpp"
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_LIST_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LIST_LANES_INL
#undef CROFTON_CULL_LIST_LANES_INL
#else
#define CROFTON_CULL_LIST_LANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

inline constexpr std::size_t kBatch = 128;

// Records copied next to each other, as rows of four numbers that lanes are loaded from interleaved.
template <class Record>
struct Batch {
    static constexpr std::size_t kQuads = sizeof(Record) / 16;
    alignas(64) float quads[kQuads][kBatch][4];

    HWY_INLINE void copy(std::size_t to, const Record& record) {
        for (std::size_t q = 0; q < kQuads; ++q)
            std::memcpy(quads[q][to], reinterpret_cast<const char*>(&record) + 16 * q, 16);
    }
    HWY_INLINE void load(std::size_t quad, std::size_t at, VF& a, VF& b, VF& c, VF& d) const {
        hn::LoadInterleaved4(DF(), quads[quad][at], a, b, c, d);
    }
};

HWY_INLINE BoxLanes lanes_of(const Batch<BoxRecord>& batch, std::size_t at, std::size_t count) {
    BoxLanes boxes;
    VF first, pairs[4];
    batch.load(0, at, boxes.x, boxes.y, boxes.z, first);
    batch.load(1, at, pairs[0], pairs[1], pairs[2], pairs[3]);
    const VF radius = hn::BitCast(DF(), hn::ShiftLeft<16>(hn::BitCast(DU(), first)));
    boxes.unit = hn::Mul(radius, hn::Set(DF(), 0x1p-15f));
    // Nine components within one unit of the truth each, Σ|normal| ≤ √3: 5.2 units; the rest covers the sums' rounding.
    boxes.edge_slack = hn::Mul(boxes.unit, hn::Set(DF(), 6.0f));
    boxes.edge[0] = upper_half(hn::BitCast(DU(), first));
    for (unsigned i = 0; i < 4; ++i) {
        boxes.edge[2 * i + 1] = lower_half(hn::BitCast(DU(), pairs[i]));
        boxes.edge[2 * i + 2] = upper_half(hn::BitCast(DU(), pairs[i]));
    }
    boxes.present = hn::FirstN(DF(), count);
    return boxes;
}

// Half extents in the place of half edges.
struct AabbLanes {
    VF x, y, z, unit, half[3], error;
    MF present;

    HWY_INLINE VF slope(const KernelPlane& plane, unsigned k) const {
        return hn::Mul(hn::Set(DF(), plane.normal_f[k]), half[k]);
    }
    HWY_INLINE VF reach(const KernelPlane& plane) const {
        const VF sum = hn::Add(hn::Add(hn::Abs(slope(plane, 0)), hn::Abs(slope(plane, 1))), hn::Abs(slope(plane, 2)));
        return hn::Mul(sum, unit);
    }
    HWY_INLINE VF slack(LocalPlane local) const { return hn::Add(error, hn::Set(DF(), local.slack)); }
};

HWY_INLINE AabbLanes lanes_of(const Batch<AabbRecord>& batch, std::size_t at, std::size_t count) {
    AabbLanes boxes;
    batch.load(0, at, boxes.x, boxes.y, boxes.z, boxes.unit);
    batch.load(1, at, boxes.half[0], boxes.half[1], boxes.half[2], boxes.error);
    boxes.present = hn::FirstN(DF(), count);
    return boxes;
}

HWY_INLINE SphereLanes lanes_of(const Batch<SphereRecord>& batch, std::size_t at, std::size_t count) {
    SphereLanes spheres;
    batch.load(0, at, spheres.x, spheres.y, spheres.z, spheres.radius);
    spheres.present = hn::FirstN(DF(), count);
    return spheres;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
