// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/other_lines.hpp>
#include <glm/geometric.hpp>

namespace crofton::study {

WeightedLine line_through_opposite_faces(const Aabb& box, int axis, const std::array<double, 4>& u) {
    CROFTON_ASSERT(axis >= 0 && axis < 3, "no such axis");
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    const glm::dvec3 size = box.max - box.min;
    glm::dvec3 from, to;
    from[axis] = box.min[axis], to[axis] = box.max[axis];
    from[x] = box.min[x] + u[0] * size[x], to[x] = box.min[x] + u[2] * size[x];
    from[y] = box.min[y] + u[1] * size[y], to[y] = box.min[y] + u[3] * size[y];
    const glm::dvec3 across = to - from;
    const double squared = glm::dot(across, across), area = size[x] * size[y];
    return {{from, across / std::sqrt(squared)}, area * area * size[axis] * size[axis] / (squared * squared)};
}

void append_parallelogram_bundle(const Sphere& sphere, const glm::dvec2& first, const glm::dvec2& second,
                                 sampling::Random& random, Vector<Line>& lines) {
    const double area = first.x * second.y - first.y * second.x;
    CROFTON_ASSERT(area != 0.0, "cells without area");
    const glm::dvec3 direction = sampling::direction(random.point<2>());
    const auto [x, y] = sampling::orthonormal_frame(direction);
    const glm::dmat2 turn = sampling::planar_rotation(random.uniform());
    const double along_a = random.uniform(), along_b = random.uniform();
    const glm::dvec2 a = turn * first, b = turn * second, shift = along_a * a + along_b * b;
    // p = i·a + j·b + shift has |i| ≤ |p × b| / area and |j| ≤ |p × a| / area, and the shift is less than one cell.
    const auto count_across = [&](const glm::dvec2& side) {
        return static_cast<std::int64_t>(std::ceil(sphere.radius * glm::length(side) / std::abs(area))) + 2;
    };
    const std::int64_t columns = count_across(b), rows = count_across(a);
    for (std::int64_t i = -columns; i <= columns; ++i)
        for (std::int64_t j = -rows; j <= rows; ++j) {
            const auto u = random.point<2>();
            const glm::dvec2 p = shift + (static_cast<double>(i) + u[0]) * a + (static_cast<double>(j) + u[1]) * b;
            if (glm::dot(p, p) <= sphere.radius * sphere.radius)
                lines.push_back({sphere.center + p.x * x + p.y * y, direction});
        }
}

}  // namespace crofton::study
