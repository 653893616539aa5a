// SPDX-License-Identifier: MIT
// Axis-aligned bounding box.
#pragma once
#include <crofton/core/requirements.hpp>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace crofton {

// The closed box [min, max]; empty where any min > max, as when default-constructed.
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

// Closed boxes: touching counts.
[[nodiscard]] inline bool intersects(const Aabb& a, const Aabb& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
           b.min.z <= a.max.z;
}

}  // namespace crofton
