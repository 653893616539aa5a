// SPDX-License-Identifier: MIT
// Triangles coloured by their shape.
#pragma once
#include <crofton/render/vertex.hpp>
#include <span>

namespace crofton::viewer {

// 1 for an equilateral triangle, 0 for one without area: 4√3 · area / (sum of squared edges).
[[nodiscard]] float shape_quality(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

// Linear RGB: red for 0, over yellow to green for 1.
[[nodiscard]] glm::vec3 shape_color(float quality);

struct ShapeColored {
    Vector<render::Vertex> vertices;
    Vector<std::uint32_t> indices;
};
// The same triangles in the same order, none sharing a vertex, each in the colour of its shape.
[[nodiscard]] ShapeColored color_by_shape(std::span<const render::Vertex> vertices,
                                          std::span<const std::uint32_t> indices);

}  // namespace crofton::viewer
