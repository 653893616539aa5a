// SPDX-License-Identifier: MIT
// Even directions, and how far the ancestors' bounds let a plane across each of them go: a quadrature of theory.md (4).
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/study/convex_body.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace crofton::study {

struct AncestorDirections {
    static constexpr std::size_t kCount = 1024;
    Vector<glm::dvec3> normals;  // even heights, longitudes by the golden angle
    Vector<double> limits;       // the least support of the ancestors

    explicit AncestorDirections(std::span<const ConvexBody> ancestors) {
        for (std::size_t i = 0; i < kCount; ++i) {
            const double z = 2.0 * (static_cast<double>(i) + 0.5) / kCount - 1.0;
            const double turns = static_cast<double>(i) * 0.6180339887498949;
            const glm::dvec2 circle = cosine_sine(2.0 * std::numbers::pi * (turns - std::floor(turns)));
            const double r = std::sqrt(1.0 - z * z);
            normals.push_back({r * circle.x, r * circle.y, z});
            double least = std::numeric_limits<double>::infinity();
            for (const ConvexBody& body : ancestors) least = std::min(least, support(body, normals.back()));
            limits.push_back(least);
        }
    }

    [[nodiscard]] bool contain(std::span<const glm::dvec3> points) const {
        for (std::size_t i = 0; i < kCount; ++i)
            for (const glm::dvec3& p : points)
                if (glm::dot(p, normals[i]) > limits[i] + 1e-9 * (std::abs(limits[i]) + glm::length(p))) return false;
        return true;
    }
};

}  // namespace crofton::study
