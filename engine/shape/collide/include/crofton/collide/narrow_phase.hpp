// SPDX-License-Identifier: MIT
// Overlap of boxes, exactly: with boxes, one pair or many, and with spheres, capsules, triangles, half-spaces.
//
// For distance, depth, contacts, rays and casts, of boxes too, see crofton/convex: one family for all shapes.
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

// Counts of how the pairs of a batch were decided. The first four sum to the number of pairs.
struct BatchStatistics {
    std::uint64_t separated_by_face_a = 0;  // early out: a face normal of the first box
    std::uint64_t separated_by_face_b = 0;
    std::uint64_t separated_by_edges = 0;  // only a cross product of edges separates them
    std::uint64_t hits = 0;
    std::uint64_t refined = 0;  // pairs that float could not decide, decided in double or exactly

    BatchStatistics& operator+=(const BatchStatistics& other);
};

// Sets hits[i] = intersects(a[i], b[i]). Requires equal sizes. Allocates nothing.
BatchStatistics intersects(std::span<const Obb> a, std::span<const Obb> b, std::span<std::uint8_t> hits);

// Sets hits[i] = intersects(boxes[pairs[i].first], boxes[pairs[i].second]). Requires hits.size() == pairs.size().
BatchStatistics intersects(std::span<const Obb> boxes, std::span<const IdPair> pairs, std::span<std::uint8_t> hits);

// ---- Spheres, capsules, triangles, half-spaces against boxes ----

// A capsule: all points within `radius` of the segment.
struct Capsule {
    glm::dvec3 begin{0.0}, end{0.0};
    double radius = 0.0;
};

// Test whether a box and another shape share a point; touching counts, and NaN overlaps nothing.
//
// Half-spaces { x : dot(normal, x) + offset ≥ 0 } and triangles: exact for the stored numbers, for every valid box and
// coordinates of 0 or magnitude in [1e-70, 1e30]. Spheres and capsules: a gap or overlap below 1e-13 of the
// coordinates' size may be decided either way; one with a number beyond kMaxCoordinate overlaps nothing.
[[nodiscard]] bool intersects(const Obb& box, const Plane& half_space);
[[nodiscard]] bool intersects(const Obb& box, const Triangle& triangle);
[[nodiscard]] bool intersects(const Obb& box, const Sphere& sphere);
[[nodiscard]] bool intersects(const Obb& box, const Capsule& capsule);

// A contact point of two boxes, spheres or meshes of a World.
struct ContactPoint {
    glm::dvec3 position{0.0};  // midway between the surfaces
    double depth = 0.0;        // ≥ 0, along the normal
};

}  // namespace crofton::collide
