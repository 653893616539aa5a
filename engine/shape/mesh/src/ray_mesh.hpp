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

// A ray's numbers as the caller gave them lie in a crofton::Ray one after the other: origin, direction, max_t.
inline constexpr std::size_t kRayNumbers = 7;
[[nodiscard]] const double* numbers_of(const Ray& ray);

// What rays read of a mesh tree with triangles.
struct RayMesh {
    const BoxNode* nodes;  // null: rays go through mesh_nodes
    const MeshNode* mesh_nodes;
    const MeshLeaf* leaves;
    double extent;
};
[[nodiscard]] RayMesh ray_mesh_of(const MeshTree& mesh);

// A ray as its traversal needs it. Arrays of four have one element to spare.
struct RayQuery {
    RayMesh mesh;
    const double* ray;  // its numbers
    // In float, scaled by 1/scale, a power of two: no component is above 2 in size, or below 1e-18. Parameters along it
    // are `scale` times the caller's.
    alignas(16) float start[4], direction[4], inverse[4];
    alignas(16) float near_start[4], far_start[4];  // of AlignedBoxes
    double scale;
    // The triangles' plane coordinates: axis[2] is that of the largest component, and shear[k] is
    // direction[axis[k]] / direction[axis[2]].
    std::uint32_t axis[3];
    float shear[2];
    float error_bound;  // bound of the rounding at any point of the mesh
    bool any;
};

// Whether the ray meets the triangle in a leaf's lane, exactly.
[[nodiscard]] bool meets(const Ray& ray, const MeshTree& mesh, std::uint32_t leaf, std::uint32_t lane);

// Tells exactly whether the ray meets a triangle, where double cannot.
using ExactTest = FunctionRef<bool(std::uint32_t leaf, std::uint32_t lane)>;

struct RayAnswer {
    double t = 0.0;
    std::uint32_t triangle = 0;
    bool hit = false;
};
// Of a valid ray, by its numbers: the nearest hit, or where any will do, `hit` alone.
[[nodiscard]] RayAnswer trace(const double* ray, const RayMesh& mesh, bool any, ExactTest meets);

inline constexpr std::size_t kRayPacketWidth = 16;

// Rays side by side, as the caller gave them. Lanes beyond the last repeat the first.
struct alignas(64) RayPacket {
    double origin[3][kRayPacketWidth], direction[3][kRayPacketWidth], max_t[kRayPacketWidth];
    std::uint32_t count;  // 1 to kRayPacketWidth
};

// The rays of a packet one by one; as ExactTest, of one of them.
struct PacketMesh {
    RayMesh mesh;
    const double* rays;  // the numbers of all, one ray after the other
    FunctionRef<bool(std::uint32_t ray, std::uint32_t leaf, std::uint32_t lane)> meets;
};

// The nearest hit of each ray, as trace() would answer it. False, without answers, where the rays do not lie together:
// they leave from nearly one place into nearly one direction, of equal signs, and are valid. Rays that part soon are
// slower in a packet, as it visits what any of them does.
[[nodiscard]] bool trace_packet(const RayPacket& rays, const PacketMesh& mesh, std::span<RayAnswer> answers);

// A bound of the rounding at any point of a mesh, for rays that start within `far` of its origin.
inline constexpr double kRayError = 7.5e-7;

}  // namespace crofton::mesh
