// Signs of 3 × 3 determinants in double, with the bound that says when they are certain.
#pragma once
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace crofton::mesh {

inline constexpr int kUnknownSign = 2;

// Shewchuk's o3derrboundA = (7 + 56u)u, u = 2^-53, rounded up: det(b − a, c − a, d − a) evaluated by cofactors is off
// by at most this times the same expression with all terms positive.
inline constexpr double kOrientationError = 0x1.d0p-51;

// The plane through three points, for the sides of many others.
struct PlaneFilter {
    explicit PlaneFilter(const std::array<glm::dvec3, 3>& t) : PlaneFilter(t[0], t[1], t[2]) {}
    PlaneFilter(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) : origin(a) {
        const glm::dvec3 u = b - a, v = c - a;
        const glm::dvec3 left(u.y * v.z, u.z * v.x, u.x * v.y), right(u.z * v.y, u.x * v.z, u.y * v.x);
        normal = left - right;
        magnitude = glm::abs(left) + glm::abs(right);
    }
    [[nodiscard]] int side(const glm::dvec3& d) const {
        const glm::dvec3 w = d - origin;
        const double determinant = glm::dot(normal, w);
        const double error = kOrientationError * glm::dot(magnitude, glm::abs(w));
        if (determinant > error) return 1;
        return determinant < -error ? -1 : kUnknownSign;
    }

    glm::dvec3 origin, normal, magnitude;
};

// −1 or +1 when certain, else kUnknownSign.
[[nodiscard]] inline int orientation_filter(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                                            const glm::dvec3& d) {
    return PlaneFilter(a, b, c).side(d);
}

}  // namespace crofton::mesh
