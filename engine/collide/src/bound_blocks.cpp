// The broadphase's kernels, compiled for each instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bound_blocks.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>

#include "block_filter.hpp"
#include "bound_blocks.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kBoxBlock>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE std::uint32_t bits_of(D d, M mask, std::size_t l) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return (static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8) << l;
}

// The reach has five roundings of 2^-24, the centre two and the difference one of their sum.
std::uint32_t BoundBoxes(const BoxBlock& boxes, BoundBlock& bounds) {
    const D d;
    std::uint32_t suspect = 0;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        V h[3], sum = hn::Zero(d);
        M good = hn::Lt(hn::Load(d, boxes.deviation + l), hn::Set(d, 0.9e-4f));
        for (int k = 0; k < 3; ++k) {
            h[k] = hn::Load(d, boxes.half[k] + l);
            good = hn::And(good, hn::And(hn::Ge(h[k], hn::Zero(d)), hn::Lt(h[k], hn::Set(d, 0.9e30f))));
        }
        for (int i = 0; i < 3; ++i) {
            const V c = hn::Load(d, boxes.center[i] + l);
            good = hn::And(good, hn::Lt(hn::Abs(c), hn::Set(d, 0.9e30f)));
            V reach = hn::Mul(h[0], hn::Abs(hn::Load(d, boxes.axes[0][i] + l)));
            reach = hn::MulAdd(h[1], hn::Abs(hn::Load(d, boxes.axes[1][i] + l)), reach);
            reach = hn::MulAdd(h[2], hn::Abs(hn::Load(d, boxes.axes[2][i] + l)), reach);
            const V share = hn::MulAdd(hn::Abs(c), hn::Set(d, 0x2.2p-24f), hn::Set(d, 1e-37f));
            reach = hn::Add(hn::MulAdd(reach, hn::Set(d, 0x7p-24f), share), reach);
            hn::Store(hn::Sub(c, reach), d, bounds.low[i] + l);
            hn::Store(hn::Add(c, reach), d, bounds.high[i] + l);
            sum = hn::Add(sum, reach);
        }
        suspect |= bits_of(d, hn::Not(good), l);
    }
    return suspect;
}

void BoundBlocks(const BoundBlock* blocks, std::size_t begin, std::size_t end, BoundBlock* above) {
    const D d;
    for (std::size_t b = begin; b < end; ++b)
        for (int i = 0; i < 3; ++i) {
            V low = hn::Load(d, blocks[b].low[i]), high = hn::Load(d, blocks[b].high[i]);
            for (std::size_t l = hn::Lanes(d); l < kBoxBlock; l += hn::Lanes(d)) {
                low = hn::Min(low, hn::Load(d, blocks[b].low[i] + l));
                high = hn::Max(high, hn::Load(d, blocks[b].high[i] + l));
            }
            above[b / kBoxBlock].low[i][b % kBoxBlock] = hn::GetLane(hn::MinOfLanes(d, low));
            above[b / kBoxBlock].high[i][b % kBoxBlock] = hn::GetLane(hn::MaxOfLanes(d, high));
        }
}

// Lanes of `block` whose bounds meet lane `lane` of `other`.
HWY_INLINE std::uint32_t meet(const BoundBlock& block, const BoundBlock& other, std::size_t lane) {
    const D d;
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        M both = hn::And(hn::Le(hn::Load(d, block.low[0] + l), hn::Set(d, other.high[0][lane])),
                         hn::Ge(hn::Load(d, block.high[0] + l), hn::Set(d, other.low[0][lane])));
        for (int i = 1; i < 3; ++i) {
            both = hn::And(both, hn::Le(hn::Load(d, block.low[i] + l), hn::Set(d, other.high[i][lane])));
            both = hn::And(both, hn::Ge(hn::Load(d, block.high[i] + l), hn::Set(d, other.low[i][lane])));
        }
        bits |= bits_of(d, both, l);
    }
    return bits;
}

HWY_INLINE std::size_t lowest(std::uint32_t bits) {
    return hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
}

HWY_INLINE void put(SlotPairs& pairs, std::size_t a, std::size_t base, std::uint32_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1)
        pairs.data[pairs.count++] = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(base + lowest(lanes))};
}

// Leaves a ≤ b, whose bounds are lanes of the blocks above them. Only lanes that meet the other leaf's bound are tried,
// from the side that has fewer of them.
HWY_INLINE void compare_leaves(const BoundTree& tree, std::size_t a, std::size_t b, SlotPairs& pairs) {
    const BoundBlock &in_a = tree.levels[0][a], &in_b = tree.levels[0][b];
    ++pairs.leaf_pairs;
    if (a == b) {
        for (std::size_t lane = 0; lane + 1 < kBoxBlock; ++lane)
            put(pairs, a * kBoxBlock + lane, b * kBoxBlock, meet(in_a, in_a, lane) & (~std::uint32_t{1} << lane));
        return;
    }
    std::uint32_t near_a = meet(in_a, tree.levels[1][b / kBoxBlock], b % kBoxBlock);
    if (near_a == 0) return;
    std::uint32_t near_b = meet(in_b, tree.levels[1][a / kBoxBlock], a % kBoxBlock);
    if (hwy::PopCount(near_a) <= hwy::PopCount(near_b)) {
        for (; near_a != 0; near_a &= near_a - 1) {
            const std::size_t lane = lowest(near_a);
            put(pairs, a * kBoxBlock + lane, b * kBoxBlock, meet(in_b, in_a, lane) & near_b);
        }
    } else {
        for (; near_b != 0; near_b &= near_b - 1) {
            const std::size_t lane = lowest(near_b);
            put(pairs, b * kBoxBlock + lane, a * kBoxBlock, meet(in_a, in_b, lane) & near_a);
        }
    }
}

void FindPairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow) {
    struct Step {
        std::size_t level, block;
    };
    Step stack[kMaxLevels * kBoxBlock];
    const std::size_t top = tree.level_count - 1;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
        const BoundBlock& query = tree.levels[1][leaf / kBoxBlock];
        std::size_t height = 0;
        stack[height++] = {top, 0};
        while (height > 0) {
            const Step step = stack[--height];
            std::uint32_t lanes = meet(tree.levels[step.level][step.block], query, leaf % kBoxBlock);
            // Leaves before this one have met it already: leave out subtrees that end before it.
            std::size_t leaves_per_lane = 1;
            for (std::size_t k = 1; k < step.level; ++k) leaves_per_lane *= kBoxBlock;
            const std::size_t first = step.block * kBoxBlock, own = leaf / leaves_per_lane;
            if (own > first) lanes &= own - first < kBoxBlock ? ~std::uint32_t{0} << (own - first) : 0;
            for (; lanes != 0; lanes &= lanes - 1) {
                const std::size_t child = first + lowest(lanes);
                if (step.level > 1) {
                    stack[height++] = {step.level - 1, child};
                    continue;
                }
                if (pairs.capacity - pairs.count < kBoxBlock * kBoxBlock && !grow(pairs)) return;
                compare_leaves(tree, leaf, child, pairs);
            }
        }
    }
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(BoundBoxes);
HWY_EXPORT(BoundBlocks);
HWY_EXPORT(FindPairs);

std::uint32_t bound_boxes(BoxBlock& boxes, BoundBlock& bounds) {
    measure_deviation(boxes);
    return HWY_DYNAMIC_DISPATCH(BoundBoxes)(boxes, bounds);
}
void bound_blocks(const BoundBlock* blocks, std::size_t begin, std::size_t end, BoundBlock* above) {
    HWY_DYNAMIC_DISPATCH(BoundBlocks)(blocks, begin, end, above);
}
void find_pairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow) {
    HWY_DYNAMIC_DISPATCH(FindPairs)(tree, begin, end, pairs, grow);
}

}  // namespace crofton::collide
#endif
