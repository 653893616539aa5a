// SPDX-License-Identifier: MIT
// Queries of triangles and meshes: overlapping triangles, contacts, containment, rays.
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

// Tests whether two triangles, the closed convex hulls of their points, share a point. Coplanar triangles, and
// triangles that are segments or points, are handled as well.
//
// Signs come from a double filter with a proven bound, then from exact arithmetic. Exact while coordinates are 0 or
// have magnitudes in [1e-70, 1e70]; NaN overlaps nothing.
[[nodiscard]] bool intersects(const Triangle& a, const Triangle& b);

struct SegmentOfContact {
    glm::dvec3 begin{0.0}, end{0.0};
};
// Returns the ends of the common segment of two triangles that overlap, equal for a point. For coplanar triangles they
// are at most the ends of a longest diagonal of the common polygon. Rounded: within 1e-9 of the triangles' size of
// both.
[[nodiscard]] SegmentOfContact contact_segment(const Triangle& a, const Triangle& b);

// ---- Meshes against meshes: triangles that overlap, contacts, containment ----

// For overlap, distance, depth and casts of meshes see crofton/convex: a mesh is a shape (Shape::mesh).

// All queries take the pose of b in a's frame, which must pass validate(RigidTransform).
//
// The triangles are a's own, and those of b with each vertex put through transform(RigidTransform). For these the
// answers are exact; boxes only skip pairs that cannot overlap. The queries are const and thread-safe, and allocate
// only to grow the caller's vectors.

struct MeshStatistics {
    std::uint64_t box_tests = 0;       // boxes tested against a box
    std::uint64_t triangle_tests = 0;  // pairs of triangles that went through the eight-wide test
    std::uint64_t exact_tests = 0;     // of those, pairs (or distances) that needed exact arithmetic
};

// Indices of triangles in mesh a (first) and mesh b (second).
using TrianglePair = IdPair;

// Replaces `pairs` by all pairs of triangles that overlap, sorted.
void intersecting_triangles(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                            Vector<TrianglePair>& pairs, MeshStatistics* statistics = nullptr);

// A contact of two triangles, in a's frame. `normal` is the unit normal of b's triangle, or of a's if b's has none. The
// segment runs along the cross product of a's and b's normals: counter-clockwise around the common region, seen from b.
struct MeshContact {
    TrianglePair triangles;
    SegmentOfContact segment;
    glm::dvec3 normal{0.0};
};
// Does the same as intersecting_triangles, with the segment and normal of each contact.
void contacts(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
              Vector<MeshContact>& found, MeshStatistics* statistics = nullptr);

// A motion of b that ends the contact, containment included: `depth` along the unit vector `direction`.
//
// It is an upper bound of the penetration depth; 0 if they do not overlap. It tries these directions: the axes of both
// meshes' frames and boxes, the mean normal of the contacts, and the line of centres. If the meshes stay apart once
// they are apart, as convex ones do, it is the shortest of these motions, to 1e-6 of the meshes' size. Others may
// separate earlier, and overlap again.
struct SeparatingMotion {
    double depth = 0.0;
    glm::dvec3 direction{0.0};
};
[[nodiscard]] SeparatingMotion separating_motion(const mesh::MeshTree& a, const mesh::MeshTree& b,
                                                 const RigidTransform& b_to_a, std::span<const MeshContact> contacts);

// The containment of meshes, tested for each piece of a mesh: `a_inside_b` means that all pieces of a lie in b;
// `partly` means that some pieces do, but not all.
enum class Containment : std::uint8_t { none, a_inside_b, b_inside_a, partly };

// Tests whether one mesh lies within the other without a contact of their surfaces; returns `none` if the surfaces
// meet. Only closed pieces contain anything (MeshPiece): the answer is the parity of their crossings with a line,
// decided exactly.
[[nodiscard]] Containment containment(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                      MeshStatistics* statistics = nullptr);
// Does the same for meshes whose surfaces are known not to meet.
[[nodiscard]] Containment containment_of_disjoint(const mesh::MeshTree& a, const mesh::MeshTree& b,
                                                  const RigidTransform& b_to_a);
// Tests whether the point lies within the closed pieces of the mesh, surfaces included. Exact while its coordinates are
// 0 or at least 1e-70 in magnitude. A point that is not finite lies in none.
[[nodiscard]] bool contains(const mesh::MeshTree& mesh, const glm::dvec3& point);

// ---- Rays and segments ----

// Returns the t at which a ray enters a box, or 0 if it starts inside. Rounded: a grazing hit within 1e-14 of the
// coordinates' size may be decided either way.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Obb& box);

// Returns the t at which a ray hits a triangle.
//
// The decision is exact, also at edges, corners and the ray's ends, so no ray passes between triangles that share an
// edge. t is rounded, but stays within 0 … max_t. It is returned for directions whose length is from 1e-150 to 1e150. A
// ray within the plane of a triangle does not hit that triangle.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Triangle& triangle);

// The triangle of a mesh that a ray hits first. convex::RayHit has the point and the normal as well.
struct TriangleHit {
    double t = 0.0;  // along the ray, in [0, max_t]
    std::uint32_t triangle = 0;
};
// Returns the nearest triangle, with the same exactness for origins within 1e37; of hits with equal t, that of the
// lowest index.
[[nodiscard]] std::optional<TriangleHit> raycast(const Ray& ray, const mesh::MeshTree& mesh);
// Casts many rays: hits[i] has the same bits as raycast(rays[i], mesh).
//
// If rays are prepared (MeshTree::prepare_rays), sixteen at a time go through the hierarchy as a packet. This is faster
// the closer they lie together; cast the rays of a picture in tiles of 4 × 4 pixels. Requires hits.size() >=
// rays.size(). Allocates nothing.
void raycast(std::span<const Ray> rays, const mesh::MeshTree& mesh, std::span<std::optional<TriangleHit>> hits);
[[nodiscard]] bool hits_any(const Ray& ray, const mesh::MeshTree& mesh);

}  // namespace crofton::mesh
