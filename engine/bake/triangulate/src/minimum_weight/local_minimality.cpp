// SPDX-License-Identifier: MIT
#include "minimum_weight/local_minimality.hpp"

#include <algorithm>
#include <crofton/geometry/expansion.hpp>
#include <utility>

namespace crofton::triangulate {

bool shorter_exactly(std::span<const glm::dvec2> points, Index a, Index b, Index p, Index q) {
    const auto square = [&](Index i, Index j) {
        const auto x = exact_difference(points[i].x, points[j].x), y = exact_difference(points[i].y, points[j].y);
        return x * x + y * y;
    };
    const int sign = (square(a, b) - square(p, q)).sign();
    if (sign != 0) return sign < 0;
    return std::pair(std::min(a, b), std::max(a, b)) < std::pair(std::min(p, q), std::max(p, q));
}

bool candidates_cross(std::span<const glm::dvec2> points, Index a, Index b, Index c, Index d) {
    if (a == c || a == d || b == c || b == d) return false;
    return orientation(points[a], points[b], points[c]) * orientation(points[a], points[b], points[d]) < 0 &&
           orientation(points[c], points[d], points[a]) * orientation(points[c], points[d], points[b]) < 0;
}

}  // namespace crofton::triangulate
