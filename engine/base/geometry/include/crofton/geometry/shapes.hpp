// SPDX-License-Identifier: MIT
// Simple figures in space and in the plane, rigid transforms, and pairs of ids, as plain data.
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

// A half-space, given by its boundary plane: the points x with dot(normal, x) + offset >= 0. The normal points inward,
// to the side that is kept.
struct Plane {
    glm::dvec3 normal{0.0};
    double offset = 0.0;
};

// A solid sphere, the cheapest bound: all points within `radius` ≥ 0 of `center`.
struct Sphere {
    glm::dvec3 center{0.0};
    double radius = 0.0;
};

// A line, unbounded on both sides: the points point + t · direction for all real t. `direction` is a unit vector. Its
// sign has no meaning unless a function says so.
struct Line {
    glm::dvec3 point{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};
};

// A ray or segment: the points origin + t · direction, 0 ≤ t ≤ max_t. The segment from p to q is {p, q − p, 1}.
// `direction` need not have unit length; max_t may be infinite. A ray that fails validate hits nothing.
struct Ray {
    glm::dvec3 origin{0.0}, direction{0.0, 0.0, 1.0};
    double max_t = std::numeric_limits<double>::infinity();
};

// Checks a ray. Errors: an origin or direction that is not finite; a direction of 0; max_t negative or NaN.
[[nodiscard]] Result<void> validate(const Ray& ray, std::uint64_t item = kNoItem);

// A triangle in space, by its vertices.
using Triangle = std::array<glm::dvec3, 3>;

// A solid circle in the plane: all points within `radius` ≥ 0 of `center`.
struct Disc {
    glm::dvec2 center{0.0};
    double radius = 0.0;
};

// A rectangle in the plane: the points p with |dot(axis, p − center)| ≤ half_extents.x and |dot(perp(axis), p −
// center)| ≤ half_extents.y, where perp(x, y) = (−y, x). `axis` has unit length up to rounding.
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

// The pose of a body: x ↦ rotation · x + translation. `rotation` is orthonormal to 1e-6: no scale, no shear; a
// reflection is allowed.
struct RigidTransform {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation{0.0};
};

// Checks a pose. Errors: non-finite entries, a matrix that is not a rotation, a translation beyond 1e18.
[[nodiscard]] Result<void> validate(const RigidTransform& pose, std::uint64_t item = kNoItem);

// Returns the transformed point as all queries see it: the expression above rounded in double, with magnitudes below
// 1e-60 taken as 0. "Exact" answers for posed meshes are exact for these points.
[[nodiscard]] glm::dvec3 transform(const RigidTransform& pose, const glm::dvec3& point);

[[nodiscard]] RigidTransform inverse(const RigidTransform& pose);
[[nodiscard]] RigidTransform operator*(const RigidTransform& outer, const RigidTransform& inner);

// Returns the pose of b in a's frame, for poses of both in the world.
[[nodiscard]] RigidTransform relative(const RigidTransform& a, const RigidTransform& b);

// A pair of items as indices into the caller's boxes, first < second. Pairs are ordered by first, then by second.
struct IdPair {
    std::uint32_t first = 0, second = 0;
    auto operator<=>(const IdPair&) const = default;
};

}  // namespace crofton
