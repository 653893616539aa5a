// SPDX-License-Identifier: MIT
// What the SIMD traversal of a ray shares with the exact code around it.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>

namespace crofton::mesh {

struct RayQuery {
    double origin[3], direction[3], max_t;  // as the caller gave them
    float start[3], unit[3];                // rounded, direction of unit length
    float length;                           // of direction: parameters of boxes are distances
    float slop;                             // bound of the rounding at any point of the mesh
    const mesh::MeshNode* nodes;
    const mesh::MeshLeaf* leaves;
    bool any;
};

// Tells exactly whether the line passes through a triangle, where double cannot.
using LineTest = FunctionRef<bool(std::uint32_t leaf, std::uint32_t lane)>;

struct RayAnswer {
    double t;
    std::uint32_t triangle;
    bool hit = false;
};
[[nodiscard]] RayAnswer trace(const RayQuery& query, LineTest line_meets);

}  // namespace crofton::mesh
