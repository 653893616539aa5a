// SPDX-License-Identifier: MIT
// Axis-aligned bounds in blocks of sixteen, and the implicit tree over them. The broadphase shares them with its
// kernels.
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

inline constexpr std::size_t kMaxLevels = 16;  // blocks have six children or more, but where they have no siblings

// The bounds of one lane.
struct LaneBounds {
    float low[3], high[3];
};

// A tree over blocks. levels[0] holds the items' bounds. A lane of levels[k + 1] bounds a block of levels[k].
struct BoundTree {
    const BoundBlock* levels[kMaxLevels];
    const std::uint32_t* children[kMaxLevels];  // [16 b + l]: the item or the block below that lane l of block b bounds
    const std::uint32_t* parents[kMaxLevels];   // [b]: 16 times the block above, and the lane there
    const std::uint8_t* counts[kMaxLevels];     // [b]: lanes in use, which are the first; 0: the block is free
    std::size_t sizes[kMaxLevels];              // blocks, free ones too
    std::size_t level_count;                    // at least 2
    std::uint32_t root;                         // the one block of the highest level
};

// Bounds of sixteen boxes, rounded outward. Returns the lanes that need a closer look: not finite, not orthonormal to
// 0.9e-4, negative or beyond 1e30.
std::uint32_t bound_boxes(BoxBlock& boxes, BoundBlock& bounds);

// What bounds all lanes of each block; of blocks[0], blocks[1], … where `ids` is nullptr.
void bound_blocks(const BoundBlock* blocks, const std::uint32_t* ids, std::size_t count, LaneBounds* unions);

// Found pairs of slots as two lists. `grow` is called when fewer than kPairRoom are left, returns false to stop.
struct SlotPairs {
    std::uint32_t *first = nullptr, *second = nullptr;
    std::size_t count = 0, capacity = 0;
    std::uint64_t leaf_pairs = 0;
};
using GrowPairs = FunctionRef<bool(SlotPairs&)>;
inline constexpr std::size_t kCandidates = 512;  // boxes near a leaf that are compared with it at once
inline constexpr std::size_t kPairRoom = (kCandidates + 1) * kBoxBlock;

// All pairs of slots whose bounds meet, each once: those of leaves below blocks [begin, end) of levels[1] with those
// below the same block or a later one.
void find_pairs(const BoundTree& tree, std::size_t begin, std::size_t end, SlotPairs& pairs, GrowPairs grow);

// A box that moves along a ray in the bounds' frame. Along flat axes it does not move, or too slowly for its inverse
// direction.
struct BlockRay {
    double origin[3], inverse[3], half_size[3];
    bool is_flat[3];
};

// A bit for each of a block's lanes whose bounds the box meets up to `max_t`, and where, at the earliest. It meets
// bounds that it misses by less than 1e-11 of the coordinates.
[[nodiscard]] std::uint32_t lanes_along(const BoundBlock& block, const BlockRay& ray, double max_t, double* entries);
// A bit for each of a block's lanes whose bounds are within a distance of others, and the square of the least that it
// may be. `limit` is square_of() the distance.
[[nodiscard]] std::uint32_t lanes_near(const BoundBlock& block, const LaneBounds& bounds, float limit, float* squares);

// More than the square of a distance, by what rounds in the squares that kernels compare it with, and by more than
// their least numbers; above all where the distance is beyond 1e18. Negative for a negative distance.
[[nodiscard]] inline float square_of(double distance) {
    if (!(distance >= 0.0)) return -1.0f;
    const auto most = static_cast<float>(std::min(distance, 1e18) * (1.0 + 0x1p-20));
    return most * most + 1e-36f;
}

// A bit for each of a block's lanes whose bounds have moved farther than `far` from where they were `before`, around an
// origin that lies `shift` from the one now: by the sum of their lower ends' components, roughly.
[[nodiscard]] std::uint32_t lanes_that_jumped(const BoundBlock& before, const BoundBlock& now, const float (&shift)[3],
                                              float far);

// For each of the items, whose bounds are given: all other items whose bounds meet them, as {i, other item}. In no
// order. A pair of two of the items comes twice.
void find_partners(const BoundTree& tree, const std::uint32_t* items, const LaneBounds* bounds, std::size_t count,
                   SlotPairs& pairs, GrowPairs grow);

}  // namespace crofton::collide
