// SPDX-License-Identifier: MIT
// Axis-aligned bounds in blocks of sixteen and the implicit tree over them: what the broadphase's kernels share with
// it.
#pragma once
#include <crofton/collide/box_block.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/geometry/shapes.hpp>

namespace crofton::collide {

// Closed bounds; an empty lane has low > high and meets nothing.
struct alignas(64) BoundBlock {
    float low[3][kBoxBlock];
    float high[3][kBoxBlock];
};

inline constexpr std::size_t kMaxLevels = 9;  // 16^9 > 2^32

// levels[0] holds the items' bounds; lane l of block b of levels[k + 1] bounds block 16 b + l of levels[k].
struct BoundTree {
    const BoundBlock* levels[kMaxLevels];
    std::size_t sizes[kMaxLevels];  // blocks
    std::size_t level_count;
};

// Bounds of sixteen boxes, rounded outward. Returns the lanes that need a closer look: not finite, not orthonormal to
// 0.9e-4, negative or beyond 1e30.
std::uint32_t bound_boxes(BoxBlock& boxes, BoundBlock& bounds);

// Bounds of blocks [begin, end) of one level, into the lanes of the level above.
void bound_blocks(const BoundBlock* blocks, std::size_t begin, std::size_t end, BoundBlock* above);

// Found pairs of slots as two lists. `grow` is called when fewer than kPairRoom are left, returns false to stop.
struct SlotPairs {
    std::uint32_t *first = nullptr, *second = nullptr;
    std::size_t count = 0, capacity = 0;
    std::uint64_t leaf_pairs = 0;
};
using GrowPairs = FunctionRef<bool(SlotPairs&)>;
inline constexpr std::size_t kCandidates = 512;  // boxes near a leaf that are compared with it at once
inline constexpr std::size_t kPairRoom = (kCandidates + 1) * kBoxBlock;

// All pairs of slots whose bounds meet and the earlier of whose leaves lies below blocks [begin, end) of levels[1],
// each once.
void find_pairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow);

// For each of `slots`, all other slots whose bounds meet its own: {slot, other}. A pair of two of `slots` comes twice.
void find_partners(const BoundTree& tree, const std::uint32_t* slots, std::size_t count, SlotPairs& pairs,
                   GrowPairs grow);

}  // namespace crofton::collide
