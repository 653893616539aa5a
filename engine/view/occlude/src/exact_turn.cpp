// SPDX-License-Identifier: MIT
#include "exact_turn.hpp"

#include <cmath>
#include <crofton/geometry/dyadic.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/moderate_length.hpp>
#include <glm/geometric.hpp>

namespace crofton::occlude {
// In double each term a (p − q) is off by 3 u |a| (|p| + |q|), with u = 2^-53. The sum of three is off by 2 u more; 16
// u are taken. What underflows is below 1e-300 as long as |a| is at most 1e15.
int sign_of_determinant(const glm::dmat3& m) {
    double value = 0.0, size = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double p = m[1][(k + 1) % 3] * m[2][(k + 2) % 3], q = m[1][(k + 2) % 3] * m[2][(k + 1) % 3];
        value += m[0][k] * (p - q);
        size += std::fabs(m[0][k]) * (std::fabs(p) + std::fabs(q));
    }
    if (std::fabs(value) > 0x1p-49 * size + 1e-290) return value > 0.0 ? 1 : -1;
    Dyadic sum;
    for (int k = 0; k < 3; ++k)
        sum = sum + Dyadic(m[0][k]) * (Dyadic(m[1][(k + 1) % 3]) * Dyadic(m[2][(k + 2) % 3]) -
                                       Dyadic(m[1][(k + 2) % 3]) * Dyadic(m[2][(k + 1) % 3]));
    return sum.sign();
}

glm::dvec3 direction_across(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 u = of_moderate_length(a), v = of_moderate_length(b);
    glm::dvec3 across;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        across[k] = (exact_product(u[i], v[j]) - exact_product(u[j], v[i])).estimate();
    }
    across = of_moderate_length(across);
    return across / glm::length(across);
}

}  // namespace crofton::occlude
