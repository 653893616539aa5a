// The last step of every fit: a float box with given axes that provably holds every point.
#pragma once
#include <crofton/geometry/obb.hpp>

#include "point_cloud.hpp"

namespace crofton::fit {

// The box with these axes and a centre within rounding of the best, whose half extents are the least floats such that
// contains(box, p) holds for all points of the cloud.
[[nodiscard]] Obb enclose(PointCloud& cloud, const glm::mat3& axes);

// Orthonormal axes rounded to float; exact where the axes are the coordinate axes.
[[nodiscard]] glm::mat3 rounded(const glm::dmat3& axes);

}  // namespace crofton::fit
