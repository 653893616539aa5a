// SPDX-License-Identifier: MIT
// Oracle: what a ray meets first among boxes. In double with a bound on the error, and in exact rational arithmetic
// (GMP) where that cannot tell. Nothing is projected and no pixels are known here.
#pragma once
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <oracle/exact_boxes.hpp>
#include <span>
#include <vector>

namespace crofton::oracle {

// The points from + t · (to − from) of a line, t ≥ t_near (what is before is not drawn), asked for at t = 1.
struct WitnessRay {
    glm::dvec3 from, to;
    double t_near = 0.0;
};

// det of three vectors, of any kind of number.
template <class T>
T determinant(const std::array<T, 3>& a, const std::array<T, 3>& b, const std::array<T, 3>& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Where the line enters the box and leaves it, in exact arithmetic; enter > leave where it misses it.
struct ExactInterval {
    mpq_class enter, leave;
    bool misses = false;
};
inline ExactInterval exact_interval(const WitnessRay& ray, const Obb& box) {
    const Vec3q from = minus(rational(ray.from), rational(box.center));
    const Vec3q along = minus(rational(ray.to), rational(ray.from));
    const std::array<Vec3q, 3> axes = {rational(box.axes[0]), rational(box.axes[1]), rational(box.axes[2])};
    const Rational volume = determinant(axes[0], axes[1], axes[2]);
    ExactInterval result{-1000000000, 1000000000, false};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3q &u = axes[(k + 1) % 3], &v = axes[(k + 2) % 3];
        const Rational at = determinant(from, u, v) / volume, slope = determinant(along, u, v) / volume;
        const Rational half(double(box.half_extents[int(k)]));
        if (slope == 0) {
            if (abs(at) > half) result.misses = true;
            continue;
        }
        Rational a = (-half - at) / slope, b = (half - at) / slope;
        if (a > b) std::swap(a, b);
        if (a > result.enter) result.enter = a;
        if (b < result.leave) result.leave = b;
    }
    if (result.enter > result.leave) result.misses = true;
    return result;
}

// The same in double: enter and leave are off by less than `error`, unless that is infinite.
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
        if (std::abs(slope) <= 1e3 * error) return {0.0, 0.0, HUGE_VAL};
        const double a = (-half - at) / slope, b = (half - at) / slope;
        result.enter = std::max(result.enter, std::min(a, b));
        result.leave = std::min(result.leave, std::max(a, b));
        result.error =
            std::max(result.error, 2.0 * error * (1.0 + std::max(std::abs(a), std::abs(b))) / std::abs(slope));
    }
    return result;
}

// Whether the box's front lies on the ray before t = 1, or at it: then the point at t = 1 is not surely seen.
inline bool blocks(const WitnessRay& ray, const Obb& box) {
    const Interval quick = interval(ray, box);
    const double e = quick.error;
    if (quick.enter > quick.leave + 2.0 * e || quick.enter > 1.0 + e || quick.enter < ray.t_near - e) return false;
    if (quick.enter < quick.leave - 2.0 * e && quick.enter < 1.0 - e && quick.enter > ray.t_near + e) return true;
    const ExactInterval exact = exact_interval(ray, box);
    return !exact.misses && exact.enter <= 1 && exact.enter >= mpq_class(ray.t_near);
}

// Whether the point at t = 1 is seen past all boxes: the ray is its witness.
inline bool is_free(const WitnessRay& ray, std::span<const Obb> boxes) {
    for (const Obb& box : boxes)
        if (blocks(ray, box)) return false;
    return true;
}

}  // namespace crofton::oracle
