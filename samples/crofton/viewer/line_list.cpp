// SPDX-License-Identifier: MIT
#include "line_list.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton::viewer {
namespace {

// Corner i and corner i with one bit set: the twelve edges of a box.
void edges(LineList& lines, const std::array<glm::dvec3, 8>& corner, std::uint32_t color) {
    for (unsigned i = 0; i < 8; ++i)
        for (unsigned bit = 1; bit < 8; bit <<= 1)
            if ((i & bit) == 0) lines.segment(corner[i], corner[i | bit], color);
}

}  // namespace

void LineList::segment(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t color) {
    vertices_.push_back({glm::vec3(a - controller_), color});
    vertices_.push_back({glm::vec3(b - controller_), color});
}

void LineList::box(const Obb& box, std::uint32_t color) {
    edges(*this, corners(box), color);
}

void LineList::axes(const Obb& box) {
    constexpr std::array<std::uint32_t, 3> kAxisColors{rgba(255, 60, 60), rgba(60, 255, 60), rgba(90, 120, 255)};
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 arm = glm::dvec3(box.axes[k]) * (1.3 * static_cast<double>(box.half_extents[k]));
        segment(box.center - arm, box.center + arm, kAxisColors[static_cast<std::size_t>(k)]);
    }
}

void LineList::cross(const glm::dvec3& at, double size, std::uint32_t color) {
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 arm(0.0);
        arm[k] = size;
        segment(at - arm, at + arm, color);
    }
}

std::array<glm::dvec3, 8> view_corners(const Camera& camera, double far) {
    const glm::dmat3 to_world = glm::transpose(world_to_view_rotation(camera));
    std::array<glm::dvec3, 8> result;
    for (unsigned i = 0; i < 8; ++i) {
        const double depth = (i & 4) != 0 ? std::min(camera.far_distance, far) : camera.near_distance;
        const double half =
            camera.projection == Projection::perspective ? depth * std::tan(0.5 * camera.fov_y) : 0.5 * camera.height;
        const glm::dvec3 in_view((i & 1) != 0 ? half * camera.aspect : -half * camera.aspect,
                                 (i & 2) != 0 ? half : -half, -depth);
        result[i] = camera.position + to_world * in_view;
    }
    return result;
}

void LineList::frustum(const Camera& camera, double far, std::uint32_t color) {
    edges(*this, view_corners(camera, far), color);
}

}  // namespace crofton::viewer
