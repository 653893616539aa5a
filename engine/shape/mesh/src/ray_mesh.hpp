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

// Requires a valid ray.
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

// Rays side by side, as the caller gave them. Lanes beyond the last repeat the first.
struct alignas(64) RayPacket {
    double origin[3][kRayPacketWidth], direction[3][kRayPacketWidth], max_t[kRayPacketWidth];
    std::uint32_t count;  // 1 to kRayPacketWidth
};

// The hierarchy that a packet goes through; query_of(ray) of a lane; as ExactTest, of the ray in a lane.
struct PacketMesh {
    const BoxNode* nodes;
    const MeshLeaf* leaves;
    double extent;
    FunctionRef<RayQuery(std::uint32_t ray)> query_of;
    FunctionRef<bool(std::uint32_t ray, std::uint32_t leaf, std::uint32_t lane)> meets;
};

// The nearest hit of each ray, as trace() would answer it. False, without answers, where the rays do not lie together:
// they leave from nearly one place into nearly one direction, of equal signs, and are valid. Rays that part soon are
// slower in a packet, as it visits what any of them does.
[[nodiscard]] bool trace_packet(const RayPacket& rays, const PacketMesh& mesh, std::span<RayAnswer> answers);

// A bound of the rounding at any point of a mesh, for rays that start within `far` of its origin.
inline constexpr double kRayError = 7.5e-7;

}  // namespace crofton::mesh
