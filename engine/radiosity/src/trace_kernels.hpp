// SPDX-License-Identifier: MIT
// The inner loops of LineTracer, on plain floats (no GLM here: see docs/architecture.md on vector kernels).
#pragma once
#include <crofton/mesh/mesh_layout.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::radiosity::detail {

inline constexpr std::size_t kLanes = mesh::kBoxNodeWidth;
inline constexpr std::uint32_t kLeaf = mesh::kMeshLeaf;  // in a child: the rest is a leaf's index
inline constexpr std::uint32_t kFront = 0x80000000u;     // in a hit: the line comes from the front
inline constexpr std::uint32_t kMiss = ~std::uint32_t{0};
inline constexpr std::size_t kMaxDepth = 64;  // of the tree; the builder sees to it

// Corner and edges of up to eight triangles; unused lanes have no area.
struct alignas(64) TracerLeaf {
    float corner[3][kLanes], first[3][kLanes], second[3][kLanes];
    std::uint32_t triangle[kLanes];
    std::uint32_t count;
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
    float tie;      // crossings closer together than this along a line count as one place: fronts come first there
    float half[3];  // extents of all; the centre is the origin
};

// Consecutive lines that are near each other go through the tree together: a beam.
inline constexpr std::size_t kBeamLines = 64;

// All crossings of each line, sorted, into hits[0 .. capacity); ends[i] as in LineHits. Returns how many lines fitted.
std::size_t trace_all(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits,
                      std::size_t capacity, std::uint32_t* ends);
void trace_first(const TracerView& tree, const FlatRay* rays, std::size_t count, FlatHit* hits);

}  // namespace crofton::radiosity::detail
