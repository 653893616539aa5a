// SPDX-License-Identifier: MIT
// Data that the SIMD traversal of a ray shares with the exact code around it.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/mesh/mesh_layout.hpp>
#include <span>

namespace crofton {
struct Ray;
}
namespace crofton::mesh {

class MeshTree;

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
    float error_bound;     // bound of the rounding at any point of the mesh
    const BoxNode* nodes;  // null: the ray goes through mesh_nodes
    const mesh::MeshNode* mesh_nodes;
    const mesh::MeshLeaf* leaves;
    bool any;
};

// Of a valid ray.
[[nodiscard]] RayQuery query_of(const Ray& ray, const MeshTree& mesh, bool any);
// Whether the ray meets the triangle in a leaf's lane, exactly.
[[nodiscard]] bool meets(const Ray& ray, const MeshTree& mesh, std::uint32_t leaf, std::uint32_t lane);

// Tells exactly whether the ray meets a triangle, where double cannot.
using ExactTest = FunctionRef<bool(std::uint32_t leaf, std::uint32_t lane)>;

struct RayAnswer {
    double t = 0.0;
    std::uint32_t triangle = 0;
    bool hit = false;
};
[[nodiscard]] RayAnswer trace(const RayQuery& query, ExactTest meets);

inline constexpr std::size_t kRayPacketWidth = 16;

// As ExactTest, of the query at `ray`.
using PacketExactTest = FunctionRef<bool(std::uint32_t ray, std::uint32_t leaf, std::uint32_t lane)>;

// The nearest hit of each, as trace() would answer it; `any` is not looked at. They share the mesh's `nodes`, which are
// not null; their directions agree in sign, and `scale` differs by a factor of four at most. Fast where they leave from
// nearly one place into nearly one direction. Requires 1 to kRayPacketWidth queries, and as many answers.
void trace_packet(std::span<const RayQuery> queries, PacketExactTest meets, std::span<RayAnswer> answers);

}  // namespace crofton::mesh
