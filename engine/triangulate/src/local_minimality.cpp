#include "local_minimality.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/predicates.hpp>
#include <utility>

namespace crofton::triangulate {

bool shorter(std::span<const glm::dvec2> points, Index a, Index b, Index p, Index q) {
    const glm::dvec2 d = points[a] - points[b], e = points[p] - points[q];
    const double dd = d.x * d.x + d.y * d.y, ee = e.x * e.x + e.y * e.y;
    // Each squared length errs by less than 4 units of 2^-53.
    if (std::fabs(dd - ee) > (dd + ee) * 0x1p-50) return dd < ee;
    const auto square = [&](Index i, Index j) {
        const auto x = exact_difference(points[i].x, points[j].x), y = exact_difference(points[i].y, points[j].y);
        return x * x + y * y;
    };
    const int sign = (square(a, b) - square(p, q)).sign();
    if (sign != 0) return sign < 0;
    return std::pair(std::min(a, b), std::max(a, b)) < std::pair(std::min(p, q), std::max(p, q));
}

bool locally_minimal(std::span<const glm::dvec2> points, Index p, Index q, Index left, Index right) {
    return !shorter(points, left, right, p, q) || orientation(points[right], points[left], points[p]) <= 0 ||
           orientation(points[right], points[left], points[q]) >= 0;
}

bool candidates_cross(std::span<const glm::dvec2> points, Index a, Index b, Index c, Index d) {
    if (a == c || a == d || b == c || b == d) return false;
    return orientation(points[a], points[b], points[c]) * orientation(points[a], points[b], points[d]) < 0 &&
           orientation(points[c], points[d], points[a]) * orientation(points[c], points[d], points[b]) < 0;
}

}  // namespace crofton::triangulate
