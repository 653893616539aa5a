// SPDX-License-Identifier: MIT
// Covariances of points, and principal directions of symmetric 3 × 3 matrices, by Jacobi rotations.
#pragma once
#include <cmath>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace crofton::mesh {

// Of point_at(0), …, point_at(count − 1), count > 0. Sums are relative to the first point: they lose nothing far from
// the origin.
template <class PointAt>
[[nodiscard]] glm::dmat3 covariance_of(std::size_t count, const PointAt& point_at) {
    const glm::vec3 origin = point_at(std::size_t{0});
    glm::dvec3 sum(0.0), squares(0.0), products(0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 p(point_at(i) - origin);
        sum += p;
        squares += p * p;
        products += glm::dvec3(p.x * p.y, p.y * p.z, p.z * p.x);
    }
    const double n = static_cast<double>(count);
    const glm::dvec3 mean = sum / n, diagonal = squares / n - mean * mean;
    const glm::dvec3 off = products / n - glm::dvec3(mean.x * mean.y, mean.y * mean.z, mean.z * mean.x);
    return {diagonal.x, off.x, off.z, off.x, diagonal.y, off.y, off.z, off.y, diagonal.z};
}

// Columns: orthonormal vectors, about the eigenvectors. Any orthonormal frame gives a valid box, and a split may go in
// any direction: after two sweeps they are mostly off by less than 1e-3 rad, after four by less than float precision.
[[nodiscard]] inline glm::dmat3 eigenvectors(glm::dmat3 m, int sweeps) {
    glm::dmat3 vectors(1.0);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                const double off = m[p][q];
                if (std::abs(off) <= 1e-9 * (std::abs(m[p][p]) + std::abs(m[q][q])) || off == 0.0) continue;
                const double theta = (m[q][q] - m[p][p]) / (2.0 * off);
                const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
                const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
                const int r = 3 - p - q;
                const double mrp = m[r][p], mrq = m[r][q];
                m[p][p] -= t * off;
                m[q][q] += t * off;
                m[p][q] = m[q][p] = 0.0;
                m[r][p] = m[p][r] = c * mrp - s * mrq;
                m[r][q] = m[q][r] = s * mrp + c * mrq;
                const glm::dvec3 vp = vectors[p], vq = vectors[q];
                vectors[p] = c * vp - s * vq;
                vectors[q] = s * vp + c * vq;
            }
    return vectors;
}

}  // namespace crofton::mesh
