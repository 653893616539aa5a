// SPDX-License-Identifier: MIT
// Input of the same bits on every machine: nothing here asks the C or the C++ library for a random number or a sine, or
// leaves it to the compiler which of two draws comes first.
#pragma once
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

namespace crofton::test {

using sampling::Random;

inline std::uint32_t index(Random& random, std::uint32_t count) {
    return static_cast<std::uint32_t>(random.bits() % count);
}
// Sizes over eight octaves.
inline double size(Random& random, double scale) {
    const double mantissa = random.uniform(0.5, 1.0);
    return std::ldexp(scale * mantissa, -static_cast<int>(index(random, 8)));
}

inline Obb random_box(Random& random, const glm::dvec3& middle, double spread, double scale) {
    Obb box;
    box.center = middle + spread * glm::dvec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (index(random, 8) != 0) box.axes = glm::mat3(sampling::rotation(random.point<3>()));
    for (int k = 0; k < 3; ++k)
        box.half_extents[k] = index(random, 12) == 0 ? 0.0f : static_cast<float>(size(random, scale));
    return box;
}

inline std::vector<Obb> crowd(std::size_t count, double offset, std::uint64_t seed) {
    Random random(seed);
    std::vector<Obb> boxes;
    for (std::size_t i = 0; i < count; ++i)
        boxes.push_back(random_box(random, offset * glm::dvec3(1.0, -0.75, 0.25), 40.0, 4.0));
    return boxes;
}

inline Camera random_camera(Random& random, double offset) {
    Camera camera;
    camera.position = offset * glm::dvec3(1.0, -0.75, 0.25) + 20.0 * sampling::direction(random.point<2>());
    camera.forward = sampling::direction(random.point<2>());
    camera.up = sampling::direction(random.point<2>());
    if (index(random, 3) == 0) camera.projection = Projection::orthographic;
    camera.fov_y = random.uniform(0.2, 2.2);
    camera.height = random.uniform(1.0, 20.0);
    camera.aspect = random.uniform(0.5, 2.0);
    camera.near_distance = random.uniform(0.05, 1.0);
    camera.far_distance = camera.near_distance + random.uniform(1.0, 60.0);
    return camera;
}

// A box one of whose corners lies within 2^-50 to 2^-4 of the frustum's surface, on either side.
inline Obb near_miss(Random& random, const Frustum& frustum, const std::array<glm::dvec3, 8>& corners) {
    Obb box = random_box(random, glm::dvec3(0.0), 0.0, 2.0);
    const std::uint32_t corner = index(random, 8), along = index(random, 3);
    const double u = random.uniform(), w = random.uniform(), v = index(random, 2) ? w : 0.0;
    const double side = index(random, 2) ? 1.0 : -1.0;
    const int depth = -4 - static_cast<int>(index(random, 47));
    const auto edge = [&](std::uint32_t from) { return (1.0 - u) * corners[from] + u * corners[from ^ 1u << along]; };
    const glm::dvec3 target = frustum.origin + (1.0 - v) * edge(corner) + v * edge(corner ^ 1u << (along + 1) % 3);
    const glm::dvec3 away = sampling::direction(random.point<2>());
    glm::dvec3 center = target + std::ldexp(side, depth) * away;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k]);
        center += (glm::dot(axis, away) > 0.0 ? 1.0 : -1.0) * double{box.half_extents[k]} * axis;
    }
    box.center = center;
    return box;
}

// A closed torus with a wavy tube.
inline TriangleMesh torus(std::uint32_t around, std::uint32_t across, double wave) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const glm::dvec2 u = sampling::circle_point(1.0 * i / around), v = sampling::circle_point(1.0 * j / across);
            const double r = 0.4 * (1.0 + wave * u.y * v.x), x = 1.0 + r * v.x;
            mesh.positions.push_back(glm::vec3(x * u.x, x * u.y, r * v.y));
        }
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t a = i * across + j, b = (i + 1) % around * across + j;
            const std::uint32_t c = (i + 1) % around * across + (j + 1) % across, d = i * across + (j + 1) % across;
            for (const std::uint32_t k : {a, b, c, a, c, d}) mesh.indices.push_back(k);
        }
    return mesh;
}

inline void add_star(Polygon& polygon, Random& random, const glm::dvec2& center, double inner, double outer,
                     int count) {
    for (int i = 0; i < count; ++i) {
        const double radius = random.uniform(inner, outer), turn = (i + 0.5 * random.uniform()) / count;
        polygon.points.push_back(center + radius * sampling::circle_point(turn));
    }
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
}

// Stars with and without holes, and a grid of squares whose triangulations are many of one weight.
inline std::vector<Polygon> polygons() {
    std::vector<Polygon> result;
    Random random(51);
    for (const int corners : {3, 7, 40, 150}) {
        add_star(result.emplace_back(), random, {0.0, 0.0}, 2.0, 5.0, corners);
        Polygon& holed = result.emplace_back();
        add_star(holed, random, {0.0, 0.0}, 9.0, 12.0, corners + 5);
        for (int k = 0; k < 3; ++k)
            add_star(holed, random, 3.5 * sampling::circle_point(k / 3.0 + 0.1), 0.5, 2.0, corners / 3 + 3);
    }
    Polygon& comb = result.emplace_back();
    for (int i = 0; i <= 10; ++i) comb.points.push_back({i, 0.0});
    for (int i = 10; i >= 0; --i) comb.points.push_back({i, i % 2 ? 1.0 : 2.0});
    comb.ring_ends.push_back(static_cast<std::uint32_t>(comb.points.size()));
    return result;
}

}  // namespace crofton::test
