// SPDX-License-Identifier: MIT
// Oracle: what a ray meets among boxes, in double with a bound on the error. Nothing is projected and no pixels are
// known here.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>

namespace crofton::oracle {

// The points from + t · (to − from) of a line, t ≥ t_near (what is before is not drawn), asked for at t = 1.
struct WitnessRay {
    glm::dvec3 from, to;
    double t_near = 0.0;
};

// Where the line enters the box and leaves it, off by less than `error`, unless that is infinite; enter > leave where
// it surely misses it.
struct Interval {
    double enter = -1e9, leave = 1e9, error = 0.0;
};
inline Interval interval(const WitnessRay& ray, const Obb& box) {
    const glm::dvec3 from = ray.from - box.center, along = ray.to - ray.from;
    const double size = std::abs(from.x) + std::abs(from.y) + std::abs(from.z) + std::abs(along.x) + std::abs(along.y) +
                        std::abs(along.z);
    Interval result;
    const glm::dvec3 axes[3] = {glm::dvec3(box.axes[0]), glm::dvec3(box.axes[1]), glm::dvec3(box.axes[2])};
    const double volume = glm::dot(axes[0], glm::cross(axes[1], axes[2]));
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 normal = glm::cross(axes[(k + 1) % 3], axes[(k + 2) % 3]) / volume;
        const double at = glm::dot(normal, from), slope = glm::dot(normal, along), half = double(box.half_extents[k]);
        // Both numbers are off by a few roundings of `size`.
        const double error = 1e-14 * (size + half);
        // Along this slab the ray is in it, or beside it, for all of 0 ≤ t ≤ 1; or that is unknown.
        if (std::abs(slope) <= 1e3 * error) {
            if (std::abs(at) - std::abs(slope) > half + error) return {1.0, 0.0, 0.0};
            if (std::abs(at) + std::abs(slope) < half - error) continue;
            return {0.0, 0.0, HUGE_VAL};
        }
        const double a = (-half - at) / slope, b = (half - at) / slope;
        result.enter = std::max(result.enter, std::min(a, b));
        result.leave = std::min(result.leave, std::max(a, b));
        result.error =
            std::max(result.error, 2.0 * error * (1.0 + std::max(std::abs(a), std::abs(b))) / std::abs(slope));
    }
    return result;
}

// True only if the ray surely meets no front of the box between t_near and t = 1.
inline bool surely_passes(const WitnessRay& ray, const Obb& box) {
    const auto [enter, leave, error] = interval(ray, box);
    return enter > leave + 2.0 * error || enter > 1.0 + error || enter < ray.t_near - error;
}

}  // namespace crofton::oracle
