// SPDX-License-Identifier: MIT
#include "limits/limits_kernel.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <crofton/cull/statistics.hpp>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "limits/limits_kernel.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include "tree/leaf_tests-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::cull::HWY_NAMESPACE {
namespace {

// Lanes that the limits certainly drop, and those that they certainly keep.
struct LimitTest {
    MF dropped, kept;
};

// Node by node, leaf by leaf: an entry is a child and the planes that are still to be tested.
class LimitedWalk {
  public:
    LimitedWalk(const TreeKernelInput& input, const KernelLimits& limits, const TreeKernelOutput& output)
        : in_(input), limits_(limits), out_(output) {}

    [[nodiscard]] const TreeKernelOutput& result() const { return out_; }

    void run() {
        children_[0] = 0;
        planes_[0] = (1u << in_.view->plane_count) - 1;
        count_ = 1;
        while (count_ > 0) {
            --count_;
            const std::uint32_t child = children_[count_], planes = planes_[count_];
            if (planes & kWhole)
                accept(child);
            else if (child & boxtree::kLeafBit)
                visit_leaf(child & ~boxtree::kLeafBit, planes);
            else
                visit_node(in_.nodes[child], planes);
        }
    }

  private:
    // In an entry's planes: all below is inside, seen and within its limits.
    static constexpr std::uint32_t kWhole = 1u << 31;

    HWY_INLINE void prefetch(std::uint32_t child, bool is_whole) const {
        const std::uint32_t id = child & ~boxtree::kLeafBit;
        if (!(child & boxtree::kLeafBit)) {
            if (is_whole) return;
            for (std::size_t at = 0; at < offsetof(boxtree::Node, layers_any); at += 64)
                hwy::Prefetch(reinterpret_cast<const char*>(in_.nodes + id) + at);
            return;
        }
        hwy::Prefetch(in_.slot_items + std::size_t{id} * boxtree::kWidth);
        for (std::size_t at = 0; !is_whole && at < offsetof(boxtree::Leaf, layers); at += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(in_.leaves + id) + at);
    }

    void accept(std::uint32_t child) {
        if (child & boxtree::kLeafBit) return copy(child & ~boxtree::kLeafBit, 1);
        const boxtree::LeafRange range = in_.ranges[child];
        if (range.count > 0) return copy(range.first, range.count);
        const boxtree::Node& node = in_.nodes[child];
        for (std::uint32_t lane = node.count; lane-- > 0;) {
            children_[count_] = node.child[lane];
            planes_[count_++] = kWhole;
        }
    }

    void copy(boxtree::LeafId first, std::uint32_t leaves) {
        const DU du;
        for (boxtree::LeafId leaf = first; leaf < first + leaves; ++leaf) {
            const boxtree::ItemId* from = in_.slot_items + std::size_t{leaf} * boxtree::kWidth;
            for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(du))
                hn::StoreU(hn::Load(du, from + l), du, out_.inside + out_.inside_count + l);
            out_.inside_count += in_.leaf_counts[leaf];
            if (kCountStatistics) out_.accepted_whole += in_.leaf_counts[leaf];
        }
    }

    void visit_node(const boxtree::Node& node, std::uint32_t planes) {
        if (kCountStatistics) out_.nodes_tested += node.count;
        const NodeTest test = test_node(*in_.view, node, planes);
        std::uint32_t dropped = 0, kept = 0;
        for (std::size_t l = 0; l < boxtree::kWidth; l += hn::Lanes(DF())) {
            const LimitTest limits = test_limits(node, l);
            dropped |= bits_of(limits.dropped) << l;
            kept |= bits_of(limits.kept) << l;
        }
        const std::uint32_t whole = seen(*in_.view, node, test.alive & test.inside & kept);
        // From the last on, so that the first comes out first.
        const std::uint32_t alive = test.alive & ~dropped;
        for (std::uint32_t lane = boxtree::kWidth; lane-- > 0;)
            if (alive >> lane & 1) {
                prefetch(node.child[lane], whole >> lane & 1);
                children_[count_] = node.child[lane];
                planes_[count_++] = whole >> lane & 1 ? kWhole : test.planes[lane];
            }
    }

    // Children all of whose items are beyond a limit; of distances alone, those that none is. A centre lies in the
    // child's box, a radius is below 1.001 times half the box's diagonal: corners of boxes lie in it, and axes are
    // orthonormal to 1e-4. 2^-18 of the coordinates covers the roundings of a gap, 2^-10 those of squares and limits.
    HWY_INLINE LimitTest test_limits(const boxtree::Node& node, std::size_t l) {
        const DF d;
        const NodeRows rows(node, l);
        const VF unit = hn::Set(d, node.unit), zero = hn::Zero(d), trifle = hn::Set(d, 0x1p-18f);
        const VF middle[3] = {lower_half(rows.middle_xy), upper_half(rows.middle_xy), lower_half(rows.middle_half_z)};
        const VF half[3] = {lower_half(rows.half_xy), upper_half(rows.half_xy), upper_half(rows.middle_half_z)};
        VF nearest = zero, farthest = zero, diagonal = zero;
        for (unsigned j = 0; j < 3; ++j) {
            const VF start = hn::Set(d, static_cast<float>(node.origin[j] - limits_.eye[j]));
            const VF offset = hn::Mul(middle[j], unit), reach = hn::Mul(half[j], unit);
            const VF size = hn::Add(hn::Add(hn::Abs(start), hn::Abs(offset)), hn::Abs(reach));
            const VF away = hn::Abs(hn::Add(start, offset)), margin = hn::MulAdd(size, trifle, reach);
            const VF gap = hn::Max(zero, hn::Sub(away, margin)), most = hn::Add(away, margin);
            nearest = hn::MulAdd(gap, gap, nearest);
            farthest = hn::MulAdd(most, most, farthest);
            diagonal = hn::MulAdd(reach, reach, diagonal);
        }
        const VF radius_square = hn::MulAdd(diagonal, hn::Set(d, 1.01f), hn::Set(d, 1e-36f));
        LimitTest result{over(nearest, radius_square, layer_limits(node.layers_any + l)), hn::FirstN(d, 0)};
        if (limits_.has_items || limits_.has_sizes) return result;
        result.kept = hn::Le(hn::Mul(farthest, hn::Set(d, 1.0f + 0x1p-10f)), layer_limits(node.layers_any + l, true));
        return result;
    }

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
        const VU common = hn::And(hn::Load(du, layers), hn::Set(du, in_.view->layer_mask));
        if (HWY_LIKELY(last.is_known && hn::AllTrue(du, hn::Eq(common, hn::Set(du, last.layers)))))
            return hn::Set(d, last.square);
        alignas(64) float squares[boxtree::kWidth];
        for (std::size_t l = 0; l < hn::Lanes(d); ++l) {
            const std::uint32_t of_lane = layers[l] & in_.view->layer_mask;
            if (of_lane != last.layers || !last.is_known)
                last = {of_lane, limits_.layer_square(limits_.limits, of_lane, least_of_all), true};
            squares[l] = last.square;
        }
        return hn::Load(d, squares);
    }

    // A centre is within √3/2 of a position_unit of its lane's; half edges' components within half an edge_unit, and
    // the rounding of origin − eye is below 2^-20 of the coordinates. Axes are orthonormal to 1e-4.
    HWY_INLINE LimitTest test_limits(const boxtree::Leaf& leaf, std::size_t l) {
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
        const VF safe = hn::Mul(farthest, hn::Set(d, 1.0f + 0x1p-10f));
        const MF in_reach = hn::Or(hn::Le(safe, hn::Mul(least, hn::Set(d, limits_.radii[0]))),
                                   hn::Eq(hn::Set(d, limits_.radii[0]), hn::Inf(d)));
        const MF in_layer = hn::Le(safe, layer_square);
        const MF large = hn::Ge(hn::Mul(least, hn::Set(d, 1.0f - 0x1p-10f)), hn::Set(d, limits_.least_radius[0]));
        result.kept = hn::And(in_reach, hn::And(in_layer, large));
        return result;
    }

    void visit_leaf(boxtree::LeafId id, std::uint32_t straddled) {
        const boxtree::Leaf& leaf = in_.leaves[id];
        if (kCountStatistics) out_.boxes_tested += leaf.count;
        LeafPlane planes[KernelView::kMaxPlanes];
        unsigned count = 0;
        for (std::uint32_t rest = straddled; rest; rest &= rest - 1) {
            const auto i = hwy::Num0BitsBelowLS1Bit_Nonzero32(rest);
            planes[count++] = {&in_.view->pair_planes[i], block_plane(*in_.view, i, leaf)};
        }
        for (std::size_t l = 0; l < boxtree::kWidth && l < leaf.count; l += hn::Lanes(DU())) {
            const LimitTest limits = test_limits(leaf, l);
            const MF lanes =
                hn::AndNot(limits.dropped, present(*in_.view, leaf.layers_every, leaf.layers, leaf.count, l));
            if (hn::AllFalse(DF(), lanes)) continue;
            const MF none = hn::FirstN(DF(), 0);
            BoxTest test{lanes, none, none, none, none};
            if (count == 1) test = test_leaf(LeafRows(leaf, l), lanes, planes[0]);
            if (count > 1) test = test_leaf(leaf, l, lanes, planes, count, in_.exact);
            emit(id, l, test, limits.kept);
        }
    }

    HWY_INLINE void emit(boxtree::LeafId id, std::size_t l, const BoxTest& test, MF kept) {
        const DU du;
        const VU items = hn::Load(du, in_.slot_items + id * boxtree::kWidth + l);
        const auto append = [&](VU values, MF mask, std::uint32_t* list, std::size_t& size) HWY_ATTR {
            size += simd::compress_store(du, values, hn::RebindMask(du, mask), list + size);
        };
        append(items, hn::And(test.inside, kept), out_.inside, out_.inside_count);
        append(items, hn::And(test.straddling, kept), out_.straddling, out_.straddling_count);
        const MF unsure = hn::AndNot(kept, hn::Or(test.inside, test.straddling));
        const VU slots = hn::Iota(du, static_cast<std::uint32_t>(id * boxtree::kWidth + l));
        append(slots, hn::Or(test.undecided, unsure), out_.undecided, out_.undecided_count);
        if (kCountStatistics) out_.improper += hn::CountTrue(DF(), test.improper);
    }

    struct LastLayers {
        std::uint32_t layers = 0;
        float square = 0.0f;
        bool is_known = false;
    };

    const TreeKernelInput& in_;
    const KernelLimits& limits_;
    LastLayers last_[2];
    TreeKernelOutput out_;
    std::uint32_t *children_ = out_.work, *planes_ = out_.work + out_.work_size;  // a stack
    std::size_t count_ = 0;
};

void run_limits(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output) {
    LimitedWalk walk(input, limits, output);
    walk.run();
    output = walk.result();
}

}  // namespace
}  // namespace crofton::cull::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::cull {

HWY_EXPORT(run_limits);

void run_limits_kernel(const TreeKernelInput& input, const KernelLimits& limits, TreeKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(run_limits)(input, limits, output);
}

}  // namespace crofton::cull
#endif
