// SPDX-License-Identifier: MIT
// Gaps of two boxes along the fifteen axes, in float, in the layout of pair_columns.hpp.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <cstddef>
#include <cstring>

#include "pair_columns.hpp"

namespace crofton::collide {

using detail::after_next, detail::all_lanes, detail::Lanes4, detail::lanes_where, detail::larger, detail::load4,
    detail::magnitude, detail::next, detail::shuffled, detail::transpose;

// A box with its axes side by side: component c of all three.
struct FloatBox {
    explicit FloatBox(const Obb& box) {
        // The last axis runs into the extents, and these are read from one float before them.
        const char* const axes = reinterpret_cast<const char*>(&box) + offsetof(Obb, axes);
        transpose(load4(axes), load4(axes + 12), load4(axes + 24), axis[0], axis[1], axis[2]);
        const Lanes4 end = load4(axes + 32);
        half = shuffled<1, 2, 3, 3>(end, end);
    }
    Lanes4 axis[3];
    Lanes4 half;
};
static_assert(offsetof(Obb, half_extents) == offsetof(Obb, axes) + 36 && sizeof(Obb) == offsetof(Obb, axes) + 48);

[[nodiscard]] inline Lanes4 dot(const Lanes4 (&u)[3], Lanes4 x, Lanes4 y, Lanes4 z) {
    return u[0] * x + u[1] * y + u[2] * z;
}

// Gottschalk's test on R = AᵀB, whose diagonals are the groups: lane i of r[k] is axis i of a · axis i + k of b.
struct FloatPair {
    FloatPair(const Obb& first, const Obb& second) : a(first), b(second) {
        const glm::dvec3 offset = second.center - first.center;
        const Lanes4 x = all_lanes(static_cast<float>(offset.x)), y = all_lanes(static_cast<float>(offset.y)),
                     z = all_lanes(static_cast<float>(offset.z));
        along_a = dot(a.axis, x, y, z);
        r[0] = dot(a.axis, b.axis[0], b.axis[1], b.axis[2]);
        r[1] = dot(a.axis, next(b.axis[0]), next(b.axis[1]), next(b.axis[2]));
        r[2] = dot(a.axis, after_next(b.axis[0]), after_next(b.axis[1]), after_next(b.axis[2]));
        for (int k = 0; k < 3; ++k) m[k] = magnitude(r[k]);
        const Lanes4 h = a.half + b.half;
        size = (h + next(h) + after_next(h)) + (magnitude(x) + magnitude(y) + magnitude(z));
        face_a = magnitude(along_a) - ((m[0] * b.half + m[1] * next(b.half)) + (m[2] * after_next(b.half) + a.half));
        face_b = magnitude(dot(b.axis, x, y, z)) -
                 ((m[0] * a.half + after_next(m[1] * a.half)) + (next(m[2] * a.half) + b.half));
    }

    // Edge i of a × edge j = i + k of b. With i + 1 and i + 2 in a circle, R's entry (i + 1, j) is lane i + 1 of
    // r[k − 1], and (i + 2, j) is lane i + 2 of r[k − 2]; (i, j + 1) and (i, j + 2) are lane i of r[k + 1] and r[k +
    // 2].
    [[nodiscard]] Lanes4 edges(int k) const {
        const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        const Lanes4 half[3] = {b.half, next(b.half), after_next(b.half)};  // by k: those of edges i + k
        const Lanes4 first = next(r[k2]), second = after_next(r[k1]);
        const Lanes4 projected_radius = (next(a.half) * magnitude(second) + after_next(a.half) * magnitude(first)) +
                                        (half[k1] * m[k2] + half[k2] * m[k1]);
        return magnitude(first * after_next(along_a) - second * next(along_a)) - projected_radius;
    }

    FloatBox a, b;
    Lanes4 size, along_a, face_a, face_b, r[3], m[3];
};

[[nodiscard]] inline PairColumns columns_of(const FloatBox& a, const FloatBox& b, const glm::dvec3& offset) {
    PairColumns columns;
    for (int c = 0; c < 3; ++c) {
        std::memcpy(columns.a[c], &a.axis[c], sizeof(Lanes4));
        std::memcpy(columns.b[c], &b.axis[c], sizeof(Lanes4));
        columns.offset[c] = offset[c];
    }
    std::memcpy(columns.half_a, &a.half, sizeof(Lanes4));
    std::memcpy(columns.half_b, &b.half, sizeof(Lanes4));
    return columns;
}

}  // namespace crofton::collide
