// SPDX-License-Identifier: MIT
// The inner loops of LineTracer, on plain floats (no GLM here: see docs/architecture.md on vector kernels).
#pragma once
#include <crofton/mesh/mesh_layout.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::lines::detail {

inline constexpr std::size_t kLanes = mesh::kBoxNodeWidth;
inline constexpr std::uint32_t kLeaf = mesh::kMeshLeaf;  // in a child: the rest is a leaf's index
inline constexpr std::uint32_t kFront = 0x80000000u;     // in a hit: the line comes from the front
inline constexpr std::uint32_t kMiss = ~std::uint32_t{0};
inline constexpr std::size_t kMaxDepth = 64;  // of the tree; the builder sees to it

// Corner and edges of up to eight triangles. Unused lanes have no area, and kMiss for a number.
struct alignas(64) TracerLeaf {
    float corner[3][kLanes], first[3][kLanes], second[3][kLanes];
    std::uint32_t triangle[kLanes];
};

struct FlatRay {
    float point[3], direction[3];  // no component of the direction is 0
    std::uint32_t skip;
};
struct FlatHit {
    float t;
    std::uint32_t triangle;  // with kFront, or kMiss
};

struct TracerView {
    const mesh::BoxNode* nodes;
    const TracerLeaf* leaves;
    float tie;  // crossings closer together than this along a line count as one place: fronts come first there
};

// A line of a stream: point and direction, and from 8 on −1 over each.
struct alignas(64) StreamLine {
    float values[16];
};

// Crossings of a stream's lines, in any order.
struct StreamCrossings {
    float* t;
    std::uint32_t* triangle;  // with kFront
    std::uint32_t* line;
    std::size_t count, capacity;
};
enum class StreamEnd { done, lists_full, crossings_full };

// `lines`: point and direction of each. No component of a direction becomes 0.
void flatten(const double* lines, std::size_t count, const double* origin, StreamLine* flat);

// All crossings of up to 2^16 lines, which go through the tree together. `lists` is memory for their numbers, at least
// count + 16. Where that or `found` is too small the answer says so, and what was found is worth nothing.
StreamEnd trace_stream(const TracerView& tree, const StreamLine* lines, std::size_t count, std::uint16_t* lists,
                       std::size_t list_capacity, StreamCrossings& found);

// The first crossing of each ray beyond the tie.
void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits);

}  // namespace crofton::lines::detail
