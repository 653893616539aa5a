// SPDX-License-Identifier: MIT
// A list's records, gathered from wherever they lie and turned into lanes. Compiled once per instruction set (Highway).
#include <crofton/cull/list_layout.hpp>
#include <crofton/simd/gather_rows-inl.hpp>

#include "list/sphere_tests-inl.hpp"
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_LIST_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LIST_LANES_INL
#undef CROFTON_CULL_LIST_LANES_INL
#else
#define CROFTON_CULL_LIST_LANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// A record's numbers 4 q to 4 q + 3.
template <class Record>
HWY_INLINE simd::Row row_of(const Record& record, std::size_t q) {
    return simd::load_row(reinterpret_cast<const unsigned char*>(&record) + 16 * q);
}

// Gathers records into lanes: lane l has records[which[l]].
template <class Records>
struct Picked {
    const Records& records;
    const std::uint32_t* which;  // one for each lane

    HWY_INLINE void load(std::size_t q, VF& a, VF& b, VF& c, VF& d) const {
        VF out[4];
        simd::gather_rows(
            DF(), [&](std::size_t l) HWY_ATTR { return row_of(records[which[l]], q); }, out);
        a = out[0];
        b = out[1];
        c = out[2];
        d = out[3];
    }
};

template <class Record>
using PickedRecords = Picked<const Record*>;

HWY_INLINE BoxLanes lanes_of(const PickedRecords<BoxRecord>& picked, std::size_t count) {
    BoxLanes boxes;
    VF first, pairs[4];
    picked.load(0, boxes.x, boxes.y, boxes.z, first);
    picked.load(1, pairs[0], pairs[1], pairs[2], pairs[3]);
    const VF radius = hn::BitCast(DF(), hn::ShiftLeft<16>(hn::BitCast(DU(), first)));
    boxes.unit = hn::Mul(radius, hn::Set(DF(), 0x1p-15f));
    // Nine components within one unit of the truth each, Σ|normal| ≤ √3: 5.2 units; the rest covers the sums' rounding.
    boxes.edge_error_bound = hn::Mul(boxes.unit, hn::Set(DF(), 6.0f));
    boxes.edge[0] = upper_half(hn::BitCast(DU(), first));
    for (unsigned i = 0; i < 4; ++i) {
        boxes.edge[2 * i + 1] = lower_half(hn::BitCast(DU(), pairs[i]));
        boxes.edge[2 * i + 2] = upper_half(hn::BitCast(DU(), pairs[i]));
    }
    boxes.present = hn::FirstN(DF(), count);
    return boxes;
}

// Aligned boxes, with half extents in the place of half edges.
struct AabbLanes {
    VF x, y, z, unit, half[3], error;
    MF present;

    HWY_INLINE VF slope(const KernelPlane& plane, unsigned k) const {
        return hn::Mul(hn::Set(DF(), plane.normal_f[k]), half[k]);
    }
    HWY_INLINE VF projected_radius(const KernelPlane& plane) const {
        const VF sum = hn::Add(hn::Add(hn::Abs(slope(plane, 0)), hn::Abs(slope(plane, 1))), hn::Abs(slope(plane, 2)));
        return hn::Mul(sum, unit);
    }
    HWY_INLINE VF error_bound(LocalPlane local) const { return hn::Add(error, hn::Set(DF(), local.error_bound)); }
};

HWY_INLINE AabbLanes lanes_of(const PickedRecords<AabbRecord>& picked, std::size_t count) {
    AabbLanes boxes;
    picked.load(0, boxes.x, boxes.y, boxes.z, boxes.unit);
    picked.load(1, boxes.half[0], boxes.half[1], boxes.half[2], boxes.error);
    boxes.present = hn::FirstN(DF(), count);
    return boxes;
}

HWY_INLINE SphereLanes lanes_of(const PickedRecords<SphereRecord>& picked, std::size_t count) {
    SphereLanes spheres;
    picked.load(0, spheres.x, spheres.y, spheres.z, spheres.radius);
    spheres.present = hn::FirstN(DF(), count);
    return spheres;
}

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
