// SPDX-License-Identifier: MIT
// Two boxes, spheres, capsules, triangles or half-spaces: overlap, distance, depth, contacts.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::collide {

// ---- Overlap of oriented boxes ----

// Tests whether the two exact parallelepipeds share a point; touching counts.
//
// Exact for every pair of boxes that validate(Obb) accepts: a filtered separating-axis test (Gottschalk, Lin, Manocha
// 1996) with a proven error bound, then exact arithmetic. A box with NaN or infinite members overlaps nothing.
[[nodiscard]] bool intersects(const Obb& a, const Obb& b);

// Numbers of separating axes, for statistics and for warm starts. Axes 0-2 are the face normals of `a`, 3-5 those of
// `b`. Axis 6 + 3i + j is the cross product of edge i of `a` with edge j of `b`.
inline constexpr int kAxisCount = 15;
inline constexpr int kNotSeparated = -1;

// Returns the first separating axis found, or kNotSeparated if the boxes overlap.
//
// The search starts with `hint`, an axis that separated the boxes before, if it is in [0, 15). Of several separating
// axes it returns the same one on every machine.
[[nodiscard]] int separating_axis(const Obb& a, const Obb& b, int hint = kNotSeparated);

// Many pairs of boxes at once: the exact answers of intersects(Obb, Obb), sixteen pairs per step.

struct BoxBlock;

// Counts of how the pairs of a batch were decided. The first four sum to the number of pairs.
struct BatchStatistics {
    std::uint64_t separated_by_face_a = 0;  // early out: a face normal of the first box
    std::uint64_t separated_by_face_b = 0;
    std::uint64_t separated_by_edges = 0;  // only a cross product of edges separates them
    std::uint64_t hits = 0;
    std::uint64_t refined = 0;  // pairs that float could not decide, decided in double or exactly

    BatchStatistics& operator+=(const BatchStatistics& other);
};

// Boxes packed for repeated use. It refers to your boxes, which must stay alive and unchanged while you make queries:
// pairs that float cannot decide are decided from them.
class PackedBoxes {
  public:
    PackedBoxes();
    ~PackedBoxes();
    PackedBoxes(PackedBoxes&&) noexcept;
    PackedBoxes& operator=(PackedBoxes&&) noexcept;

    // Packs the boxes. `origin` is any finite point near the boxes; the nearer, the fewer pairs take the slow path.
    // Answers do not depend on it.
    void pack(std::span<const Obb> boxes, const glm::dvec3& origin);
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const BoxBlock> blocks() const;  // for the queries
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }

  private:
    ResetOnMove<std::span<const Obb>> boxes_;
    Vector<BoxBlock> blocks_;
    glm::dvec3 origin_{0.0};
};

// Sets hits[i] = intersects(a.boxes()[i], b.boxes()[i]). Requires equal sizes and equal origins. Allocates nothing.
BatchStatistics intersects(const PackedBoxes& a, const PackedBoxes& b, std::span<std::uint8_t> hits);

// Sets hits[i] = intersects(a[i], b[i]), without packing the boxes.
BatchStatistics intersects(std::span<const Obb> a, std::span<const Obb> b, std::span<std::uint8_t> hits);

// Sets hits[i] = intersects(boxes[pairs[i].first], boxes[pairs[i].second]). Requires hits.size() == pairs.size().
BatchStatistics intersects(std::span<const Obb> boxes, std::span<const IdPair> pairs, std::span<std::uint8_t> hits);

}  // namespace crofton::collide

namespace crofton::mesh {

// Declared here for contact_manifold below.
class MeshTree;
struct MeshContact;
}  // namespace crofton::mesh

namespace crofton::collide {

// ---- Spheres, capsules, triangles, half-spaces against boxes ----

// A capsule: all points within `radius` of the segment.
struct Capsule {
    glm::dvec3 begin{0.0}, end{0.0};
    double radius = 0.0;
};

// Test whether a box and another body share a point; touching counts, and NaN overlaps nothing.
//
// Half-spaces { x : dot(normal, x) + offset ≥ 0 } and triangles: exact for the stored numbers, for every valid box and
// coordinates of 0 or magnitude in [1e-70, 1e30]. Spheres and capsules: a gap or overlap below 1e-13 of the
// coordinates' size may be decided either way; one with a number beyond kMaxCoordinate overlaps nothing.
[[nodiscard]] bool intersects(const Obb& box, const Plane& half_space);
[[nodiscard]] bool intersects(const Obb& box, const Triangle& triangle);
[[nodiscard]] bool intersects(const Obb& box, const Sphere& sphere);
[[nodiscard]] bool intersects(const Obb& box, const Capsule& capsule);

// Distance, depth and contact points. For hulls and all other bodies see crofton/convex.

struct Distance {
    double distance = 0.0;            // 0 if they overlap
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; if boxes overlap, a point within 1e-6 of the size of both
};

// Returns the distance of two boxes, for numbers up to kMaxCoordinate.
//
// It is 0 iff intersects(a, b), exactly. Otherwise it is within 1e-12 of the size, which is the sum of the half extents
// and the distance of the centres.
[[nodiscard]] Distance distance(const Obb& a, const Obb& b);
// Returns the distance to a capsule's segment minus the radius; 0 iff intersects(box, capsule). A sphere is a capsule
// whose ends are equal.
[[nodiscard]] Distance distance(const Obb& box, const Capsule& capsule);
// Returns the distance in double, within 1e-15 of the coordinates' size and the radii.
[[nodiscard]] Distance distance(const Capsule& capsule, const Sphere& sphere);

// The depth of an overlap. The shortest motion of b that ends the overlap is depth · axis; the axis has unit length and
// points from a to b.
//
// A negative depth is a gap: the bodies are at least that far apart. It is computed over the separating axes of the two
// bodies, so the depth is exact up to rounding.
struct Penetration {
    double depth = 0.0;
    glm::dvec3 axis{0.0};
};
[[nodiscard]] Penetration penetration(const Obb& a, const Obb& b);
// Returns the depth of a box in a half-space, whose surface pushes the box out along its normal.
[[nodiscard]] Penetration penetration(const Plane& half_space, const Obb& box);

struct ContactPoint {
    glm::dvec3 position{0.0};  // midway between the surfaces, in the frame of the bodies
    double depth = 0.0;        // ≥ 0, along the normal
};
struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 if the bodies do not overlap
    ContactPoint points[8];
};
enum class ManifoldPoints : std::uint8_t {
    reduced,  // at most four: the deepest, and those that keep most of the area
    all,      // up to eight
};
// Returns where two boxes touch: the incident face clipped against the reference face (Sutherland, Hodgman), or the
// nearest points of two edges.
//
// Points are in order around the incident face: the same input gives the same order. Boxes that overlap exactly, but by
// less than rounding can show, give at least one point. Points are off by the rounding of the boxes' size and distance,
// not of their coordinates.
[[nodiscard]] Manifold contact_manifold(const Obb& a, const Obb& b, ManifoldPoints points = ManifoldPoints::reduced);
// Returns where two meshes touch, in a's frame: at most four points, from all their contacts (mesh::contacts). Without
// contacts there are no points.
//
// The normal is that of the curve in which the surfaces cross, by its vector area; an even pressure between the bodies
// would push in that direction. The points are the deepest and those that keep most of the area. The depth of a point
// is how far b has to move along the normal until the surfaces separate on the line through the point. It is 0 if the
// point lies in no overlap.
[[nodiscard]] Manifold contact_manifold(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                        std::span<const mesh::MeshContact> contacts);
// Returns one point, at the deepest point of the sphere, or none if the bodies do not overlap. Spheres with the same
// center separate along z.
[[nodiscard]] Manifold contact_manifold(const Obb& box, const Sphere& sphere);
[[nodiscard]] Manifold contact_manifold(const Sphere& a, const Sphere& b);
[[nodiscard]] Manifold contact_manifold(const Plane& half_space, const Obb& box,
                                        ManifoldPoints points = ManifoldPoints::reduced);

}  // namespace crofton::collide
