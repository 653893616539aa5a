// SPDX-License-Identifier: MIT
// The broadphase's kernels, compiled for each instruction set and chosen at run time.
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#include <crofton/simd/compress-inl.hpp>
#include <crofton/simd/mask_bits-inl.hpp>

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

void BoundBlocks(const BoundBlock* blocks, const std::uint32_t* ids, std::size_t count, LaneBounds* unions) {
    const D d;
    for (std::size_t n = 0; n < count; ++n) {
        const BoundBlock& block = blocks[ids ? ids[n] : n];
        for (int i = 0; i < 3; ++i) {
            V low = hn::Load(d, block.low[i]), high = hn::Load(d, block.high[i]);
            for (std::size_t l = hn::Lanes(d); l < kBoxBlock; l += hn::Lanes(d)) {
                low = hn::Min(low, hn::Load(d, block.low[i] + l));
                high = hn::Max(high, hn::Load(d, block.high[i] + l));
            }
            unions[n].low[i] = hn::GetLane(hn::MinOfLanes(d, low));
            unions[n].high[i] = hn::GetLane(hn::MaxOfLanes(d, high));
        }
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

// Lane `lane` of block `block` of levels[1], a leaf, against the leaves below blocks `near` of that level. None of them
// is before `block`.
bool compare_leaf(const BoundTree& tree, std::size_t block, std::size_t lane, const std::uint32_t* near,
                  std::size_t near_count, SlotPairs& pairs, GrowPairs grow) {
    const BoundBlock& own = tree.levels[1][block];
    const std::uint32_t index = tree.children[1][block * kBoxBlock + lane];
    Leaf leaf;
    load(tree.levels[0][index], leaf.bounds);
    leaf.base = static_cast<std::uint32_t>(index * kBoxBlock);
    for (std::size_t n = 0; n < near_count; ++n) {
        const std::uint32_t* const children = tree.children[1] + near[n] * kBoxBlock;
        std::uint32_t leaves = lanes_that_meet(tree.levels[1][near[n]], own, lane);
        if (near[n] == block) leaves &= ~std::uint32_t{0} << lane;
        for (; leaves != 0; leaves &= leaves - 1) {
            const std::uint32_t other = children[lowest(leaves)];
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
    for (std::size_t lane = 0; lane < tree.counts[1][block]; ++lane)
        if (!compare_leaf(tree, block, lane, near.block, near.count, pairs, grow)) return false;
    near.count = 0;
    return true;
}

// Descends to the blocks of levels[1], from `block` on, whose bounds meet its own.
bool visit_block(const BoundTree& tree, std::size_t block, SlotPairs& pairs, GrowPairs grow) {
    struct Step {
        std::size_t level;
        std::uint32_t block;
    };
    Step stack[kMaxLevels * kBoxBlock];
    std::size_t height = 0;
    NearBlocks near;
    const std::uint32_t above = tree.level_count > 2 ? tree.parents[1][block] : 0;
    stack[height++] = {tree.level_count - 1, tree.root};
    while (height > 0) {
        const Step step = stack[--height];
        if (step.level == 1) {
            if (step.block < block) continue;  // has met this one already
            near.block[near.count++] = step.block;
            if (near.count == NearBlocks::kCapacity && !compare_block(tree, block, near, pairs, grow)) return false;
            continue;
        }
        std::uint32_t lanes =
            lanes_that_meet(tree.levels[step.level][step.block], tree.levels[2][above / kBoxBlock], above % kBoxBlock);
        const std::uint32_t* const children = tree.children[step.level] + step.block * kBoxBlock;
        for (; lanes != 0; lanes &= lanes - 1) stack[height++] = {step.level - 1, children[lowest(lanes)]};
    }
    return compare_block(tree, block, near, pairs, grow);
}

void FindPairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow) {
    for (std::size_t block = begin; block < end; ++block)
        if (tree.counts[1][block] != 0 && !visit_block(tree, block, pairs, grow)) return;
}

HWY_INLINE std::uint32_t lanes_that_meet(const BoundBlock& block, const LaneBounds& other) {
    const D d;
    Bounds bounds;
    load(block, bounds);
    std::uint32_t bits = 0;
    for (std::size_t v = 0; v < kVectors; ++v) {
        M all = hn::And(hn::Le(bounds.low[0][v], hn::Set(d, other.high[0])),
                        hn::Ge(bounds.high[0][v], hn::Set(d, other.low[0])));
        for (int i = 1; i < 3; ++i)
            all = hn::And(all, hn::And(hn::Le(bounds.low[i][v], hn::Set(d, other.high[i])),
                                       hn::Ge(bounds.high[i][v], hn::Set(d, other.low[i]))));
        bits |= bits_of(d, all, v * hn::Lanes(d));
    }
    return bits;
}

// A block that an item's bounds are to be compared with.
struct Visit {
    std::uint32_t item, level, block;  // the item by its place among those asked for
};

// The visits that wait, in a ring: blocks are fetched from memory while those before them are looked at.
struct Waiting {
    static constexpr std::size_t kCapacity = 256;
    Visit visits[kCapacity];
    std::size_t begin = 0, end = 0;

    [[nodiscard]] std::size_t size() const { return end - begin; }
    [[nodiscard]] Visit pop() { return visits[begin++ % kCapacity]; }
    void push(const Visit& visit) { visits[end++ % kCapacity] = visit; }
};

struct Partners {
    const BoundTree& tree;
    const std::uint32_t* items;
    const LaneBounds* bounds;
    SlotPairs& pairs;
    GrowPairs grow;

    HWY_INLINE std::uint32_t lanes_of(const Visit& visit) const {
        return lanes_that_meet(tree.levels[visit.level][visit.block], bounds[visit.item]);
    }
    HWY_INLINE const std::uint32_t* children_of(const Visit& visit) const {
        return tree.children[visit.level] + visit.block * kBoxBlock;
    }
    // The items in a leaf.
    bool put(const Visit& visit, std::uint32_t lanes) const {
        ++pairs.leaf_pairs;
        if (pairs.capacity - pairs.count < kPairRoom && !grow(pairs)) return false;
        for (const std::uint32_t* const children = children_of(visit); lanes != 0; lanes &= lanes - 1) {
            const std::uint32_t other = children[lowest(lanes)];
            pairs.first[pairs.count] = visit.item;
            pairs.second[pairs.count] = other;
            pairs.count += other != items[visit.item];
        }
        return true;
    }
    // All that is below a block, at once.
    bool visit_below(const Visit& first) const {
        Visit stack[kMaxLevels * kBoxBlock];
        std::size_t height = 0;
        stack[height++] = first;
        while (height > 0) {
            const Visit visit = stack[--height];
            std::uint32_t lanes = lanes_of(visit);
            if (visit.level == 0) {
                if (!put(visit, lanes)) return false;
                continue;
            }
            for (const std::uint32_t* const children = children_of(visit); lanes != 0; lanes &= lanes - 1)
                stack[height++] = {visit.item, visit.level - 1, children[lowest(lanes)]};
        }
        return true;
    }
    void fetch(std::size_t level, std::uint32_t block) const {
        const char* const bytes = reinterpret_cast<const char*>(tree.levels[level] + block);
        for (std::size_t byte = 0; byte < sizeof(BoundBlock); byte += 64) hwy::Prefetch(bytes + byte);
        hwy::Prefetch(tree.children[level] + block * kBoxBlock);
    }
};

void FindPartners(const BoundTree& tree, const std::uint32_t* items, const LaneBounds* bounds, std::size_t count,
                  SlotPairs& pairs, GrowPairs grow) {
    constexpr std::size_t kAtOnce = 24;
    const Partners partners{tree, items, bounds, pairs, grow};
    Waiting waiting;
    std::uint32_t next = 0;
    while (true) {
        for (; waiting.size() < kAtOnce && next < count; ++next)
            waiting.push({next, static_cast<std::uint32_t>(tree.level_count - 1), tree.root});
        if (waiting.size() == 0) return;
        const Visit visit = waiting.pop();
        if (visit.level > 0 && Waiting::kCapacity - waiting.size() < kBoxBlock) {
            if (!partners.visit_below(visit)) return;
            continue;
        }
        std::uint32_t lanes = partners.lanes_of(visit);
        if (visit.level == 0) {
            if (lanes != 0 && !partners.put(visit, lanes)) return;
            continue;
        }
        for (const std::uint32_t* const children = partners.children_of(visit); lanes != 0; lanes &= lanes - 1) {
            const std::uint32_t below = children[lowest(lanes)];
            partners.fetch(visit.level - 1, below);
            waiting.push({visit.item, visit.level - 1, below});
        }
    }
}

// The lanes' bounds are widened by more than all roundings: of the ray's origin, of sums, of products with t.
std::uint32_t LanesAlong(const BoundBlock& block, const BlockRay& ray, double max_t, double* entries) {
    const hn::CappedTag<double, kBoxBlock> d;
    const hn::Rebind<float, decltype(d)> df;
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        auto enter = hn::Zero(d), leave = hn::Set(d, max_t);
        auto meets = hn::Le(hn::PromoteTo(d, hn::Load(df, block.low[0] + l)),
                            hn::PromoteTo(d, hn::Load(df, block.high[0] + l)));  // the lane is in use
        for (int i = 0; i < 3; ++i) {
            const auto origin = hn::Set(d, ray.origin[i]);
            auto low = hn::PromoteTo(d, hn::Load(df, block.low[i] + l)),
                 high = hn::PromoteTo(d, hn::Load(df, block.high[i] + l));
            const auto slack =
                hn::Add(hn::Mul(hn::Set(d, 1e-11), hn::Add(hn::Abs(origin), hn::Add(hn::Abs(low), hn::Abs(high)))),
                        hn::Set(d, ray.half_size[i] * (1.0 + 1e-11)));
            low = hn::Sub(hn::Sub(low, slack), origin);
            high = hn::Sub(hn::Add(high, slack), origin);
            if (ray.is_flat[i]) {
                meets = hn::And(meets, hn::And(hn::Le(low, hn::Zero(d)), hn::Ge(high, hn::Zero(d))));
                continue;
            }
            const auto a = hn::Mul(low, hn::Set(d, ray.inverse[i])), b = hn::Mul(high, hn::Set(d, ray.inverse[i]));
            enter = hn::Max(enter, hn::Min(a, b));
            leave = hn::Min(leave, hn::Max(a, b));
        }
        hn::StoreU(enter, d, entries + l);
        bits |= simd::mask_bits(d, hn::And(meets, hn::Le(enter, leave))) << l;
    }
    return bits;
}

// Differences, squares and sums round by less than 2^-21 of themselves. Differences are limited so that their
// squares are finite.
std::uint32_t LanesNear(const BoundBlock& block, const LaneBounds& bounds, float limit, float* squares) {
    const hn::CappedTag<float, kBoxBlock> d;
    const auto most = hn::Set(d, limit);
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        auto squared = hn::Zero(d);
        const auto in_use = hn::Le(hn::Load(d, block.low[0] + l), hn::Load(d, block.high[0] + l));
        for (int i = 0; i < 3; ++i) {
            const auto above = hn::Sub(hn::Load(d, block.low[i] + l), hn::Set(d, bounds.high[i])),
                       below = hn::Sub(hn::Set(d, bounds.low[i]), hn::Load(d, block.high[i] + l));
            const auto gap = hn::Min(hn::Max(hn::Zero(d), hn::Max(above, below)), hn::Set(d, 1e17f));
            squared = hn::Add(squared, hn::Mul(gap, gap));
        }
        hn::StoreU(squared, d, squares + l);
        bits |= simd::mask_bits(d, hn::And(in_use, hn::Le(squared, most))) << l;
    }
    return bits;
}

std::uint32_t LanesThatJumped(const BoundBlock& before, const BoundBlock& now, const float* shift, float far) {
    const hn::CappedTag<float, kBoxBlock> d;
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < kBoxBlock; l += hn::Lanes(d)) {
        auto way = hn::Zero(d);
        for (int i = 0; i < 3; ++i)
            way = hn::Add(way, hn::Abs(hn::Add(hn::Sub(hn::Load(d, now.low[i] + l), hn::Load(d, before.low[i] + l)),
                                               hn::Set(d, shift[i]))));
        bits |= simd::mask_bits(d, hn::Gt(way, hn::Set(d, far))) << l;
    }
    return bits;
}

}  // namespace crofton::collide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::collide {

HWY_EXPORT(BoundBoxes);
HWY_EXPORT(BoundBlocks);
HWY_EXPORT(FindPairs);
HWY_EXPORT(FindPartners);
HWY_EXPORT(LanesAlong);
HWY_EXPORT(LanesNear);
HWY_EXPORT(LanesThatJumped);

std::uint32_t bound_boxes(BoxBlock& boxes, BoundBlock& bounds) {
    measure_deviation(boxes);
    return HWY_DYNAMIC_DISPATCH(BoundBoxes)(boxes, bounds);
}
void bound_blocks(const BoundBlock* blocks, const std::uint32_t* ids, std::size_t count, LaneBounds* unions) {
    HWY_DYNAMIC_DISPATCH(BoundBlocks)(blocks, ids, count, unions);
}
void find_pairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow) {
    HWY_DYNAMIC_DISPATCH(FindPairs)(tree, begin, end, pairs, grow);
}
void find_partners(const BoundTree& tree, const std::uint32_t* items, const LaneBounds* bounds, std::size_t count,
                   SlotPairs& pairs, GrowPairs grow) {
    HWY_DYNAMIC_DISPATCH(FindPartners)(tree, items, bounds, count, pairs, grow);
}
std::uint32_t lanes_along(const BoundBlock& block, const BlockRay& ray, double max_t, double* entries) {
    return HWY_DYNAMIC_DISPATCH(LanesAlong)(block, ray, max_t, entries);
}
std::uint32_t lanes_near(const BoundBlock& block, const LaneBounds& bounds, float limit, float* squares) {
    return HWY_DYNAMIC_DISPATCH(LanesNear)(block, bounds, limit, squares);
}

std::uint32_t lanes_that_jumped(const BoundBlock& before, const BoundBlock& now, const float (&shift)[3], float far) {
    return HWY_DYNAMIC_DISPATCH(LanesThatJumped)(before, now, shift, far);
}

}  // namespace crofton::collide
#endif
