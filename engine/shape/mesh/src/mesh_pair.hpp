// SPDX-License-Identifier: MIT
// Data that the SIMD traversals of two mesh trees share with the exact code around them.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>

namespace crofton::mesh {

// Plain numbers only: kernel files see no GLM.
struct MeshPair {
    const mesh::MeshNode* nodes[2];
    const mesh::MeshLeaf* leaves[2];
    const mesh::MeshBox* root[2];
    // x ↦ columns · x + offset, padded for vector loads; [0]: from b's frame to a's, [1]: from a's to b's.
    struct Motion {
        alignas(16) float column[3][4];
        alignas(16) float offset[4];
    };
    Motion to_a, to_b;
    double exact_rotation[3][3], exact_translation[3];
    // Bound of the float rounding of any point or box that is carried from one mesh's frame to the other's.
    float error_bound;
    float tolerance;  // pairs farther apart than this are left out
};

// Of eight pairs of triangles: which surely meet, and which only exact arithmetic can tell; the others surely do not.
struct LaneVerdict {
    std::uint32_t hits = 0, open = 0;
    std::uint32_t pierced[6] = {};  // of the hits: by edge 0-2 of a, 3-5 of b

    // One bit for each edge that passes through the other triangle.
    [[nodiscard]] std::uint32_t edges(std::uint32_t lane) const {
        std::uint32_t bits = 0;
        for (std::uint32_t e = 0; e < 6; ++e) bits |= (pierced[e] >> lane & 1u) << e;
        return bits;
    }
};

// A triangle of a and one of b that meet. Bit e is set where edge e of a, or edge e − 3 of b, passes through the other.
// Without a bit they may meet. True ends the traversal.
using PairVisitor = FunctionRef<bool(LeafTriangle of_a, LeafTriangle of_b, std::uint32_t edges)>;

struct TraversalCounts {
    std::uint64_t box_tests = 0, triangle_tests = 0;
};

// Calls `visit` for every pair of triangles that meets or may meet, until it returns true. `at_once`: as soon as found,
// for visitors that stop at the first.
void visit_overlaps(const MeshPair& pair, bool at_once, PairVisitor visit, TraversalCounts& counts);

// What a search for the nearest pair knows so far; the visitor's to improve.
struct Nearest {
    double squared;      // pairs at this distance or farther are left out
    float direction[3];  // from a to b, unit to 2^-22, or zero: boxes are also told apart along it
};

// Calls `visit` for pairs that may be nearer than `nearest`, nearest boxes first.
void visit_nearest(const MeshPair& pair, const Nearest& nearest, PairVisitor visit, TraversalCounts& counts);

// A stack this deep is never exceeded. Each tree has at most 7 levels of nodes (2^25 leaves, sixteen to a node that is
// full). Each step down leaves at most fifteen siblings, and a leaf seven of its triangles.
inline constexpr std::uint32_t kMeshStackSize = 512;

}  // namespace crofton::mesh
