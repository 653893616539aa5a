// SPDX-License-Identifier: MIT
// The broadphase's kernels, compiled for each instruction set and chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bound_blocks.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/highway.h>
#include <crofton/simd/compress-inl.hpp>

#include "block_filter.hpp"
#include "bound_blocks.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::collide::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, kBoxBlock>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE std::uint32_t bits_of(D d, M mask, std::size_t l) {
    return simd::mask_bits(d, mask) << l;
}

// A projected radius has five roundings of 2^-24, the centre two and the difference one of their sum.
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
            V projected_radius = hn::Mul(h[0], hn::Abs(hn::Load(d, boxes.axes[0][i] + l)));
            projected_radius = hn::MulAdd(h[1], hn::Abs(hn::Load(d, boxes.axes[1][i] + l)), projected_radius);
            projected_radius = hn::MulAdd(h[2], hn::Abs(hn::Load(d, boxes.axes[2][i] + l)), projected_radius);
            const V share = hn::MulAdd(hn::Abs(c), hn::Set(d, 0x2.2p-24f), hn::Set(d, 1e-37f));
            projected_radius = hn::Add(hn::MulAdd(projected_radius, hn::Set(d, 0x7p-24f), share), projected_radius);
            hn::Store(hn::Sub(c, projected_radius), d, bounds.low[i] + l);
            hn::Store(hn::Add(c, projected_radius), d, bounds.high[i] + l);
            sum = hn::Add(sum, projected_radius);
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

constexpr std::size_t kVectors = kBoxBlock / hn::MaxLanes(D());

// The sixteen bounds of a block, in registers.
struct Bounds {
    V low[3][kVectors], high[3][kVectors];
};

HWY_INLINE void load(const BoundBlock& block, Bounds& bounds) {
    const D d;
    for (int i = 0; i < 3; ++i)
        for (std::size_t v = 0; v < kVectors; ++v) {
            bounds.low[i][v] = hn::Load(d, block.low[i] + v * hn::Lanes(d));
            bounds.high[i][v] = hn::Load(d, block.high[i] + v * hn::Lanes(d));
        }
}

// Of vector v: lanes whose bounds meet lane `lane` of `other`. The comparisons do not wait for each other.
HWY_INLINE M meet(const Bounds& bounds, std::size_t v, const BoundBlock& other, std::size_t lane) {
    const D d;
    const M x = hn::And(hn::Le(bounds.low[0][v], hn::Set(d, other.high[0][lane])),
                        hn::Ge(bounds.high[0][v], hn::Set(d, other.low[0][lane])));
    const M y = hn::And(hn::Le(bounds.low[1][v], hn::Set(d, other.high[1][lane])),
                        hn::Ge(bounds.high[1][v], hn::Set(d, other.low[1][lane])));
    const M z = hn::And(hn::Le(bounds.low[2][v], hn::Set(d, other.high[2][lane])),
                        hn::Ge(bounds.high[2][v], hn::Set(d, other.low[2][lane])));
    return hn::And(x, hn::And(y, z));
}

HWY_INLINE std::uint32_t lanes_that_meet(const BoundBlock& block, const BoundBlock& other, std::size_t lane) {
    const D d;
    Bounds bounds;
    load(block, bounds);
    std::uint32_t bits = 0;
    for (std::size_t v = 0; v < kVectors; ++v) bits |= bits_of(d, meet(bounds, v, other, lane), v * hn::Lanes(d));
    return bits;
}

HWY_INLINE std::size_t lowest(std::uint32_t bits) {
    return hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
}

using DI = hn::RebindToUnsigned<D>;

// Writes base + the lanes of `mask` to `out`, and whatever after them up to a whole vector; returns how many.
HWY_INLINE std::size_t put_lanes(M mask, std::uint32_t base, std::uint32_t* out) {
    const DI d;
    const auto lanes = hn::Add(hn::Iota(d, 0), hn::Set(d, base));
    return simd::compress_store(d, lanes, hn::RebindMask(d, mask), out);
}

// A leaf and the boxes gathered to be compared with it.
struct Leaf {
    Bounds bounds;
    std::uint32_t base;  // its first slot
    std::size_t count = 0;
    std::uint32_t near[kCandidates + kBoxBlock];  // slots in other leaves whose bounds meet this leaf's
};

HWY_INLINE void put_pairs(M mask, std::size_t v, std::uint32_t base, std::uint32_t partner, SlotPairs& pairs) {
    const DI d;
    const auto lane = static_cast<std::uint32_t>(v * hn::Lanes(d));
    hn::StoreU(hn::Set(d, partner), d, pairs.second + pairs.count);
    pairs.count += put_lanes(mask, base + lane, pairs.first + pairs.count);
}

// Without branches on what is found: whether two boxes meet is anyone's guess.
HWY_INLINE bool compare_gathered(const BoundTree& tree, Leaf& leaf, SlotPairs& pairs, GrowPairs grow) {
    if (pairs.capacity - pairs.count < kPairRoom && !grow(pairs)) return false;
    for (std::size_t n = 0; n < leaf.count; ++n) {
        const std::uint32_t slot = leaf.near[n];
        const BoundBlock& block = tree.levels[0][slot / kBoxBlock];
        for (std::size_t v = 0; v < kVectors; ++v)
            put_pairs(meet(leaf.bounds, v, block, slot % kBoxBlock), v, leaf.base, slot, pairs);
    }
    leaf.count = 0;
    return true;
}

// Pairs within the leaf: of each lane with those after it.
HWY_INLINE bool compare_own(const BoundBlock& block, Leaf& leaf, SlotPairs& pairs, GrowPairs grow) {
    const D d;
    if (pairs.capacity - pairs.count < kPairRoom && !grow(pairs)) return false;
    for (std::size_t lane = 0; lane + 1 < kBoxBlock; ++lane)
        for (std::size_t v = 0; v < kVectors; ++v) {
            const V lanes = hn::Iota(d, static_cast<float>(v * hn::Lanes(d)));
            const M after = hn::Gt(lanes, hn::Set(d, static_cast<float>(lane)));
            put_pairs(hn::And(after, meet(leaf.bounds, v, block, lane)), v, leaf.base,
                      leaf.base + static_cast<std::uint32_t>(lane), pairs);
        }
    return true;
}

// Leaf `index` against the leaves from it on below blocks `near` of levels[1].
bool compare_leaf(const BoundTree& tree, std::size_t index, const std::uint32_t* near, std::size_t near_count,
                  SlotPairs& pairs, GrowPairs grow) {
    const BoundBlock& own = tree.levels[1][index / kBoxBlock];
    const std::size_t lane = index % kBoxBlock;
    Leaf leaf;
    load(tree.levels[0][index], leaf.bounds);
    leaf.base = static_cast<std::uint32_t>(index * kBoxBlock);
    for (std::size_t n = 0; n < near_count; ++n) {
        const std::size_t first = near[n] * kBoxBlock;
        std::uint32_t leaves = lanes_that_meet(tree.levels[1][near[n]], own, lane);
        if (first <= index) leaves &= ~std::uint32_t{0} << (index - first);
        for (; leaves != 0; leaves &= leaves - 1) {
            const std::size_t other = first + lowest(leaves);
            ++pairs.leaf_pairs;
            if (other == index) {
                if (!compare_own(tree.levels[0][index], leaf, pairs, grow)) return false;
                continue;
            }
            Bounds bounds;
            load(tree.levels[0][other], bounds);
            for (std::size_t v = 0; v < kVectors; ++v)
                leaf.count += put_lanes(meet(bounds, v, own, lane),
                                        static_cast<std::uint32_t>(other * kBoxBlock + v * hn::Lanes(D())),
                                        leaf.near + leaf.count);
            if (leaf.count > kCandidates - kBoxBlock && !compare_gathered(tree, leaf, pairs, grow)) return false;
        }
    }
    return compare_gathered(tree, leaf, pairs, grow);
}

struct NearBlocks {
    static constexpr std::size_t kCapacity = 256;
    std::uint32_t block[kCapacity];
    std::size_t count = 0;
};

// All leaves of a block against those of the blocks near it.
bool compare_block(const BoundTree& tree, std::size_t block, NearBlocks& near, SlotPairs& pairs, GrowPairs grow) {
    const std::size_t begin = block * kBoxBlock, end = HWY_MIN(begin + kBoxBlock, tree.sizes[0]);
    for (std::size_t leaf = begin; leaf < end; ++leaf)
        if (!compare_leaf(tree, leaf, near.block, near.count, pairs, grow)) return false;
    near.count = 0;
    return true;
}

// Descends to the blocks of levels[1], from `block` on, whose bounds meet its own.
bool visit_block(const BoundTree& tree, std::size_t block, SlotPairs& pairs, GrowPairs grow) {
    struct Step {
        std::size_t level, block;
    };
    Step stack[kMaxLevels * kBoxBlock];
    std::size_t height = 0;
    NearBlocks near;
    stack[height++] = {tree.level_count - 1, 0};
    while (height > 0) {
        const Step step = stack[--height];
        if (step.level == 1) {
            near.block[near.count++] = static_cast<std::uint32_t>(step.block);
            if (near.count == NearBlocks::kCapacity && !compare_block(tree, block, near, pairs, grow)) return false;
            continue;
        }
        std::uint32_t lanes =
            lanes_that_meet(tree.levels[step.level][step.block], tree.levels[2][block / kBoxBlock], block % kBoxBlock);
        // Blocks before this one have met it already: leave out subtrees that end before it.
        std::size_t blocks_per_lane = 1;
        for (std::size_t k = 2; k < step.level; ++k) blocks_per_lane *= kBoxBlock;
        const std::size_t first = step.block * kBoxBlock, own = block / blocks_per_lane;
        if (own > first) lanes &= own - first < kBoxBlock ? ~std::uint32_t{0} << (own - first) : 0;
        for (; lanes != 0; lanes &= lanes - 1) stack[height++] = {step.level - 1, first + lowest(lanes)};
    }
    return compare_block(tree, block, near, pairs, grow);
}

void FindPairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow) {
    for (std::size_t block = begin; block < end; ++block)
        if (!visit_block(tree, block, pairs, grow)) return;
}

bool visit_partners(const BoundTree& tree, std::uint32_t slot, SlotPairs& pairs, GrowPairs grow) {
    struct Step {
        std::size_t level, block;
    };
    Step stack[kMaxLevels * kBoxBlock];
    std::size_t height = 0;
    const BoundBlock& own = tree.levels[0][slot / kBoxBlock];
    const std::size_t own_lane = slot % kBoxBlock;
    stack[height++] = {tree.level_count - 1, 0};
    while (height > 0) {
        const Step step = stack[--height];
        std::uint32_t lanes = lanes_that_meet(tree.levels[step.level][step.block], own, own_lane);
        const std::size_t first = step.block * kBoxBlock;
        if (step.level > 0) {
            for (; lanes != 0; lanes &= lanes - 1) stack[height++] = {step.level - 1, first + lowest(lanes)};
            continue;
        }
        ++pairs.leaf_pairs;
        if (pairs.capacity - pairs.count < kPairRoom && !grow(pairs)) return false;
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto other = static_cast<std::uint32_t>(first + lowest(lanes));
            pairs.first[pairs.count] = slot;
            pairs.second[pairs.count] = other;
            pairs.count += other != slot;
        }
    }
    return true;
}

void FindPartners(const BoundTree& tree, const std::uint32_t* slots, std::size_t count, SlotPairs& pairs,
                  GrowPairs grow) {
    for (std::size_t i = 0; i < count; ++i)
        if (!visit_partners(tree, slots[i], pairs, grow)) return;
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(BoundBoxes);
HWY_EXPORT(BoundBlocks);
HWY_EXPORT(FindPairs);
HWY_EXPORT(FindPartners);

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
void find_partners(const BoundTree& tree, const std::uint32_t* slots, std::size_t count, SlotPairs& pairs,
                   GrowPairs grow) {
    HWY_DYNAMIC_DISPATCH(FindPartners)(tree, slots, count, pairs, grow);
}

}  // namespace crofton::collide
#endif
