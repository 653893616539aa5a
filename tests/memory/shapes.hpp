// SPDX-License-Identifier: MIT
// What the tests of ending memory work on.
#pragma once
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <random>

namespace crofton::testing {

inline Vector<glm::vec3> points(std::size_t count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    Vector<glm::vec3> result(count);
    for (glm::vec3& p : result) p = {uniform(random), uniform(random), uniform(random)};
    return result;
}

inline Vector<Obb> boxes(std::size_t count) {
    Vector<Obb> result(count);
    const auto centers = points(count);
    for (std::size_t i = 0; i < count; ++i) {
        result[i].center = 100.0 * glm::dvec3(centers[i]);
        result[i].half_extents = {1.0f, 0.5f, 0.25f};
    }
    return result;
}

// A flat grid of 2 n² triangles.
inline TriangleMesh grid(std::uint32_t n) {
    TriangleMesh mesh;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0f);
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
            for (const std::uint32_t i : {a, a + 1, b, b, a + 1, b + 1}) mesh.indices.push_back(i);
        }
    mesh.colors.assign(mesh.positions.size(), glm::vec3(0.5f));
    return mesh;
}

// A star with a square hole.
inline Polygon star() {
    Polygon polygon;
    for (int i = 0; i < 24; ++i) {
        const double radius = i % 2 == 0 ? 10.0 : 6.0, angle = i * 0.2617993877991494;
        polygon.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    polygon.ring_ends.push_back(24);
    for (const auto& p : {glm::dvec2(-1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1), glm::dvec2(1, -1)})
        polygon.points.push_back(p);
    polygon.ring_ends.push_back(28);
    return polygon;
}

}  // namespace crofton::testing
