// The last step of every fit: a float box with given axes that provably holds every point.
#pragma once
#include <crofton/geometry/obb.hpp>

#include "point_cloud.hpp"
#include "weights.hpp"

namespace crofton::fit {

inline constexpr std::size_t kFew = 256;  // points; so few are searched and enclosed as a whole

// The box with these axes and a centre within rounding of the best, whose half extents are the least floats such that
// contains(box, p) holds for all points of the cloud.
[[nodiscard]] Obb enclose(PointCloud& cloud, const glm::mat3& axes);

// The same by plain passes over all points: quicker where they are few.
[[nodiscard]] Obb enclose_few(const PointCloud& cloud, const glm::mat3& axes);

// Orthonormal axes rounded to float, for a box of these edges. A rounded axis is tilted by up to 6e-8, which widens the
// box across it, much where it is long and the box thin there: where that costs the criterion more than `tolerance`,
// relatively, floats within a few units are tried for a smaller tilt. Exact where the axes are coordinate axes.
[[nodiscard]] glm::mat3 rounded(const glm::dmat3& axes, const glm::dvec3& edges, const Weights& weights,
                                double tolerance);

}  // namespace crofton::fit
