// SPDX-License-Identifier: MIT
// Nodes and leaves against draw limits, 16 lanes at a time. Compiled once per instruction set (Highway).
#include <hwy/cache_control.h>

#include "lanes-inl.hpp"
#include "limits/kernel_limits.hpp"
#include "tree/block_tests-inl.hpp"

#if defined(CROFTON_CULL_LIMIT_TESTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_CULL_LIMIT_TESTS_INL
#undef CROFTON_CULL_LIMIT_TESTS_INL
#else
#define CROFTON_CULL_LIMIT_TESTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {

// Lanes that the limits certainly drop, and those that they certainly keep: of nodes, with all that is below.
struct LimitTest {
    MF dropped, kept;
};

// For walks without limits.
struct NoLimits {
    static constexpr bool kAny = false;
};

// Tests nodes and leaves against one query's limits.
class LimitTester {
  public:
    static constexpr bool kAny = true;

    HWY_INLINE LimitTester(const KernelLimits& limits, std::uint32_t layer_mask)
        : limits_(limits), layer_mask_(layer_mask) {}

    HWY_INLINE void prefetch(boxtree::NodeId node) const { hwy::Prefetch(limits_.radii_below + node); }

    // The children of a node from lane l on, along its axes. A centre lies in its child's box. 2^-18 of the coordinates
    // covers the roundings of a gap, 2^-10 those of squares and limits.
    HWY_INLINE LimitTest test(const boxtree::Node& node, const boxtree::Axes& axes, boxtree::NodeId id, std::size_t l) {
        const DF d;
        const DU du;
        const NodeRows rows(node, l);
        const VF unit = hn::Set(d, node.unit), zero = hn::Zero(d), trifle = hn::Set(d, 0x1p-18f);
        const VF middle[3] = {lower_half(rows.middle_xy), upper_half(rows.middle_xy), lower_half(rows.middle_half_z)};
        const VF half[3] = {lower_half(rows.half_xy), upper_half(rows.half_xy), upper_half(rows.middle_half_z)};
        VF nearest = zero, farthest = zero;
        const double eye_to_origin[3] = {node.origin[0] - limits_.eye[0], node.origin[1] - limits_.eye[1],
                                         node.origin[2] - limits_.eye[2]};
        for (unsigned j = 0; j < 3; ++j) {
            const VF start = hn::Set(d, static_cast<float>(boxtree::along(axes, j, eye_to_origin)));
            const VF offset = hn::Mul(middle[j], unit), half_size = hn::Mul(half[j], unit);
            const VF size = hn::Add(hn::Add(hn::Abs(start), hn::Abs(offset)), hn::Abs(half_size));
            const VF away = hn::Abs(hn::Add(start, offset)), margin = hn::MulAdd(size, trifle, half_size);
            const VF gap = hn::Max(zero, hn::Sub(away, margin)), most = hn::Add(away, margin);
            nearest = hn::MulAdd(gap, gap, nearest);
            farthest = hn::MulAdd(most, most, farthest);
        }
        const VU radii = hn::Load(du, limits_.radii_below[id].below + l);
        const VF largest = hn::BitCast(d, hn::And(radii, hn::Set(du, 0xffff0000u)));
        const VF smallest = hn::BitCast(d, hn::ShiftLeft<16>(radii));
        const VF most = hn::MulAdd(largest, largest, hn::Set(d, 1e-36f)), least = hn::Mul(smallest, smallest);
        LimitTest result{over(nearest, most, layer_limits(node.layers_any + l)), hn::FirstN(d, 0)};
        if (limits_.has_items) return result;
        result.kept = within(farthest, least, layer_limits(node.layers_any + l, true));
        return result;
    }

    // A centre is within √3/2 of a position_unit of its lane's, half edges' components within half an edge_unit. The
    // rounding of origin − eye is below 2^-20 of the coordinates. Axes are orthonormal to 1e-4.
    HWY_INLINE LimitTest test(const boxtree::Leaf& leaf, std::size_t l) {
        const DF d;
        const DU du;
        const VF zero = hn::Zero(d), unit = hn::Set(d, leaf.position_unit);
        const VU xy = hn::Load(du, leaf.xy + l), z_edge = hn::Load(du, leaf.z_edge2_z + l),
                 edge01_z = hn::Load(du, leaf.edge01_z + l);
        const VF at[3] = {lower_half(xy), upper_half(xy), lower_half(z_edge)};
        VF square = zero, sizes = zero;
        for (unsigned j = 0; j < 3; ++j) {
            const VF start = hn::Set(d, static_cast<float>(leaf.origin[j] - limits_.eye[j]));
            const VF offset = hn::Mul(at[j], unit), step = hn::Add(start, offset);
            square = hn::MulAdd(step, step, square);
            sizes = hn::Add(sizes, hn::Add(hn::Abs(start), hn::Abs(offset)));
        }
        const VF z[3] = {lower_half(edge01_z), upper_half(edge01_z), upper_half(z_edge)};
        VF edges = zero;
        for (unsigned k = 0; k < 3; ++k) {
            const VU pair = hn::Load(du, leaf.edge_xy[k] + l);
            const VF x = lower_half(pair), y = upper_half(pair);
            edges = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z[k], z[k], edges)));
        }
        const VF distance = hn::Sqrt(square), away = hn::MulAdd(sizes, hn::Set(d, 0x1p-20f), unit);
        const VF radius = hn::Mul(hn::Sqrt(edges), hn::Set(d, leaf.edge_unit)),
                 off = hn::MulAdd(radius, hn::Set(d, 1e-3f), hn::Set(d, 2.0f * leaf.edge_unit));
        const auto squared = [&](VF value) HWY_ATTR { return hn::Mul(value, value); };
        const VF nearest = squared(hn::Max(zero, hn::Sub(distance, away))), farthest = squared(hn::Add(distance, away));
        const VF least = squared(hn::Max(zero, hn::Sub(radius, off))), most = squared(hn::Add(radius, off));
        const VF layer_square = layer_limits(leaf.layers + l);
        LimitTest result{over(nearest, hn::Max(most, hn::Set(d, 1e-36f)), layer_square), hn::FirstN(d, 0)};
        if (limits_.has_items) return result;
        result.kept = within(farthest, least, layer_square);
        return result;
    }

  private:
    // Whether the square of a distance, and of a radius, are certainly too large, or too small, even for what was drawn
    // before.
    HWY_INLINE MF over(VF square, VF radius_square, VF layer_square) const {
        const DF d;
        const VF safe = hn::Mul(square, hn::Set(d, 1.0f - 0x1p-10f));
        MF result = hn::Gt(safe, hn::Mul(radius_square, hn::Set(d, limits_.radii[1])));
        const VF grown = hn::Mul(radius_square, hn::Set(d, 1.0f + 0x1p-10f));
        result = hn::Or(result, hn::Lt(grown, hn::Set(d, limits_.least_radius[1])));
        return hn::Or(result, hn::Gt(safe, hn::Mul(layer_square, hn::Set(d, limits_.longer_square))));
    }

    // Squares of the layers' distances. Most items have the layers of the one before.
    HWY_INLINE VF layer_limits(const std::uint32_t* layers, bool least_of_all = false) {
        const DF d;
        const DU du;
        if (!limits_.has_layers) return hn::Inf(d);
        LastLayers& last = last_[least_of_all];
        const VU common = hn::And(hn::Load(du, layers), hn::Set(du, layer_mask_));
        if (HWY_LIKELY(last.is_known && hn::AllTrue(du, hn::Eq(common, hn::Set(du, last.layers)))))
            return hn::Set(d, last.square);
        alignas(64) float squares[boxtree::kWidth];
        for (std::size_t l = 0; l < hn::Lanes(d); ++l) {
            const std::uint32_t of_lane = layers[l] & layer_mask_;
            if (of_lane != last.layers || !last.is_known)
                last = {of_lane, limits_.layer_square(limits_.limits, of_lane, least_of_all), true};
            squares[l] = last.square;
        }
        return hn::Load(d, squares);
    }

    // Whether distances are certainly small enough, and radii large enough, for all items. Squares of distances that
    // floats do not hold keep nothing; of radii they count as what floats hold.
    HWY_INLINE MF within(VF square, VF radius_or_more, VF layer_square) const {
        const DF d;
        const VF radius_square = hn::Min(radius_or_more, hn::Set(d, 3e38f));
        const VF safe = hn::Mul(square, hn::Set(d, 1.0f + 0x1p-10f));
        const VF radii = hn::Set(d, limits_.radii[0]);
        const MF near_enough = hn::Or(hn::Le(safe, hn::Mul(radius_square, radii)), hn::Eq(radii, hn::Inf(d)));
        const MF large =
            hn::Ge(hn::Mul(radius_square, hn::Set(d, 1.0f - 0x1p-10f)), hn::Set(d, limits_.least_radius[0]));
        return hn::And(hn::And(hn::IsFinite(safe), near_enough), hn::And(hn::Le(safe, layer_square), large));
    }

    struct LastLayers {
        std::uint32_t layers = 0;
        float square = 0.0f;
        bool is_known = false;
    };

    const KernelLimits& limits_;
    std::uint32_t layer_mask_;
    LastLayers last_[2];
};

}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
