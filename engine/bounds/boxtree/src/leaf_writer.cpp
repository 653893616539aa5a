// SPDX-License-Identifier: MIT
#include "leaf_writer.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/boxtree/valid_boxes.hpp>
#include <cstddef>
#include <cstring>

// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::boxtree::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kWidth>;
using DD = hn::CappedTag<double, kWidth>;
using VF = hn::Vec<DF>;

// The numbers of an Obb, in its order: a centre, three axes, three half extents.
constexpr std::size_t kBoxBytes = 72, kShapeBytes = 24;
constexpr float kMostCoordinate = 1e30f;  // of an Obb; the float is a little more

// Sixteen boxes side by side. Centres are as they are; a shape's twelve numbers are three rows of four, from which
// lanes are loaded interleaved.
struct Sixteen {
    alignas(64) double center[3][kWidth];
    alignas(64) float shape[3][kWidth][4];

    HWY_INLINE void put(std::size_t lane, const unsigned char* box) {
        for (std::size_t j = 0; j < 3; ++j) std::memcpy(&center[j][lane], box + 8 * j, 8);
        for (std::size_t q = 0; q < 3; ++q) std::memcpy(shape[q][lane], box + kShapeBytes + 16 * q, 16);
    }
    // axes[3 k + j] is component j of axis k.
    HWY_INLINE void load(std::size_t l, VF* axes, VF* half) const {
        const DF d;
        hn::LoadInterleaved4(d, shape[0][l], axes[0], axes[1], axes[2], axes[3]);
        hn::LoadInterleaved4(d, shape[1][l], axes[4], axes[5], axes[6], axes[7]);
        hn::LoadInterleaved4(d, shape[2][l], axes[8], half[0], half[1], half[2]);
    }
};

// As Sixteen, with one number a row: for vectors of doubles.
struct Rows {
    alignas(64) float axes[9][kWidth];
    alignas(64) float half[3][kWidth];

    HWY_INLINE explicit Rows(const Sixteen& boxes) {
        const DF d;
        for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
            VF a[9], h[3];
            boxes.load(l, a, h);
            for (std::size_t i = 0; i < 9; ++i) hn::Store(a[i], d, axes[i] + l);
            for (std::size_t k = 0; k < 3; ++k) hn::Store(h[k], d, half[k] + l);
        }
    }
};

// Two numbers that are integers already, as a pair of 16-bit integers.
HWY_INLINE void store_pairs(hn::Vec<DD> lower, hn::Vec<DD> upper, Int16x2* to) {
    const hn::Rebind<std::int32_t, DD> di;
    const auto low = hn::And(hn::DemoteTo(di, lower), hn::Set(di, 0xffff));
    const auto pairs = hn::Or(low, hn::ShiftLeft<16>(hn::DemoteTo(di, upper)));
    const hn::Rebind<Int16x2, DD> du;
    hn::Store(hn::BitCast(du, pairs), du, to);
}

// The boxes of a leaf's items.
HWY_INLINE void collect(const Leaf& leaf, const ItemId* items, const unsigned char* all_boxes, Sixteen& boxes) {
    for (std::size_t lane = 0; lane < leaf.count; ++lane) boxes.put(lane, all_boxes + kBoxBytes * items[lane]);
    for (std::size_t lane = leaf.count; lane < kWidth; ++lane) {
        for (auto& row : boxes.center) row[lane] = 0.0;
        for (auto& row : boxes.shape) std::fill_n(row[lane], 4, 0.0f);
    }
}

// Prefetches what collect and compress read.
HWY_INLINE void prefetch(const Leaf& leaf, const ItemId* items, const unsigned char* all_boxes) {
    for (std::size_t at = 0; at < offsetof(Leaf, layers); at += 64)
        hwy::Prefetch(reinterpret_cast<const char*>(&leaf) + at);
    for (std::size_t lane = 0; lane < kWidth && items[lane] != kNone; ++lane) {
        hwy::Prefetch(all_boxes + kBoxBytes * items[lane]);
        hwy::Prefetch(all_boxes + kBoxBytes * items[lane] + kBoxBytes - 4);
    }
}

HWY_INLINE bool compress(const Sixteen& boxes, Leaf& leaf) {
    const DD d;
    const hn::Rebind<float, DD> df;
    const Rows rows(boxes);
    const auto per_position = hn::Set(d, 1.0 / static_cast<double>(leaf.position_unit)),
               per_edge = hn::Set(d, 1.0 / static_cast<double>(leaf.edge_unit)), most = hn::Set(d, 32767.0),
               magic = hn::Set(d, 0x1.8p52);  // adding it and taking it away rounds to the nearest integer
    auto l1_radius = hn::Zero(d);
    bool fits = true;
    for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
        const auto used = hn::FirstN(d, leaf.count > l ? leaf.count - l : 0);
        auto near = hn::FirstN(d, kWidth);
        const auto rounded = [&](hn::Vec<DD> value) HWY_ATTR {
            value = hn::IfThenElseZero(used, hn::Sub(hn::Add(value, magic), magic));
            near = hn::And(near, hn::Le(hn::Abs(value), most));
            return value;
        };
        hn::Vec<DD> position[3], half[3], sum = hn::Zero(d);
        for (std::size_t j = 0; j < 3; ++j) {
            const auto offset = hn::Sub(hn::Load(d, boxes.center[j] + l), hn::Set(d, leaf.origin[j]));
            position[j] = rounded(hn::Mul(offset, per_position));
            sum = hn::Add(sum, hn::Abs(position[j]));
            half[j] = hn::Mul(hn::PromoteTo(d, hn::Load(df, rows.half[j] + l)), per_edge);
        }
        l1_radius = hn::Max(l1_radius, sum);
        // Scaling by a power of two is exact, and so is a product of two floats in double.
        const auto edge = [&](std::size_t k, std::size_t j) HWY_ATTR {
            return rounded(hn::Mul(hn::PromoteTo(d, hn::Load(df, rows.axes[3 * k + j] + l)), half[k]));
        };
        store_pairs(position[0], position[1], leaf.xy + l);
        store_pairs(position[2], edge(2, 2), leaf.z_edge2_z + l);
        store_pairs(edge(0, 2), edge(1, 2), leaf.edge01_z + l);
        for (std::size_t k = 0; k < 3; ++k) store_pairs(edge(k, 0), edge(k, 1), leaf.edge_xy[k] + l);
        fits = fits && hn::AllTrue(d, near);
    }
    leaf.l1_radius =
        static_cast<float>(hn::GetLane(hn::MaxOfLanes(d, l1_radius))) * leaf.position_unit;  // exact: below 2^17
    leaf.rounding = rounding_of(leaf);
    return fits;
}

std::size_t WriteLanes(Leaf* leaves, const LeafId* ids, std::size_t count, const ItemId* slot_items,
                       const unsigned char* all_boxes) {
    // Two buffers in turn: a wide load right after narrow stores to the same bytes stalls.
    Sixteen boxes[2];
    const auto next = [&](std::size_t i, Sixteen& to) HWY_ATTR {
        collect(leaves[ids[i]], slot_items + std::size_t{ids[i]} * kWidth, all_boxes, to);
    };
    constexpr std::size_t kAhead = 14;
    const auto ask = [&](std::size_t i) {
        prefetch(leaves[ids[i]], slot_items + std::size_t{ids[i]} * kWidth, all_boxes);
    };
    for (std::size_t i = 0; i < std::min(kAhead, count); ++i) ask(i);
    if (count > 0) next(0, boxes[0]);
    for (std::size_t i = 0; i < count; ++i) {
        if (i + kAhead < count) ask(i + kAhead);
        if (i + 1 < count) next(i + 1, boxes[(i + 1) % 2]);
        if (!compress(boxes[i % 2], leaves[ids[i]])) return i;
    }
    return count;
}

// |dot(a, b) − δ| ≤ 1e-4 · 0.99: a float dot of three products of numbers below 1.01 is off by 4 · 2^-24 at most.
HWY_INLINE hn::Mask<DF> is_near(VF dot, float delta) {
    const DF d;
    return hn::Le(hn::Abs(hn::Sub(dot, hn::Set(d, delta))), hn::Set(d, 0.99e-4f));
}

HWY_INLINE bool all_valid(const Sixteen& boxes) {
    const DF d;
    const DD dd;
    bool valid = true;
    for (std::size_t l = 0; l < kWidth; l += hn::Lanes(d)) {
        VF axes[9], half[3];
        boxes.load(l, axes, half);
        auto good = hn::FirstN(d, kWidth);
        for (std::size_t i = 0; i < 3; ++i) {
            good = hn::And(good, hn::And(hn::Ge(half[i], hn::Zero(d)), hn::Lt(half[i], hn::Set(d, kMostCoordinate))));
            for (std::size_t k = i; k < 3; ++k) {
                VF dot = hn::Mul(axes[3 * i], axes[3 * k]);
                for (std::size_t j = 1; j < 3; ++j) dot = hn::Add(dot, hn::Mul(axes[3 * i + j], axes[3 * k + j]));
                good = hn::And(good, is_near(dot, i == k ? 1.0f : 0.0f));
            }
        }
        valid = valid && hn::AllTrue(d, good);
    }
    for (std::size_t l = 0; l < kWidth; l += hn::Lanes(dd))
        for (const auto& row : boxes.center)
            valid = valid && hn::AllTrue(dd, hn::Le(hn::Abs(hn::Load(dd, row + l)), hn::Set(dd, 1e30)));
    return valid;
}

std::size_t CountCertainlyValid(const unsigned char* all_boxes, std::size_t count, std::size_t stride) {
    Sixteen boxes[2];
    const auto put = [&](Sixteen& to, std::size_t first) HWY_ATTR {
        for (std::size_t lane = 0; lane < kWidth; ++lane)
            to.put(lane, all_boxes + stride * std::min(first + lane, count - 1));
    };
    if (count > 0) put(boxes[0], 0);
    for (std::size_t first = 0, turn = 0; first < count; first += kWidth, turn ^= 1) {
        if (first + kWidth < count) put(boxes[turn ^ 1], first + kWidth);
        if (!all_valid(boxes[turn])) return first;
    }
    return count;
}

}  // namespace
}  // namespace crofton::boxtree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::boxtree {

HWY_EXPORT(WriteLanes);
HWY_EXPORT(CountCertainlyValid);

std::size_t write_lanes(Leaf* leaves, std::span<const LeafId> ids, const ItemId* slot_items, const Obb* boxes) {
    return HWY_DYNAMIC_DISPATCH(WriteLanes)(leaves, ids.data(), ids.size(), slot_items,
                                            reinterpret_cast<const unsigned char*>(boxes));
}

std::size_t count_certainly_valid(const Obb* boxes, std::size_t count, std::size_t stride) {
    return HWY_DYNAMIC_DISPATCH(CountCertainlyValid)(reinterpret_cast<const unsigned char*>(boxes), count, stride);
}

}  // namespace crofton::boxtree
#endif
