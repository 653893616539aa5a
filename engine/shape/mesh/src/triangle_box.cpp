// SPDX-License-Identifier: MIT
#include "triangle_box.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <crofton/geometry/closest_points.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include "posed_mesh.hpp"

namespace crofton::mesh {
namespace {

// Along the longest edge, across the triangle, and both.
glm::dmat3 frame_of(const Triangle& t) {
    glm::dvec3 longest(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 edge = t[(k + 1) % 3] - t[k];
        if (glm::dot(edge, edge) > glm::dot(longest, longest)) longest = edge;
    }
    const double length2 = glm::dot(longest, longest);
    const glm::dvec3 u = length2 > 0.0 ? longest / std::sqrt(length2) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double normal2 = glm::dot(normal, normal);
    // The cross product of a sliver is mostly rounding.
    const bool is_sliver = !(normal2 > 1e-16 * length2 * length2);
    const glm::dvec3 n = is_sliver ? unit_across(u) : normal / std::sqrt(normal2);
    return {u, n, glm::cross(u, n)};
}

}  // namespace

// As the tree's own boxes. Half extents are measured in double from the rounded centre along the rounded axes. A margin
// of 1e-6 of their sum covers that these axes are orthonormal only to 3e-7, and the rounding of the halves.
mesh::MeshBox triangle_box(const mesh::MeshLeaf& leaf, std::uint32_t lane) {
    const Triangle t = triangle_of(leaf, lane);
    const glm::dmat3 frame = frame_of(t);
    mesh::MeshBox box{};
    const glm::dvec3 middle = 0.5 * (glm::min(t[0], glm::min(t[1], t[2])) + glm::max(t[0], glm::max(t[1], t[2])));
    glm::dvec3 center;
    for (int k = 0; k < 3; ++k) {
        double low = glm::dot(frame[k], t[0] - middle), high = low;
        for (const glm::dvec3& p : t) {
            low = std::min(low, glm::dot(frame[k], p - middle));
            high = std::max(high, glm::dot(frame[k], p - middle));
        }
        center[k] = 0.5 * (low + high);
    }
    center = middle + frame * center;
    double half[3], sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        box.center[k] = static_cast<float>(center[k]);
        for (int i = 0; i < 3; ++i) box.axes[k][i] = static_cast<float>(frame[k][i]);
    }
    const glm::dvec3 rounded(box.center[0], box.center[1], box.center[2]);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k][0], box.axes[k][1], box.axes[k][2]);
        half[k] = 0.0;
        for (const glm::dvec3& p : t) half[k] = std::max(half[k], std::abs(glm::dot(axis, p - rounded)));
        sum += half[k];
    }
    for (int k = 0; k < 3; ++k) box.half[k] = static_cast<float>(half[k] + 2e-6 * sum + 1e-37);
    return box;
}

void direction_from_triangle(const float (&corner)[3][4], const float* point, float* way) {
    const auto exact = [](const float* p) { return glm::dvec3(p[0], p[1], p[2]); };
    const glm::dvec3 to = exact(point);
    const glm::dvec3 along = to - closest_on_triangle(to, {exact(corner[0]), exact(corner[1]), exact(corner[2])});
    const double length = glm::length(along);
    for (int i = 0; i < 3; ++i) way[i] = length > 1e-100 ? static_cast<float>(along[i] / length) : 0.0f;
}

}  // namespace crofton::mesh
