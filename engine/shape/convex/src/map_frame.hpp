// SPDX-License-Identifier: MIT
// A mesh under a linear map, seen from the mesh's own frame.
#pragma once
#include <cmath>
#include <crofton/convex/shape_maker.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "parts.hpp"

namespace crofton::convex {

struct MapFrame {
    explicit MapFrame(const glm::dmat3* of) : map(of) {
        if (map == nullptr) return;
        inverse = glm::inverse(*map);
        glm::dmat3 rest = inverse * *map;
        for (int k = 0; k < 3; ++k) rest[k][k] -= 1.0;
        stretch = norm_of(inverse);
        // Half of it bounds |1 − inverse · map|, with the rounding of that product.
        error = 2.0 * (size_of(rest) + 4e-15 * size_of(inverse) * size_of(*map));
    }

    // False for a map that flattens: then visit all triangles.
    [[nodiscard]] bool is_usable() const { return error < 0.25; }
    [[nodiscard]] Triangle image(const Triangle& corners) const {
        if (map == nullptr) return corners;
        Triangle result{*map * corners[0], *map * corners[1], *map * corners[2]};
        if (glm::determinant(*map) < 0.0) std::swap(result[1], result[2]);  // the front stays the front
        return result;
    }
    // A box in the mesh's own frame around another that is given in the frame of the images.
    [[nodiscard]] QueryBox box(const QueryBox& outer) const {
        const glm::dvec3 edges[3] = {inverse * outer.axes[0], inverse * outer.axes[1], inverse * outer.axes[2]};
        QueryBox own;
        own.axes = axes_along(edges[0], edges[1]);
        own.center = inverse * outer.center;
        for (int k = 0; k < 3; ++k) {
            glm::dvec3 across(0.0);
            for (int j = 0; j < 3; ++j) {
                own.half[k] += outer.half[j] * std::abs(glm::dot(own.axes[k], edges[j]));
                across[j] = glm::dot(own.axes[k], inverse[j]);
            }
            own.half[k] += outer.radius * glm::length(across);
        }
        own.half *= kSkewed + 2.0 * error;
        const glm::dvec3 size = glm::abs(own.center) + own.half;
        own.rounding = stretch * outer.rounding + 2.0 * error * (size.x + size.y + size.z);
        return own;
    }

    const glm::dmat3* map;
    glm::dmat3 inverse{1.0};
    double stretch = 1.0;  // of a length in the frame of the images, at most
    double error = 0.0;    // of what `inverse` makes of a point, relative to its size

  private:
    [[nodiscard]] static double size_of(const glm::dmat3& m) {
        return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
    }
    // At least the largest factor by which m lengthens a vector: exact for orthogonal columns or rows (Gershgorin
    // 1931).
    [[nodiscard]] static double norm_of(const glm::dmat3& m) {
        double least = HUGE_VAL;
        for (const glm::dmat3& gram : {glm::transpose(m) * m, m * glm::transpose(m)}) {
            double most = 0.0;
            for (int k = 0; k < 3; ++k)
                most = std::fmax(most, std::abs(gram[k].x) + std::abs(gram[k].y) + std::abs(gram[k].z));
            least = std::fmin(least, most);
        }
        return std::sqrt(least) * (1.0 + 1e-14);
    }
    [[nodiscard]] static glm::dmat3 axes_along(const glm::dvec3& u, const glm::dvec3& v) {
        const double length = glm::length(u), across = glm::length(v - glm::dot(u, v) / (length * length) * u);
        if (!(length > 1e-100 && across > 1e-3 * glm::length(v) && across > 1e-100)) return glm::dmat3(1.0);
        const glm::dvec3 x = u / length, y = glm::normalize(v - glm::dot(x, v) * x);
        return {x, y, glm::cross(x, y)};
    }
};

}  // namespace crofton::convex
