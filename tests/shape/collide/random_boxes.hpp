// SPDX-License-Identifier: MIT
// Pairs of boxes that nearly touch, made so that the gap is known to rounding: the inputs that break separating-axis
// tests.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

namespace crofton::testing {

[[nodiscard]] inline Obb cube_box(const glm::dvec3& center, float half = 1.0f) {
    return {center, glm::mat3(1.0f), glm::vec3(half)};
}

inline glm::dquat random_rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

inline glm::dvec3 random_vector(std::mt19937_64& random, double low = -1.0, double high = 1.0) {
    std::uniform_real_distribution<double> number(low, high);
    return {number(random), number(random), number(random)};
}

inline Obb random_box(std::mt19937_64& random, double place = 1.0) {
    Obb box;
    box.center = place * random_vector(random);
    box.axes = glm::mat3(glm::mat3_cast(random_rotation(random)));
    box.half_extents = glm::vec3(random_vector(random, 0.1, 1.0));
    return box;
}

// How far b, starting at a's centre, has to move along `direction` until the boxes only touch, as far as double can
// say: the smallest of the distances at which one of the fifteen axes begins to separate them.
inline double touching_distance(const Obb& a, const Obb& b, const glm::dvec3& direction) {
    glm::dvec3 edge[6];
    for (int k = 0; k < 6; ++k) edge[k] = glm::dvec3((k < 3 ? a : b).axes[k % 3]);
    double distance = 1e300;
    for (int p = 0; p < 6; ++p)
        for (int q = p + 1; q < 6; ++q) {
            const glm::dvec3 n = glm::cross(edge[p], edge[q]);
            const double speed = std::abs(glm::dot(n, direction));
            if (speed < 1e-14 * glm::length(n) || speed == 0.0) continue;
            double projected_radius = 0.0;
            for (int k = 0; k < 6; ++k)
                if (k != p && k != q)
                    projected_radius += double((k < 3 ? a : b).half_extents[k % 3]) * std::abs(glm::dot(edge[k], n));
            distance = std::min(distance, projected_radius / speed);
        }
    return distance;
}

struct NearTouch {
    bool parallel = false;       // b's frame is a's, turned by 1e-1 … 1e-12 rad
    bool half_turned = false;    // b's frame is a's, turned by 180 degrees about an axis of the world
    bool float_centers = false;  // centres rounded to float
    bool no_gap = false;         // as near to touching as double can put them
    int gap_decade = 0;          // 1 … 15: a gap or overlap of 1e-1 … 1e-15; 0: any between
    int angle_decade = 0;        // 1 … 12 likewise
};

inline std::pair<Obb, Obb> nearly_touching(std::mt19937_64& random, const NearTouch& kind) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Obb a = random_box(random), b = random_box(random);
    if (kind.parallel) {
        const glm::dquat frame = random_rotation(random);
        const double exponent = 1.0 + 11.0 * unit(random);
        const double angle = std::pow(10.0, -(kind.angle_decade > 0 ? double(kind.angle_decade) : exponent));
        a.axes = glm::mat3(glm::mat3_cast(frame));
        b.axes = glm::mat3(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(random_vector(random))) * frame));
    }
    if (kind.half_turned) {
        const int axis = static_cast<int>(random() % 3);
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i) b.axes[k][i] = i == axis ? a.axes[k][i] : -a.axes[k][i];
    }
    const double size = std::pow(10.0, -(kind.gap_decade > 0 ? double(kind.gap_decade) : 1.0 + 14.0 * unit(random)));
    const double gap = kind.no_gap ? 0.0 : random() % 2 ? size : -size;
    // Along an axis in some trials, so that faces lie flat on each other.
    const glm::dvec3 direction = random() % 2 ? glm::normalize(random_vector(random)) : glm::dvec3(a.axes[2]);
    b.center = a.center + (touching_distance(a, b, direction) + gap) * direction;
    if (kind.float_centers) {
        a.center = glm::dvec3(glm::vec3(a.center));
        b.center = glm::dvec3(glm::vec3(b.center));
    }
    return {a, b};
}

// Neighbours with the very same edges, perhaps in another order or turned about; face to face, as near as double can
// put them or one step further. Half of the frames are upright, where all numbers are exact.
inline std::pair<Obb, Obb> crates_of_one_frame(std::mt19937_64& random) {
    const auto grid = [&](double low, double high) {
        return glm::round(random_vector(random, low, high) * 64.0) / 64.0;
    };
    const bool upright = random() % 2 == 0;
    Obb a{grid(-4.0, 4.0), glm::mat3(1.0f), glm::vec3(grid(0.25, 1.0))}, b = a;
    if (!upright) a.axes = glm::mat3(glm::mat3_cast(random_rotation(random)));
    b.half_extents = glm::vec3(grid(0.25, 1.0));
    const int turn = int(random() % 3), up = int(random() % 3);
    glm::dvec3 offset = grid(-1.0, 1.0);
    for (int k = 0; k < 3; ++k) b.axes[(k + turn) % 3] = a.axes[k] * (random() % 2 == 0 ? 1.0f : -1.0f);
    offset[up] = double(a.half_extents[up]) + double(b.half_extents[(up + turn) % 3]);
    if (random() % 2 == 0) offset[up] = std::nextafter(offset[up], random() % 4 == 0 ? 0.0 : 9.0);
    b.center = a.center + glm::dmat3(a.axes) * offset;
    return {a, b};
}

}  // namespace crofton::testing
