// SPDX-License-Identifier: MIT
// Simple figures as plain data: of space, of the plane; rigid transforms; pairs of ids.
#pragma once
#include <array>
#include <compare>
#include <crofton/core/error.hpp>
#include <crofton/core/version.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

// A half-space, by its boundary plane.
// The points x with dot(normal, x) + offset >= 0: the normal points inward, to the side that is kept.
struct Plane {
    glm::dvec3 normal{0.0};
    double offset = 0.0;
};

// Sphere, a solid one: the cheapest bound.
// All points within `radius` ≥ 0 of `center`.
struct Sphere {
    glm::dvec3 center{0.0};
    double radius = 0.0;
};

// Line: unbounded on both sides.
// The points point + t · direction for all real t. `direction` is a unit vector; the line has no sense of direction
// unless its user says so.
struct Line {
    glm::dvec3 point{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};
};

// A ray or segment in space.
// The points origin + t · direction, 0 ≤ t ≤ max_t; a segment from p to q is {p, q − p, 1}. `direction` need not be of
// unit length, max_t may be infinite. A ray that fails validate hits nothing.
struct Ray {
    glm::dvec3 origin{0.0}, direction{0.0, 0.0, 1.0};
    double max_t = std::numeric_limits<double>::infinity();
};

// Errors: an origin or direction that is not finite; no direction; max_t negative or NaN.
[[nodiscard]] Result<void> validate(const Ray& ray, std::uint64_t item = kNoItem);

// A triangle in space, by its vertices.
using Triangle = std::array<glm::dvec3, 3>;

// Disc: a solid circle of the plane.
// All points within `radius` ≥ 0 of `center`.
struct Disc {
    glm::dvec2 center{0.0};
    double radius = 0.0;
};

// Rectangle: the oriented box of the plane.
// The points p with |dot(axis, p − center)| ≤ half_extents.x and |dot(perp(axis), p − center)| ≤ half_extents.y, where
// perp(x, y) = (−y, x). `axis` has unit length up to rounding.
struct Rectangle {
    glm::dvec2 center{0.0};
    glm::dvec2 axis{1.0, 0.0};
    glm::dvec2 half_extents{0.0};
};

[[nodiscard]] inline double area(const Rectangle& rectangle) {
    return 4.0 * rectangle.half_extents.x * rectangle.half_extents.y;
}
[[nodiscard]] inline double perimeter(const Rectangle& rectangle) {
    return 4.0 * (rectangle.half_extents.x + rectangle.half_extents.y);
}

// Where one body is, seen from another.
// x ↦ rotation · x + translation; `rotation` is orthonormal to 1e-6 (no scale, no shear; a reflection is allowed).
struct RigidTransform {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation{0.0};
};

// Errors: non-finite entries, a rotation that is none, a translation beyond 1e18.
[[nodiscard]] Result<void> validate(const RigidTransform& pose, std::uint64_t item = kNoItem);

// The point as all queries see it: this expression rounded in double, magnitudes below 1e-60 taken as 0. "Exact" for
// posed meshes means: for these points.
[[nodiscard]] glm::dvec3 transform(const RigidTransform& pose, const glm::dvec3& point);

[[nodiscard]] RigidTransform inverse(const RigidTransform& pose);
[[nodiscard]] RigidTransform operator*(const RigidTransform& outer, const RigidTransform& inner);

// The pose of b in a's frame, for poses of both in the world.
[[nodiscard]] RigidTransform relative(const RigidTransform& a, const RigidTransform& b);

// Two of many items, by index.
// Indices into the caller's boxes, first < second; ordered by first, then second.
struct IdPair {
    std::uint32_t first = 0, second = 0;
    auto operator<=>(const IdPair&) const = default;
};

}  // namespace crofton
