// SPDX-License-Identifier: MIT
// Boxes around points by brute force: every orientation of a grid, then ever smaller random turns of the best.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <span>

namespace oracle {

inline glm::dmat3 frame_of_quaternion(double w, double x, double y, double z) {
    const double s = 1.0 / (w * w + x * x + y * y + z * z);
    return {glm::dvec3(w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (z * x - w * y)) * s,
            glm::dvec3(2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)) * s,
            glm::dvec3(2 * (z * x + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z) * s};
}

inline glm::dvec3 box_edges(std::span<const glm::dvec3> points, const glm::dmat3& frame) {
    glm::dvec3 edges;
    for (int k = 0; k < 3; ++k) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const glm::dvec3& p : points) {
            low = std::min(low, glm::dot(p, frame[k]));
            high = std::max(high, glm::dot(p, frame[k]));
        }
        edges[k] = high - low;
    }
    return edges;
}

struct BoxSearch {
    double value = std::numeric_limits<double>::infinity();
    glm::dmat3 frame{1.0};
};

// Rodrigues vectors of a cubic grid of `steps`³ over [−tan(π/8), tan(π/8)]³, which holds every frame up to the
// symmetries of a box; then `turns` random turns of the best so far, from a tenth of a radian down to 1e-9.
inline BoxSearch search_boxes(std::span<const glm::dvec3> points, const crofton::measure::Criterion& criterion,
                              int steps, int turns) {
    BoxSearch best;
    const auto look = [&](const glm::dmat3& frame) {
        const glm::dvec3 e = box_edges(points, frame);
        if (const double value = criterion(e.x, e.y, e.z); value < best.value) best = {value, frame};
    };
    const double most = std::tan(std::acos(-1.0) / 8.0);
    const auto at = [&](int i) { return most * (2.0 * (i + 0.5) / steps - 1.0); };
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            for (int k = 0; k < steps; ++k) look(frame_of_quaternion(1.0, at(i), at(j), at(k)));
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < turns; ++i) {
        const double size = std::pow(10.0, -1.0 - 8.0 * i / turns);
        look(best.frame *
             frame_of_quaternion(1.0, size * normal(random), size * normal(random), size * normal(random)));
    }
    return best;
}

}  // namespace oracle
