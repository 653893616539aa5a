// SPDX-License-Identifier: MIT
// Adaptive integration over the directions of a half sphere: spherical triangles, the worst bounded one split first.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace crofton::study {

// A spherical triangle's corners, unit vectors, counter-clockwise.
using DirectionTriangle = std::array<glm::dvec3, 3>;

struct CellBounds {
    double low = 0.0, value = 0.0, high = 0.0;
};

// Σ weights[k]·f(corners[k]) is the exact integral over the triangle of any f linear in n: ∫ n dω is half the sum, over
// the sides, of angle × unit normal of the side's plane.
// By differences of corners, and by how much longer an arc is than its sine: small triangles lose less to cancellation.
[[nodiscard]] inline std::array<double, 3> linear_weights(const DirectionTriangle& t) {
    const glm::dvec3 twice_area = glm::cross(t[1] - t[0], t[2] - t[0]);
    glm::dvec3 integral = 0.5 * twice_area;
    std::array<glm::dvec3, 3> crossed;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &a = t[(k + 1) % 3], &b = t[(k + 2) % 3];
        crossed[k] = glm::cross(a, b - a);
        const double squared = glm::dot(crossed[k], crossed[k]), sine = std::sqrt(squared);
        // arc / sine − 1
        const double longer =
            squared < 1e-3
                ? squared * (1.0 / 6.0 + squared * (3.0 / 40.0 + squared * (5.0 / 112.0 + squared * (35.0 / 1152.0))))
                : arc_tangent(sine, glm::dot(a, b)) / sine - 1.0;
        integral += 0.5 * longer * crossed[k];
    }
    const double determinant = glm::dot(t[0], twice_area);
    std::array<double, 3> weights;
    for (std::size_t k = 0; k < 3; ++k) weights[k] = glm::dot(crossed[k], integral) / determinant;
    return weights;
}

// The solid angle (van Oosterom and Strackee, 1983).
[[nodiscard]] inline double solid_angle(const DirectionTriangle& t) {
    const double volume = glm::dot(t[0], glm::cross(t[1], t[2]));
    return 2.0 * arc_tangent(volume, 1.0 + glm::dot(t[0], t[1]) + glm::dot(t[1], t[2]) + glm::dot(t[2], t[0]));
}

// A sum of many terms that are far smaller than it, with the rounding of each addition.
struct LongSum {
    double high = 0.0, low = 0.0;
    void operator+=(double term) {
        const auto [sum, lost] = detail::two_sum(high, term);
        high = sum;
        low += lost;
    }
    [[nodiscard]] double total() const { return high + low; }
};

// bound(triangle) → CellBounds. Deterministic: ties by age.
template <class Bound>
Enclosure integrate_directions(const QuadratureOptions& options, Bound bound) {
    struct Cell {
        DirectionTriangle corners;
        CellBounds bounds;
        std::uint64_t age;
    };
    const auto narrower = [](const Cell& a, const Cell& b) {
        const double x = a.bounds.high - a.bounds.low, y = b.bounds.high - b.bounds.low;
        return x != y ? x < y : a.age > b.age;
    };
    Vector<Cell> heap;
    std::uint64_t age = 0;
    double low = 0.0, high = 0.0;
    const auto add = [&](const DirectionTriangle& corners) {
        const CellBounds bounds = bound(corners);
        low += bounds.low, high += bounds.high;
        heap.push_back({corners, bounds, age++});
        std::push_heap(heap.begin(), heap.end(), narrower);
    };
    const glm::dvec3 x(1.0, 0.0, 0.0), y(0.0, 1.0, 0.0), z(0.0, 0.0, 1.0);
    for (const DirectionTriangle& octant : {DirectionTriangle{x, y, z}, {y, -x, z}, {-x, -y, z}, {-y, x, z}})
        add(octant);
    while (age < options.max_cells && high - low > options.tolerance * (high + low)) {
        std::pop_heap(heap.begin(), heap.end(), narrower);
        const Cell worst = heap.back();
        heap.pop_back();
        low -= worst.bounds.low, high -= worst.bounds.high;
        const auto& [a, b, c] = worst.corners;
        const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
        for (const DirectionTriangle& quarter : {DirectionTriangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
            add(quarter);
    }
    LongSum lows, values, highs;
    for (const Cell& cell : heap) lows += cell.bounds.low, values += cell.bounds.value, highs += cell.bounds.high;
    const CellBounds sum{lows.total(), values.total(), highs.total()};
    const double value = std::clamp(sum.value, sum.low, std::max(sum.low, sum.high));
    return {value, std::max(sum.high - value, value - sum.low), age};
}

[[nodiscard]] Result<void> validate_bodies(std::span<const ConvexBody> bodies);

}  // namespace crofton::study
