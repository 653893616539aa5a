// SPDX-License-Identifier: MIT
#include "tree_lanes.hpp"

#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <crofton/simd/mask_bits-inl.hpp>

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, boxtree::kWidth>;
using V = hn::Vec<D>;

// Bounds of lanes along the three axes, relative to the origin.
struct Bounds {
    V middle[3], half[3];
};

HWY_INLINE V lower(D d, const boxtree::Int16x2* row) {
    const hn::RebindToSigned<D> di;
    const auto pair = hn::BitCast(di, hn::Load(hn::RebindToUnsigned<D>(), row));
    return hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(pair)));
}
HWY_INLINE V upper(D d, const boxtree::Int16x2* row) {
    const hn::RebindToSigned<D> di;
    return hn::ConvertTo(d, hn::ShiftRight<16>(hn::BitCast(di, hn::Load(hn::RebindToUnsigned<D>(), row))));
}

// Exact: integers of 16 bits times a power of two.
HWY_INLINE Bounds bounds_of(D d, const boxtree::Node& node, std::size_t l) {
    const V unit = hn::Set(d, node.unit);
    return {{hn::Mul(lower(d, node.middle_xy + l), unit), hn::Mul(upper(d, node.middle_xy + l), unit),
             hn::Mul(lower(d, node.middle_half_z + l), unit)},
            {hn::Mul(lower(d, node.half_xy + l), unit), hn::Mul(upper(d, node.half_xy + l), unit),
             hn::Mul(upper(d, node.middle_half_z + l), unit)}};
}

// The sums of integers are exact too. A centre is off by half a position_unit at most, and each of three half edges by
// half an edge_unit.
HWY_INLINE Bounds bounds_of(D d, const boxtree::Leaf& leaf, std::size_t l) {
    const V position_unit = hn::Set(d, leaf.position_unit), edge_unit = hn::Set(d, leaf.edge_unit);
    const V off = hn::Set(d, 0.5f * leaf.position_unit + 1.5f * leaf.edge_unit);
    const V sum_x = hn::Add(hn::Add(hn::Abs(lower(d, leaf.edge_xy[0] + l)), hn::Abs(lower(d, leaf.edge_xy[1] + l))),
                            hn::Abs(lower(d, leaf.edge_xy[2] + l)));
    const V sum_y = hn::Add(hn::Add(hn::Abs(upper(d, leaf.edge_xy[0] + l)), hn::Abs(upper(d, leaf.edge_xy[1] + l))),
                            hn::Abs(upper(d, leaf.edge_xy[2] + l)));
    const V sum_z = hn::Add(hn::Add(hn::Abs(lower(d, leaf.edge01_z + l)), hn::Abs(upper(d, leaf.edge01_z + l))),
                            hn::Abs(upper(d, leaf.z_edge2_z + l)));
    return {{hn::Mul(lower(d, leaf.xy + l), position_unit), hn::Mul(upper(d, leaf.xy + l), position_unit),
             hn::Mul(lower(d, leaf.z_edge2_z + l), position_unit)},
            {hn::Add(hn::Mul(sum_x, edge_unit), off), hn::Add(hn::Mul(sum_y, edge_unit), off),
             hn::Add(hn::Mul(sum_z, edge_unit), off)}};
}

// Roundings, each of at most 2^-24 of a number no greater than |origin|₁ + l1_radius + half + wide: of the ray's origin
// and direction, of the difference, the half extents, three sums and the product with the inverse (two), and of the
// ray's end. Together they move a slab, seen at any point of the bounds, by less than 2^-20 of that number.
constexpr float kRounding = 0x1p-20f;

HWY_INLINE float size_of(const LaneRay& ray, float l1_radius) {
    const auto magnitude = [](float x) { return x < 0.0f ? -x : x; };
    return magnitude(ray.origin[0]) + magnitude(ray.origin[1]) + magnitude(ray.origin[2]) + l1_radius + ray.slack +
           (ray.wide[0] + ray.wide[1] + ray.wide[2]);
}

template <class Block>
HWY_INLINE std::uint32_t along(const Block& block, const LaneRay& ray, float* entry) {
    const D d;
    const float size = size_of(ray, block.l1_radius);
    const std::uint32_t used = (1u << block.count) - 1u;
    if (!(size < 1e30f)) {  // beyond what the filter can tell
        for (unsigned lane = 0; lane < boxtree::kWidth; ++lane) entry[lane] = 0.0f;
        return used;
    }
    const V grow = hn::Set(d, 1.0f + kRounding);
    const float error_bound = kRounding * size;
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(d)) {
        const Bounds bounds = bounds_of(d, block, l);
        V first = hn::Zero(d), last = hn::Set(d, ray.limit);
        for (int k = 0; k < 3; ++k) {
            const V offset = hn::Sub(bounds.middle[k], hn::Set(d, ray.origin[k]));
            const V half = hn::Add(hn::Mul(bounds.half[k], grow), hn::Set(d, error_bound + ray.wide[k])),
                    inverse = hn::Set(d, ray.inverse[k]);
            const V t0 = hn::Mul(hn::Sub(offset, half), inverse), t1 = hn::Mul(hn::Add(offset, half), inverse);
            first = hn::Max(first, hn::Min(t0, t1));
            last = hn::Min(last, hn::Max(t0, t1));
        }
        hn::StoreU(first, d, entry + l);
        lanes |= simd::mask_bits(d, hn::Le(first, last)) << l;
    }
    return lanes & used;
}

// Half extents are rounded, at most four times by 2^-24 of themselves, and made wider by more. That covers differences
// in double, too, of 2^-39 units, as half extents are half a unit at least. All else is safe: middles are exact, and
// roundings of a sum and of the box's end keep the order of the numbers that they round.
template <class Block>
HWY_INLINE std::uint32_t within(const Block& block, const LaneBox& box) {
    const D d;
    const V grow = hn::Set(d, 1.0f + kRounding);
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(d)) {
        const Bounds bounds = bounds_of(d, block, l);
        auto apart = hn::Lt(hn::Zero(d), hn::Zero(d));
        for (int k = 0; k < 3; ++k) {
            const V half = hn::Mul(bounds.half[k], grow);
            apart = hn::Or(apart, hn::Gt(hn::Sub(bounds.middle[k], half), hn::Set(d, box.high[k])));
            apart = hn::Or(apart, hn::Lt(hn::Add(bounds.middle[k], half), hn::Set(d, box.low[k])));
        }
        lanes |= simd::mask_bits(d, hn::Not(apart)) << l;
    }
    return lanes & ((1u << block.count) - 1u);
}

// Along each axis the distance less than all roundings: each is at most 2^-24 of a number no greater than the box's
// largest coordinate + l1_radius + half, of the box's ends, the half extents, two sums, and the axis' own length. The
// squares and their sum round by less than 2^-21 of themselves. Distances are limited so that squares are finite.
template <class Block>
HWY_INLINE std::uint32_t near(const Block& block, const LaneBox& box, float limit, float* squares) {
    const D d;
    const auto magnitude = [](float x) { return x < 0.0f ? -x : x; };
    float size = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const float low = magnitude(box.low[k]), high = magnitude(box.high[k]);
        size = low > size ? low : size;
        size = high > size ? high : size;
    }
    size += block.l1_radius;
    const std::uint32_t used = (1u << block.count) - 1u;
    if (!(size < 1e30f)) {  // beyond what the filter can tell
        for (unsigned lane = 0; lane < boxtree::kWidth; ++lane) squares[lane] = 0.0f;
        return used;
    }
    const V error_bound = hn::Set(d, kRounding * size), grow = hn::Set(d, 1.0f + kRounding);
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(d)) {
        const Bounds bounds = bounds_of(d, block, l);
        V squared = hn::Zero(d);
        for (int k = 0; k < 3; ++k) {
            const V half = hn::Add(hn::Mul(bounds.half[k], grow), error_bound);
            const V above = hn::Sub(hn::Sub(bounds.middle[k], half), hn::Set(d, box.high[k])),
                    below = hn::Sub(hn::Set(d, box.low[k]), hn::Add(bounds.middle[k], half));
            const V gap = hn::Min(hn::Max(hn::Zero(d), hn::Max(above, below)), hn::Set(d, 1e17f));
            squared = hn::Add(squared, hn::Mul(gap, gap));
        }
        hn::StoreU(squared, d, squares + l);
        lanes |= simd::mask_bits(d, hn::Le(squared, hn::Set(d, limit))) << l;
    }
    return lanes & used;
}

std::uint32_t NodeAlong(const boxtree::Node& node, const LaneRay& ray, float* entry) {
    return along(node, ray, entry);
}
std::uint32_t LeafAlong(const boxtree::Leaf& leaf, const LaneRay& ray, float* entry) {
    return along(leaf, ray, entry);
}
std::uint32_t NodeNear(const boxtree::Node& node, const LaneBox& box, float limit, float* gaps) {
    return near(node, box, limit, gaps);
}
std::uint32_t LeafNear(const boxtree::Leaf& leaf, const LaneBox& box, float limit, float* gaps) {
    return near(leaf, box, limit, gaps);
}
std::uint32_t NodeWithin(const boxtree::Node& node, const LaneBox& box) {
    return within(node, box);
}
std::uint32_t LeafWithin(const boxtree::Leaf& leaf, const LaneBox& box) {
    return within(leaf, box);
}

}  // namespace
}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(NodeAlong);
HWY_EXPORT(LeafAlong);
HWY_EXPORT(NodeNear);
HWY_EXPORT(LeafNear);
HWY_EXPORT(NodeWithin);
HWY_EXPORT(LeafWithin);

std::uint32_t lanes_along(const boxtree::Node& node, const LaneRay& ray, float* entry) {
    return HWY_DYNAMIC_DISPATCH(NodeAlong)(node, ray, entry);
}
std::uint32_t lanes_along(const boxtree::Leaf& leaf, const LaneRay& ray, float* entry) {
    return HWY_DYNAMIC_DISPATCH(LeafAlong)(leaf, ray, entry);
}
std::uint32_t lanes_near(const boxtree::Node& node, const LaneBox& box, float limit, float* gaps) {
    return HWY_DYNAMIC_DISPATCH(NodeNear)(node, box, limit, gaps);
}
std::uint32_t lanes_near(const boxtree::Leaf& leaf, const LaneBox& box, float limit, float* gaps) {
    return HWY_DYNAMIC_DISPATCH(LeafNear)(leaf, box, limit, gaps);
}
std::uint32_t lanes_within(const boxtree::Node& node, const LaneBox& box) {
    return HWY_DYNAMIC_DISPATCH(NodeWithin)(node, box);
}
std::uint32_t lanes_within(const boxtree::Leaf& leaf, const LaneBox& box) {
    return HWY_DYNAMIC_DISPATCH(LeafWithin)(leaf, box);
}

}  // namespace crofton::collide
#endif
