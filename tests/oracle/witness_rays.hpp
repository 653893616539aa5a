// SPDX-License-Identifier: MIT
// Oracle: what a ray meets first among boxes, in exact rational arithmetic (GMP) where doubles cannot tell.
#pragma once
#include <gmpxx.h>

#include <array>
#include <oracle/box_rays.hpp>
#include <oracle/exact_boxes.hpp>
#include <span>
#include <vector>

namespace crofton::oracle {

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

// Whether the box's front lies on the ray before t = 1, or at it: then the point at t = 1 is not surely seen.
inline bool blocks(const WitnessRay& ray, const Obb& box) {
    if (surely_passes(ray, box)) return false;
    const Interval quick = interval(ray, box);
    const double e = quick.error;
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
