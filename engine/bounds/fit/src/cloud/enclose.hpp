// SPDX-License-Identifier: MIT
// The last step of every fit: a float box with given axes that holds every point, by exact tests.
#pragma once
#include <crofton/geometry/box.hpp>

#include "cloud/point_cloud.hpp"
#include "search/weights.hpp"

namespace crofton::fit {

inline constexpr std::size_t kSmallSet = 256;  // up to so many points a set is searched and enclosed as a whole

// The box with these axes and a centre within rounding of the best. Its half extents are the least floats such that
// contains(box, p) holds for all points p of the cloud. The same bits for any order of the points.
[[nodiscard]] Obb enclose(PointCloud& cloud, const glm::mat3& axes);

// The same by two passes over all points: quicker for small sets.
[[nodiscard]] Obb enclose_small_set(const PointCloud& cloud, const glm::mat3& axes);

// Orthonormal axes rounded to float, for a box of these edges. Rounding tilts an axis by up to 6e-8, which widens the
// box's other edges by that part of the axis's edge. Where this raises the criterion by more than `tolerance`,
// relatively, floats within 4 units of the nearest are tried for a smaller tilt. Coordinate axes stay exact.
[[nodiscard]] glm::mat3 rounded(const glm::dmat3& axes, const glm::dvec3& edges, const Weights& weights,
                                double tolerance);

}  // namespace crofton::fit
