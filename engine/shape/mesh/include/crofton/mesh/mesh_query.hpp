// SPDX-License-Identifier: MIT
// Questions asked of triangles and meshes: contacts, distances, rays.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>

namespace crofton::mesh {

class MeshTree;

// ---- Overlap of two triangles ----

// True iff the closed convex hulls of the three points of each share a point. Coplanar triangles and those that are
// segments or points are answered like all others. Signs come from a double filter with a proven bound, then from exact
// arithmetic. Exact while coordinates are 0 or have magnitudes in [1e-70, 1e70]; NaN meets nothing.
[[nodiscard]] bool intersects(const Triangle& a, const Triangle& b);

struct SegmentOfContact {
    glm::dvec3 begin{0.0}, end{0.0};
};
// Where two triangles that meet do so: the ends of their common segment, equal for a point. For coplanar triangles: the
// ends of a longest diagonal of their common polygon, at most. Rounded: within 1e-9 of the triangles' size of both.
[[nodiscard]] SegmentOfContact contact_segment(const Triangle& a, const Triangle& b);

// ---- Meshes against meshes: overlap, contacts, distance ----

// All queries take the pose of b in a's frame; it has passed validate(RigidTransform). Triangles are a's own and those
// of b with each vertex put through transform(RigidTransform); for these the answers are exact. Boxes are only ever
// used to leave out pairs that cannot meet. const, thread-safe; no allocation beyond the growth of the caller's
// vectors.

struct MeshStatistics {
    std::uint64_t box_tests = 0;       // boxes tested against a box
    std::uint64_t triangle_tests = 0;  // pairs of triangles that went through the eight-wide test
    std::uint64_t exact_tests = 0;  // of those, pairs that needed exact arithmetic (in distance queries: the distance)
};

// Indices of triangles in mesh a (first) and mesh b (second).
using TrianglePair = IdPair;

[[nodiscard]] bool intersects(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                              MeshStatistics* statistics = nullptr);

// Replaces `pairs` by all pairs of triangles that meet, sorted.
void intersecting_triangles(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                            Vector<TrianglePair>& pairs, MeshStatistics* statistics = nullptr);

// Where two triangles meet, in a's frame. `normal` is the unit normal of b's triangle, or of a's where b's has none.
// The segment runs along the cross product of a's and b's normals: counter-clockwise around what lies in both, seen
// from b.
struct MeshContact {
    TrianglePair triangles;
    SegmentOfContact segment;
    glm::dvec3 normal{0.0};
};
// As intersecting_triangles, with the place of each.
void contacts(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
              Vector<MeshContact>& found, MeshStatistics* statistics = nullptr);

// A motion of b that ends the contact, containment included: `depth` along the unit vector `direction`. An upper bound
// of the penetration depth, 0 where they do not meet. It is tried along these: the axes of both meshes' frames and
// boxes, the mean normal of the contacts, the line of centres. Of meshes that stay apart once they are, as convex ones
// do, it is the shortest of these motions, to 1e-6 of the meshes' size. Others may part earlier, and meet again.
struct MeshDepth {
    double depth = 0.0;
    glm::dvec3 direction{0.0};
};
[[nodiscard]] MeshDepth penetration(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                    std::span<const MeshContact> contacts);

// Of a mesh in several pieces each is asked: all of them inside the other mesh, or `partly`: some but not all.
enum class Containment : std::uint8_t { none, a_inside_b, b_inside_a, partly };

// Whether one mesh lies within the other without their surfaces meeting; `none` when they meet. Only closed pieces
// contain (MeshPiece): the answer is the parity of their crossings with a line, decided exactly.
[[nodiscard]] Containment containment(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                      MeshStatistics* statistics = nullptr);
// As above where it is known that the surfaces do not meet.
[[nodiscard]] Containment containment_of_disjoint(const mesh::MeshTree& a, const mesh::MeshTree& b,
                                                  const RigidTransform& b_to_a);
// Whether the point lies within the closed pieces of the mesh, their surfaces included; exact while its coordinates are
// 0 or at least 1e-70 in size. One that is not finite lies in none.
[[nodiscard]] bool contains(const mesh::MeshTree& mesh, const glm::dvec3& point);

struct MeshDistance {
    double distance = std::numeric_limits<double>::infinity();
    glm::dvec3 on_a{0.0}, on_b{0.0};  // in a's frame
    TrianglePair triangles{};
};
// The smallest distance between the surfaces: 0 when they meet and positive when they do not, exactly so; else within
// 1e-12 of the coordinates' size. Gives up, with `distance` infinite, where it is at least `limit`.
[[nodiscard]] MeshDistance distance(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                    double limit = std::numeric_limits<double>::infinity(),
                                    MeshStatistics* statistics = nullptr);

// True iff some point of a is closer than `tolerance` ≥ 0 to some point of b, or they meet.
[[nodiscard]] bool closer_than(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                               double tolerance, MeshStatistics* statistics = nullptr);

// ---- Rays and segments ----

// Where a ray enters a box, or 0 where it starts inside. Rounded: a grazing hit within 1e-14 of the coordinates' size
// may be told either way.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Obb& box);

// Whether the ray meets a triangle is decided exactly, edges and corners included, and the ray's start and end. So
// nothing slips through between triangles that share an edge. t is rounded, but stays within 0 … max_t; it is told
// of directions whose length is from 1e-150 to 1e150. A ray within the plane of a triangle does not hit that triangle.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Triangle& triangle);

struct RayHit {
    double t = 0.0;
    std::uint32_t triangle = 0;
};
// The nearest triangle, decided likewise for origins within 1e37; of hits with equal t that of the lowest index.
[[nodiscard]] std::optional<RayHit> raycast(const Ray& ray, const mesh::MeshTree& mesh);
// Many rays: hits[i] is what raycast(rays[i], mesh) gives, the same bits. Where rays are prepared
// (MeshTree::prepare_rays), sixteen at a time go through the hierarchy as a packet. The closer they lie together, the
// less time that takes. A picture's are best cast in tiles of 4 × 4 pixels. Requires hits.size() >= rays.size().
// Allocates nothing.
void raycast(std::span<const Ray> rays, const mesh::MeshTree& mesh, std::span<std::optional<RayHit>> hits);
[[nodiscard]] bool hits_any(const Ray& ray, const mesh::MeshTree& mesh);

}  // namespace crofton::mesh
