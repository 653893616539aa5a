// Two boxes in float, four lanes at a time: gaps along the axes of the separating-axis test.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <cstddef>

#include "block_filter.hpp"
#include "float_lanes.hpp"

namespace crofton::collide {

// A box with its axes side by side: component i of all three.
struct FloatBox {
    explicit FloatBox(const Obb& box) {
        // The last of these runs into the extents.
        const char* const axes = reinterpret_cast<const char*>(&box) + offsetof(Obb, axes);
        transpose(load4(axes), load4(axes + 12), load4(axes + 24), axis[0], axis[1], axis[2]);
        half = Lanes4{box.half_extents.x, box.half_extents.y, box.half_extents.z, 0.0f};
    }
    [[nodiscard]] Lanes4 along(float x, float y, float z) const { return axis[0] * x + axis[1] * y + axis[2] * z; }
    // The sum over the first three lanes is at least |axes[i]·axes[j] − δij| for any i and j; NaN where an axis is not
    // finite.
    [[nodiscard]] Lanes4 deviation() const {
        Lanes4 square = {-1.0f, -1.0f, -1.0f, 0.0f}, product = {};
        for (const Lanes4& a : axis) {
            square += a * a;
            product += a * next(a);
        }
        return magnitude(square) + magnitude(product);
    }

    Lanes4 axis[3];
    Lanes4 half;
};

// The test on R = AᵀB in three stages, with the error bounds that are derived in block_filter.cpp. Lane j of face_a is
// the gap along face normal j of a, of edge[i] along edge i of a × edge j of b; `parallel` bounds the latter, as unit
// vector, from above by the face normals.
struct FloatPair {
    FloatPair(const Obb& first, const Obb& second) : a(first), b(second), p(first), q(second) {
        x = static_cast<float>(b.center.x - a.center.x);
        y = static_cast<float>(b.center.y - a.center.y);
        z = static_cast<float>(b.center.z - a.center.z);
        size = sum3(magnitude(Lanes4{x, y, z, 0.0f}) + (p.half + q.half));
        along_a = p.along(x, y, z);
        Lanes4 reach = p.half;
        for (int k = 0; k < 3; ++k)
            reach += magnitude(p.along(b.axes[k].x, b.axes[k].y, b.axes[k].z)) * b.half_extents[k];
        face_a = magnitude(along_a) - reach;
    }
    void face_normals_of_b() {
        Lanes4 reach = q.half;
        for (int k = 0; k < 3; ++k) {
            r[k] = q.along(a.axes[k].x, a.axes[k].y, a.axes[k].z);
            m[k] = magnitude(r[k]);
            reach += m[k] * a.half_extents[k];
        }
        face_b = magnitude(q.along(x, y, z)) - reach;
    }
    void edges() {
        share = kRounding + kPerDeviation * (sum3(p.deviation() + q.deviation()) + 4e-7f);
        const float shallow = largest3(larger(face_a, face_b));
        const Lanes4 half_1 = next(q.half), half_2 = after_next(q.half);
        for (int i = 0; i < 3; ++i) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
            const Lanes4 reach = m[i2] * a.half_extents[i1] + m[i1] * a.half_extents[i2] + after_next(m[i]) * half_1 +
                                 next(m[i]) * half_2;
            edge[i] = magnitude(r[i1] * along_a[i2] - r[i2] * along_a[i1]) - reach;
            parallel[i] = (m[i1] + m[i2] + share) * (kPerSine * size) + shallow;
        }
    }

    const Obb &a, &b;
    FloatBox p, q;
    float x, y, z, size, share = 0.0f;
    Lanes4 along_a, face_a, face_b = {}, edge[3] = {}, parallel[3] = {}, r[3] = {}, m[3] = {};
};

}  // namespace crofton::collide
