// SPDX-License-Identifier: MIT
// Which texels of a shadow map a camera's picture looks up, and what it compares them with: by brute force, at each
// pixel, from the triangle that owns it.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "owner_picture.hpp"

namespace crofton::oracle {

// A point in a shadow map, in texels, and its depth there, reversed.
struct MapPoint {
    double x, y, depth;
};

// The point of a triangle at a place of the camera's picture, in pixels. Where the place is beside the triangle, by
// rounding, it is the nearest along the edges: attributes are interpolated, never extrapolated.
inline glm::dvec3 point_at(const glm::dmat4& to_clip, const std::array<glm::dvec3, 3>& corners, double x, double y,
                           std::uint32_t width, std::uint32_t height) {
    std::array<glm::dvec3, 3> p;  // pixels · w, and w
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec4 clip = to_clip * glm::dvec4(corners[k], 1.0);
        p[k] = {(clip.x + clip.w) * 0.5 * width, (clip.y + clip.w) * 0.5 * height, clip.w};
    }
    const glm::dvec3 place(x, y, 1.0);
    std::array<double, 3> weights;
    const double determinant = glm::dot(p[0], glm::cross(p[1], p[2]));
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double share = glm::dot(place, glm::cross(p[(k + 1) % 3], p[(k + 2) % 3])) / determinant;
        weights[k] = std::isfinite(share) ? std::max(share, 0.0) : 0.0;
        sum += weights[k];
    }
    if (!(sum > 0.0)) return corners[0];
    return (corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]) / sum;
}

// None where the light does not see the point: behind it, or before its near plane.
inline std::optional<MapPoint> map_point(const glm::dmat4& to_map, const glm::dvec3& point, std::uint32_t width,
                                         std::uint32_t height) {
    const glm::dvec4 clip = to_map * glm::dvec4(point, 1.0);
    if (!(clip.w > 0.0) || clip.z > clip.w) return {};
    return MapPoint{(clip.x / clip.w + 1.0) * 0.5 * width, (clip.y / clip.w + 1.0) * 0.5 * height, clip.z / clip.w};
}

// Calls visit(texel) for each whose centre is at most `radius` away along each axis.
template <class Visit>
void for_texels(const MapPoint& at, double radius, std::uint32_t width, std::uint32_t height, const Visit& visit) {
    const auto first = [&](double v) { return std::max(std::ceil(v - radius - 0.5), 0.0); };
    const auto last = [&](double v, std::uint32_t size) { return std::min(std::floor(v + radius - 0.5), size - 1.0); };
    for (double y = first(at.y); y <= last(at.y, height); y += 1.0)
        for (double x = first(at.x); x <= last(at.x, width); x += 1.0)
            visit(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x));
}

}  // namespace crofton::oracle
