// SPDX-License-Identifier: MIT
// Axis-aligned and oriented boxes.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/core/version.hpp>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace crofton {

// An axis-aligned bounding box: the closed box [min, max]. It is empty if any min > max; a default-constructed one is
// empty.
struct Aabb {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool is_empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    [[nodiscard]] glm::dvec3 center() const { return min + 0.5 * (max - min); }
    [[nodiscard]] glm::dvec3 half_extents() const { return 0.5 * (max - min); }

    void include(const glm::dvec3& point) {
        min = (glm::min)(min, point);
        max = (glm::max)(max, point);
    }
    void include(const Aabb& other) {
        min = (glm::min)(min, other.min);
        max = (glm::max)(max, other.max);
    }
};

// Tests whether two boxes share a point; touching counts.
[[nodiscard]] inline bool intersects(const Aabb& a, const Aabb& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
           b.min.z <= a.max.z;
}

// An oriented bounding box, the bound that all modules share.
//
// It is the exact parallelepiped { center + Σ t_k · half_extents[k] · axes[k] : |t_k| ≤ 1 } of the stored numbers,
// taken as reals. `axes[k]` is column k; the axes are linearly independent and have unit length up to float rounding.
// half_extents ≥ 0; zero is allowed. The centre is double, so that boxes keep their place at planetary coordinates; the
// shape is float.
struct Obb {
    glm::dvec3 center{0.0};
    glm::mat3 axes{1.0f};
    glm::vec3 half_extents{0.0f};
};
static_assert(sizeof(Obb) == 72, "a GLM_FORCE_ macro has changed the layout of GLM's types");

// Larger coordinates are refused, so that products of a few of them stay within double.
inline constexpr double kMaxCoordinate = 1e30;
// The largest deviation of the axes from orthonormal, |dot(axes[i], axes[j]) − δij|. The float rounding of a rotation
// stays below 1e-6.
inline constexpr double kMaxAxisDeviation = 1e-4;

// Checks the requirements of Obb. The error's item is `item`.
[[nodiscard]] Result<void> validate(const Obb& box, std::uint64_t item = kNoItem);

// Returns the corners, rounded to double. Corner i has t_k = −1 if bit k of i is 0, and +1 if it is 1.
[[nodiscard]] std::array<glm::dvec3, 8> corners(const Obb& box);

// Tests whether `point` lies in the exact parallelepiped, boundary included. Exact for coordinates of 0 or 1e-200 to
// 1e250.
[[nodiscard]] bool contains(const Obb& box, const glm::dvec3& point);

// Tests the slab between the two faces across axes[k] only. The point is in the box iff it is in all three slabs.
[[nodiscard]] bool contains_along(const Obb& box, const glm::dvec3& point, int k);

// Returns the farthest point of the box along `direction` (of any length), rounded to double.
[[nodiscard]] glm::dvec3 support_point(const Obb& box, const glm::dvec3& direction);

// Returns the smallest axis-aligned box in double that contains the whole parallelepiped, rounded outward.
[[nodiscard]] Aabb aabb_of(const Obb& box);

[[nodiscard]] Obb obb_of(const Aabb& box);  // contains `box`, grown by at most the rounding of half_extents to float

[[nodiscard]] double volume(const Obb& box);
[[nodiscard]] double surface_area(const Obb& box);
[[nodiscard]] double edge_sum(const Obb& box);  // a + b + c for edges a, b, c; M = π · edge_sum

}  // namespace crofton
