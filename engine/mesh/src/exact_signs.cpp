#include "exact_signs.hpp"

#include <array>
#include <cmath>
#include <crofton/geometry/expansion.hpp>
#include <crofton/mesh/triangle_triangle.hpp>

#include "sign_filter.hpp"

namespace crofton::mesh {
namespace {

using Exact3 = std::array<Expansion<2>, 3>;

Exact3 exact_offset(const glm::dvec3& a, const glm::dvec3& b) {
    return {exact_difference(b.x, a.x), exact_difference(b.y, a.y), exact_difference(b.z, a.z)};
}

int exact_orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const Exact3 u = exact_offset(a, b), v = exact_offset(a, c), w = exact_offset(a, d);
    const auto term = [&](std::size_t i, std::size_t j, std::size_t k) { return (u[i] * v[j] - u[j] * v[i]) * w[k]; };
    return (term(1, 2, 0) + term(2, 0, 1) + term(0, 1, 2)).sign();
}

}  // namespace

int orientation_sign(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const int sign = orientation_filter(a, b, c, d);
    return sign == kUnknownSign ? exact_orientation(a, b, c, d) : sign;
}

int orientation_2d(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int i, int j) {
    const double left = (b[i] - a[i]) * (c[j] - a[j]), right = (b[j] - a[j]) * (c[i] - a[i]);
    // Shewchuk's bound ccwerrboundA, (3 + 16u)u, rounded up.
    const double error = 0x1.9p-52 * (std::abs(left) + std::abs(right));
    const double difference = left - right;
    if (difference > error) return 1;
    if (difference < -error) return -1;
    const auto exact_left = exact_difference(b[i], a[i]) * exact_difference(c[j], a[j]);
    const auto exact_right = exact_difference(b[j], a[j]) * exact_difference(c[i], a[i]);
    return (exact_left - exact_right).sign();
}

}  // namespace crofton::mesh
