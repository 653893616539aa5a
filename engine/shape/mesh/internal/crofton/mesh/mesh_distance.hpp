// SPDX-License-Identifier: MIT
// Overlap and distance of two meshes, by a search through both trees at once.
#pragma once
#include <crofton/mesh/mesh_layout.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <limits>

namespace crofton::mesh {

// A triangle of each mesh, by its place in the tree.
struct PairOfPlaces {
    LeafTriangle a, b;
};

struct MeshDistance {
    double distance = std::numeric_limits<double>::infinity();
    glm::dvec3 on_a{0.0}, on_b{0.0};  // in a's frame
    TrianglePair triangles{};
    PairOfPlaces places{};
};
// Returns the smallest distance between the surfaces: exactly 0 if they meet and positive if they do not, and otherwise
// within 1e-12 of the coordinates' size. If it is at least `limit`, it stops early, with `distance` infinite.
[[nodiscard]] MeshDistance distance(const MeshTree& a, const MeshTree& b, const RigidTransform& b_to_a,
                                    double limit = std::numeric_limits<double>::infinity(),
                                    MeshStatistics* statistics = nullptr);

// Tests whether the surfaces meet. Writes a pair of triangles that do to `where`.
[[nodiscard]] bool intersects(const MeshTree& a, const MeshTree& b, const RigidTransform& b_to_a,
                              MeshStatistics* statistics = nullptr, PairOfPlaces* where = nullptr);

// Tests whether some point of a is closer than `tolerance` ≥ 0 to some point of b, or the surfaces meet.
[[nodiscard]] bool closer_than(const MeshTree& a, const MeshTree& b, const RigidTransform& b_to_a, double tolerance,
                               MeshStatistics* statistics = nullptr);

// As `distance` from a mesh that is that point alone: on_b is the point. The distance is 0 iff the point lies on a
// triangle, exactly so while its coordinates are 0 or at least 1e-70 in size; else it is off by 1e-12 of the
// coordinates' size. Of triangles at exactly the same distance the first is named, wherever they lie in the tree.
// Infinite for a mesh without triangles and for a point that is not finite. Allocates nothing.
[[nodiscard]] MeshDistance distance_to_point(const MeshTree& mesh, const glm::dvec3& point);

}  // namespace crofton::mesh
