// SPDX-License-Identifier: MIT
#include "mass_integrals.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton::convex {

// ∫ x over a simplex is its volume times the mean of the corners. ∫ x xᵀ is volume / 20 times (s sᵀ + Σ v vᵀ), s the
// sum of the corners.
void Moments::add_tetrahedron(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const double part = glm::dot(glm::cross(a, b), c) / 6.0;
    const glm::dvec3 sum = a + b + c;
    volume += part;
    first += 0.25 * part * sum;
    second +=
        part / 20.0 *
        (glm::outerProduct(sum, sum) + glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(c, c));
}

MassProperties mass_of(const Moments& moments, const glm::dvec3& origin) {
    MassProperties mass;
    mass.volume = moments.volume;
    const glm::dvec3 mean = moments.volume > 0.0 ? moments.first / moments.volume : glm::dvec3(0.0);
    mass.center = origin + mean;
    const glm::dmat3 central = moments.second - moments.volume * glm::outerProduct(mean, mean);
    mass.inertia = -central;
    // Not the trace less the entry: of a needle nothing would be left.
    for (int k = 0; k < 3; ++k)
        mass.inertia[k][k] = central[(k + 1) % 3][(k + 1) % 3] + central[(k + 2) % 3][(k + 2) % 3];
    return mass;
}

MassProperties mass_of_triangles(std::span<const glm::dvec3> points,
                                 const Vector<std::array<std::uint32_t, 3>>& triangles) {
    // About the mean of the points, so that a hull far from its frame's origin loses nothing.
    glm::dvec3 origin(0.0);
    for (const glm::dvec3& p : points) origin += p / static_cast<double>(points.size());
    Moments moments;
    for (const auto& t : triangles)
        moments.add_tetrahedron(points[t[0]] - origin, points[t[1]] - origin, points[t[2]] - origin);
    return mass_of(moments, origin);
}

}  // namespace crofton::convex
