// The last step of every fit: a float box with given axes that provably holds every point.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <span>

namespace crofton::fit {

// The smallest half extents (in floats) around a centre that is within rounding of the best one, such that
// contains(box, p) holds for all points. `reference` lies near the points and does not depend on their order. Requires
// finite points, at least one; |coordinates| ≤ kMaxCoordinate.
[[nodiscard]] Obb enclose(std::span<const glm::vec3> points, const glm::mat3& axes, const glm::dvec3& reference);
[[nodiscard]] Obb enclose(std::span<const glm::dvec3> points, const glm::mat3& axes, const glm::dvec3& reference);

// Orthonormal axes rounded to float; exact where the axes are the coordinate axes.
[[nodiscard]] glm::mat3 rounded(const glm::dmat3& axes);

}  // namespace crofton::fit
