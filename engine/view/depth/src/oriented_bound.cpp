// SPDX-License-Identifier: MIT
#include "oriented_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace crofton::depth {
namespace {

using Axes = std::array<glm::dvec3, 3>;

struct Extents {
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] double area() const {
        const glm::dvec3 size = max - min;
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

Extents along(const Axes& axes, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    Extents result;
    for (const std::uint32_t i : indices) {
        const glm::dvec3 p(positions[i]);
        const glm::dvec3 t(glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2]));
        result.min = (glm::min)(result.min, t);
        result.max = (glm::max)(result.max, t);
    }
    return result;
}

// Rounding moves a corner by less than 2^-22 of the coordinates' size.
void set(Cluster& cluster, const Axes& axes, const Extents& extents) {
    const glm::dvec3 middle = 0.5 * (extents.min + extents.max);
    const glm::dvec3 center = middle.x * axes[0] + middle.y * axes[1] + middle.z * axes[2];
    const glm::dvec3 size = (glm::max)(glm::abs(extents.min), glm::abs(extents.max));
    const double rounding = 0x1p-21 * (size.x + size.y + size.z);
    cluster.center = glm::vec3(center);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<glm::length_t>(k);
        const double half = 0.5 * (extents.max[axis] - extents.min[axis]) + rounding;
        cluster.half_edges[k] = glm::vec3(half * axes[k]);
    }
}

constexpr Axes kAligned = {glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.0, 0.0, 1.0)};

// Along the mean normal and the longest edge across it; false where there is none.
bool find_axes(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, Axes& axes) {
    glm::dvec3 normal(0.0), longest(0.0);
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const std::array<glm::dvec3, 3> p = {glm::dvec3(positions[indices[t]]), glm::dvec3(positions[indices[t + 1]]),
                                             glm::dvec3(positions[indices[t + 2]])};
        normal += glm::cross(p[1] - p[0], p[2] - p[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 edge = p[(k + 1) % 3] - p[k];
            if (glm::dot(edge, edge) > glm::dot(longest, longest)) longest = edge;
        }
    }
    const double height = glm::length(normal);
    if (!(height > 0.0) || !std::isfinite(height)) return false;
    axes[0] = normal / height;
    const glm::dvec3 across = longest - glm::dot(longest, axes[0]) * axes[0];
    const double length = glm::length(across);
    if (!(length > 1e-6 * glm::length(longest))) return false;
    axes[1] = across / length;
    axes[2] = glm::cross(axes[0], axes[1]);
    return true;
}

}  // namespace

void set_bound(Cluster& cluster, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    Axes axes = kAligned, turned;
    Extents extents = along(axes, positions, indices);
    if (find_axes(positions, indices, turned))
        if (const Extents other = along(turned, positions, indices); other.area() < 0.9 * extents.area())
            axes = turned, extents = other;
    set(cluster, axes, extents);
}

void set_aligned_bound(Cluster& cluster, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices) {
    set(cluster, kAligned, along(kAligned, positions, indices));
}

}  // namespace crofton::depth
