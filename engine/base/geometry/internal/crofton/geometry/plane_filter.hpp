// SPDX-License-Identifier: MIT
// The side of a plane on which a point lies, in double, with the bound that says when the answer is certain.
#pragma once
#include <array>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace crofton {

inline constexpr int kUnknownSign = 2;

// The plane through a, b, c, for the sides of many points.
struct PlaneFilter {
    // Shewchuk's bound A of the three-dimensional orientation test (1997, figure 23), (7 + 56u)u with u = 2^-53,
    // rounded up. det(b − a, c − a, d − a) by cofactors is off by at most this times the same expression with all terms
    // positive.
    static constexpr double kErrorBound = 0x1.d0p-51;

    explicit PlaneFilter(const std::array<glm::dvec3, 3>& t) : PlaneFilter(t[0], t[1], t[2]) {}
    PlaneFilter(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) : origin(a) {
        const glm::dvec3 u = b - a, v = c - a;
        const glm::dvec3 left(u.y * v.z, u.z * v.x, u.x * v.y), right(u.z * v.y, u.x * v.z, u.y * v.x);
        normal = left - right;
        magnitude = glm::abs(left) + glm::abs(right);
    }

    // Returns orientation(a, b, c, d) if it is certain and not 0, else kUnknownSign.
    [[nodiscard]] int side(const glm::dvec3& d) const {
        const glm::dvec3 w = d - origin;
        const double above = glm::dot(normal, w);
        const double error_bound = kErrorBound * glm::dot(magnitude, glm::abs(w));
        if (above > error_bound) return -1;
        return above < -error_bound ? 1 : kUnknownSign;
    }

    glm::dvec3 origin, normal, magnitude;
};

}  // namespace crofton
