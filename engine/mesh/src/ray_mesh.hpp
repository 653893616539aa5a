// SPDX-License-Identifier: MIT
// What the SIMD traversal of a ray shares with the exact code around it.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>

namespace crofton::mesh {

struct RayQuery {
    double origin[3], direction[3], max_t;  // as the caller gave them
    // In float, scaled by 1/scale, a power of two: no component is above 2 in size, or below 1e-18. Parameters along it
    // are `scale` times the caller's.
    float start[3], direction_f[3], inverse[3];
    double scale;
    // The triangles' plane coordinates: axis[2] is that of the largest component, and shear[k] is
    // direction_f[axis[k]] / direction_f[axis[2]].
    std::uint32_t axis[3];
    float shear[2];
    float slop;            // bound of the rounding at any point of the mesh
    const BoxNode* nodes;  // null: the ray goes through mesh_nodes
    const mesh::MeshNode* mesh_nodes;
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
