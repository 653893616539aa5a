// SPDX-License-Identifier: MIT
#include "box_anchors.hpp"

#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace crofton::mesh {
namespace {

glm::vec3 vector_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// The first and the last point along the direction.
void ends_along(const glm::vec3& direction, std::span<const glm::vec3> points, std::size_t& first, std::size_t& last) {
    first = last = 0;
    double least = 0.0, most = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double along = glm::dot(glm::dvec3(direction), glm::dvec3(points[i] - points[0]));
        if (along < least) least = along, first = i;
        if (along > most) most = along, last = i;
    }
}

std::size_t farthest_from_line(const glm::vec3& a, const glm::vec3& b, std::span<const glm::vec3> points) {
    const glm::dvec3 direction(b - a);
    std::size_t farthest = 0;
    double most = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 n = glm::cross(direction, glm::dvec3(points[i] - a));
        if (const double squared = glm::dot(n, n); squared > most) most = squared, farthest = i;
    }
    return farthest;
}

}  // namespace

void set_anchors(const MeshBox& box, std::span<const glm::vec3> points, std::span<const std::uint32_t> vertices,
                 std::uint32_t lane, BoxAnchors& anchors) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
        if (box.half[k] > box.half[longest]) longest = k;
    std::size_t chosen[3];
    ends_along(vector_of(box.axes[longest]), points, chosen[0], chosen[1]);
    chosen[2] = farthest_from_line(points[chosen[0]], points[chosen[1]], points);
    AnchorPoints corners{};
    for (int i = 0; i < 3; ++i) {
        corners.a[i][0] = points[chosen[0]][i];
        corners.b[i][0] = points[chosen[1]][i];
        corners.c[i][0] = points[chosen[2]][i];
    }
    AnchorFrames frames;
    find_frames(corners, frames);
    for (int k = 0; k < 3; ++k) {
        anchors.vertex[k][lane] = vertices[chosen[k]];
        for (int f = 0; f < 3; ++f) {
            double along = 0.0;
            for (int i = 0; i < 3; ++i)
                along += static_cast<double>(frames.axes[f][i][0]) * static_cast<double>(box.axes[k][i]);
            anchors.axes[k][f][lane] = static_cast<float>(along);
        }
    }
}

}  // namespace crofton::mesh
