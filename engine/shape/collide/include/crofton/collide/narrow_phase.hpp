// SPDX-License-Identifier: MIT
// Two bodies: do they meet, how far apart, how deep, where, when.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::collide {

// ---- Overlap of oriented boxes ----

// True iff the two exact parallelepipeds share a point; touching counts. Filtered separating-axis test (Gottschalk,
// Lin, Manocha 1996) with a proven error bound, then exact arithmetic. Exact for every pair of boxes that validate(Obb)
// accepts; a box with NaN or infinite members meets nothing.
[[nodiscard]] bool intersects(const Obb& a, const Obb& b);

// Which axis tells two boxes apart, for statistics and for warm starts. Axes 0-2 are the face normals of `a`, 3-5 those
// of `b`. Axis 6 + 3i + j is the cross product of edge i of `a` with edge j of `b`.
inline constexpr int kAxisCount = 15;
inline constexpr int kNotSeparated = -1;

// The first separating axis found, or kNotSeparated when the boxes meet. Starts with `hint`, an axis that separated
// them before, when that is in [0, 15). Which of several separating axes is returned is the same on every machine.
[[nodiscard]] int separating_axis(const Obb& a, const Obb& b, int hint = kNotSeparated);

// Many pairs of boxes at once: the exact answers of intersects(Obb, Obb), sixteen pairs to a step.

struct BoxBlock;

// How the pairs of a batch were decided; the first four sum to the number of pairs.
struct BatchStatistics {
    std::uint64_t separated_by_face_a = 0;  // early out: a face normal of the first box
    std::uint64_t separated_by_face_b = 0;
    std::uint64_t separated_by_edges = 0;  // only a cross product of edges tells them apart
    std::uint64_t hits = 0;
    std::uint64_t refined = 0;  // of all: pairs that float could not decide, done in double or exactly

    BatchStatistics& operator+=(const BatchStatistics& other);
};

// Boxes packed for repeated use. The caller's boxes are kept by reference and must live, unchanged, as long as queries
// are made. Pairs that float cannot decide are decided from them.
class PackedBoxes {
  public:
    PackedBoxes();
    ~PackedBoxes();
    PackedBoxes(PackedBoxes&&) noexcept;
    PackedBoxes& operator=(PackedBoxes&&) noexcept;

    // Any finite origin near the boxes; the nearer, the fewer pairs are left to the slow path. Answers do not depend on
    // it.
    void pack(std::span<const Obb> boxes, const glm::dvec3& origin);
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const BoxBlock> blocks() const;  // for the queries
    [[nodiscard]] const glm::dvec3& origin() const { return origin_; }

  private:
    ResetOnMove<std::span<const Obb>> boxes_;
    Vector<BoxBlock> blocks_;
    glm::dvec3 origin_{0.0};
};

// hits[i] = intersects(a.boxes()[i], b.boxes()[i]). Requires equal sizes and equal origins. Allocates nothing.
BatchStatistics intersects(const PackedBoxes& a, const PackedBoxes& b, std::span<std::uint8_t> hits);

// hits[i] = intersects(a[i], b[i]), straight from the boxes.
BatchStatistics intersects(std::span<const Obb> a, std::span<const Obb> b, std::span<std::uint8_t> hits);

// hits[i] = intersects(boxes[pairs[i].first], boxes[pairs[i].second]). Requires hits.size() == pairs.size().
BatchStatistics intersects(std::span<const Obb> boxes, std::span<const IdPair> pairs, std::span<std::uint8_t> hits);

}  // namespace crofton::collide

namespace crofton::mesh {

// Convex bodies: what meets, how far apart, how deep.
class MeshTree;
struct MeshContact;
}  // namespace crofton::mesh

namespace crofton::collide {

// ---- Spheres, capsules, triangles, half-spaces against boxes ----

// All points within `radius` of the segment.
struct Capsule {
    glm::dvec3 begin{0.0}, end{0.0};
    double radius = 0.0;
};

// Touching counts, NaN meets nothing. Half-spaces { x : dot(normal, x) + offset ≥ 0 } and triangles: exact for the
// stored numbers, for every valid box and coordinates of 0 or magnitude in [1e-70, 1e30]. Spheres and capsules: a gap
// or overlap below 1e-13 of the coordinates' size may be told either way. One with a number beyond kMaxCoordinate meets
// nothing.
[[nodiscard]] bool intersects(const Obb& box, const Plane& half_space);
[[nodiscard]] bool intersects(const Obb& box, const Triangle& triangle);
[[nodiscard]] bool intersects(const Obb& box, const Sphere& sphere);
[[nodiscard]] bool intersects(const Obb& box, const Capsule& capsule);

// How far apart two bodies are, how deep they overlap, where they touch. Of hulls and of all other bodies: convex.

struct Distance {
    double distance = 0.0;            // 0 when they meet
    glm::dvec3 on_a{0.0}, on_b{0.0};  // nearest points; of boxes that meet, one point within 1e-6 of the size of both
};

// For numbers up to kMaxCoordinate. Whether the distance is 0 is exact: iff intersects(a, b). Else within 1e-12 of the
// size, which is the sum of the half extents and of the offset of the centres.
[[nodiscard]] Distance distance(const Obb& a, const Obb& b);
// The same for a capsule's segment, minus the radius; 0 iff intersects(box, capsule). A sphere is a capsule whose ends
// are equal.
[[nodiscard]] Distance distance(const Obb& box, const Capsule& capsule);
// In double: within 1e-15 of the coordinates' size and the radii.
[[nodiscard]] Distance distance(const Capsule& capsule, const Sphere& sphere);

// The shortest motion of b that ends the overlap is depth · axis; the axis has unit length and points from a to b. A
// negative depth is a gap: the bodies are at least so far apart. Over the separating axes of the two bodies: exact for
// the depth up to rounding.
struct Penetration {
    double depth = 0.0;
    glm::dvec3 axis{0.0};
};
[[nodiscard]] Penetration penetration(const Obb& a, const Obb& b);
// The half-space's surface pushes the box out along its normal.
[[nodiscard]] Penetration penetration(const Plane& half_space, const Obb& box);

struct ContactPoint {
    glm::dvec3 position{0.0};  // midway between the surfaces, in the frame of the bodies asked about
    double depth = 0.0;        // ≥ 0, along the normal
};
struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 when the bodies do not meet
    ContactPoint points[8];
};
enum class ManifoldPoints : std::uint8_t {
    reduced,  // at most four: the deepest, and those that keep most of the area
    all,      // up to eight
};
// Where two boxes touch: the incident face clipped against the reference face (Sutherland, Hodgman), or the nearest
// points of two edges. Points come in order around the incident face: the same input gives the same order. Boxes that
// meet exactly, but by less than rounding tells, give one point at least. Points are off by rounding of the boxes' size
// and distance, not of their coordinates.
[[nodiscard]] Manifold contact_manifold(const Obb& a, const Obb& b, ManifoldPoints points = ManifoldPoints::reduced);
// Where two meshes touch, in a's frame: at most four points, from all their contacts (mesh::contacts). The normal is
// that of the curve in which the surfaces cross, by its vector area. An even pressure between the bodies would push in
// that direction. The points are the deepest and those that keep most of the area. A depth is how far b has to move
// along the normal until the surfaces part on the line through the point. It is 0 where the point lies in no overlap.
// No contacts: no points.
[[nodiscard]] Manifold contact_manifold(const mesh::MeshTree& a, const mesh::MeshTree& b, const RigidTransform& b_to_a,
                                        std::span<const mesh::MeshContact> contacts);
// One point, at the sphere's deepest place; none where they do not meet. Spheres with one center part along z.
[[nodiscard]] Manifold contact_manifold(const Obb& box, const Sphere& sphere);
[[nodiscard]] Manifold contact_manifold(const Sphere& a, const Sphere& b);
[[nodiscard]] Manifold contact_manifold(const Plane& half_space, const Obb& box,
                                        ManifoldPoints points = ManifoldPoints::reduced);

}  // namespace crofton::collide
