// SPDX-License-Identifier: MIT
#include "shape_colors.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace crofton::viewer {

float shape_quality(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::dvec3 ab(b - a), ac(c - a), bc(c - b);
    const double squares = glm::dot(ab, ab) + glm::dot(ac, ac) + glm::dot(bc, bc);
    return squares > 0.0 ? static_cast<float>(2.0 * std::sqrt(3.0) * glm::length(glm::cross(ab, ac)) / squares) : 0.0f;
}

glm::vec3 shape_color(float quality) {
    const glm::vec3 display(std::min(1.0f, 2.0f - 2.0f * quality), std::min(1.0f, 2.0f * quality), 0.05f);
    return 0.6f * display * display;
}

ShapeColored color_by_shape(std::span<const render::Vertex> vertices, std::span<const std::uint32_t> indices) {
    ShapeColored result;
    result.vertices.reserve(indices.size());
    result.indices.reserve(indices.size());
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const float quality = shape_quality(vertices[indices[t]].position, vertices[indices[t + 1]].position,
                                            vertices[indices[t + 2]].position);
        const glm::vec3 color = shape_color(quality);
        for (std::size_t k = 0; k < 3; ++k) {
            result.indices.push_back(static_cast<std::uint32_t>(result.vertices.size()));
            render::Vertex vertex = vertices[indices[t + k]];
            vertex.color = color;
            result.vertices.push_back(vertex);
        }
    }
    return result;
}

}  // namespace crofton::viewer
