// SPDX-License-Identifier: MIT
// Distances of eight pairs of triangles that do not overlap. Included once per instruction set.
#if defined(CROFTON_COLLIDE_TRIANGLE_DISTANCE) == defined(HWY_TARGET_TOGGLE)
#ifdef CROFTON_COLLIDE_TRIANGLE_DISTANCE
#undef CROFTON_COLLIDE_TRIANGLE_DISTANCE
#else
#define CROFTON_COLLIDE_TRIANGLE_DISTANCE
#endif

#include <hwy/highway.h>

#include "triangle_pairs-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace crofton::mesh::HWY_NAMESPACE {

// The formulas of closest_points.hpp with their very roundings: products and sums one by one. What is at least a bound
// here is at least that bound there.
struct Point {
    VD x, y, z;
};

HWY_INLINE Point minus(const Point& a, const Point& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
// p + t · u
HWY_INLINE Point along(const Point& p, VD t, const Point& u) {
    return {hn::Add(p.x, hn::Mul(t, u.x)), hn::Add(p.y, hn::Mul(t, u.y)), hn::Add(p.z, hn::Mul(t, u.z))};
}
HWY_INLINE VD rounded_dot(const Point& a, const Point& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE VD rounded_minor(VD a, VD b, VD c, VD d) {
    return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
}
HWY_INLINE Point rounded_cross(const Point& a, const Point& b) {
    return {rounded_minor(a.y, b.z, b.y, a.z), rounded_minor(a.z, b.x, b.z, a.x), rounded_minor(a.x, b.y, b.x, a.y)};
}
HWY_INLINE VD squared_distance(const Point& a, const Point& b) {
    const Point d = minus(b, a);
    return rounded_dot(d, d);
}

HWY_INLINE VD squared_to_segment(DD d, const Point& p, const Point& a, const Point& b) {
    const VD zero = hn::Zero(d);
    const Point direction = minus(b, a);
    const VD length2 = rounded_dot(direction, direction);
    const VD at = hn::Div(rounded_dot(minus(p, a), direction), length2);
    const VD t = hn::IfThenElseZero(hn::Gt(length2, zero), hn::Min(hn::Max(at, zero), hn::Set(d, 1.0)));
    return squared_distance(p, along(a, t, direction));
}

// Infinite unless the common perpendicular meets the first segment within.
HWY_INLINE VD squared_between_lines(DD d, const Point& p, const Point& q, const Point& a, const Point& b) {
    const Point u = minus(q, p), v = minus(b, a), n = rounded_cross(u, v);
    const VD determinant = rounded_dot(n, n), s = rounded_dot(rounded_cross(minus(a, p), v), n);
    const MD within = hn::And(hn::Gt(s, hn::Zero(d)), hn::Lt(s, determinant));
    const VD squared = squared_to_segment(d, along(p, hn::Div(s, determinant), u), a, b);
    return hn::IfThenElse(within, squared, hn::Set(d, 1e308));
}

struct Face {
    Point normal, inward[3];
    VD length2;  // of the normal
};

HWY_INLINE Face face_of(DD d, const Point (&t)[3]) {
    const Point side = minus(t[1], t[0]), across = rounded_cross(side, minus(t[2], t[0]));
    const VD side2 = rounded_dot(side, side);
    const VD tilt = hn::IfThenElseZero(hn::Gt(side2, hn::Zero(d)), hn::Div(rounded_dot(across, side), side2));
    Face face;
    face.normal = {hn::Sub(across.x, hn::Mul(tilt, side.x)), hn::Sub(across.y, hn::Mul(tilt, side.y)),
                   hn::Sub(across.z, hn::Mul(tilt, side.z))};
    face.length2 = rounded_dot(face.normal, face.normal);
    for (int k = 0; k < 3; ++k) face.inward[k] = rounded_cross(face.normal, minus(t[(k + 1) % 3], t[k]));
    return face;
}

// Infinite unless p's foot falls inside.
HWY_INLINE VD squared_to_face(DD d, const Point& p, const Point (&t)[3], const Face& face) {
    const VD zero = hn::Zero(d);
    MD inside = hn::Gt(face.length2, zero);
    for (int k = 0; k < 3; ++k) inside = hn::And(inside, hn::Ge(rounded_dot(face.inward[k], minus(p, t[k])), zero));
    const VD height = hn::Div(rounded_dot(face.normal, minus(p, t[0])), face.length2);
    const Point foot = {hn::Sub(p.x, hn::Mul(height, face.normal.x)), hn::Sub(p.y, hn::Mul(height, face.normal.y)),
                        hn::Sub(p.z, hn::Mul(height, face.normal.z))};
    return hn::IfThenElse(inside, squared_distance(p, foot), hn::Set(d, 1e308));
}

// Bit l is set where the triangles of lane l, unless they meet, are closer than sqrt(limit).
HWY_INLINE std::uint32_t closer_lanes(const TrianglePairs& pairs, double limit) {
    const DD d;
    std::uint32_t lanes = 0;
    for (std::size_t l = 0; l < mesh::kMeshLeafWidth; l += hn::Lanes(d)) {
        if (l >= pairs.count) break;
        Point a[3], b[3];
        for (int v = 0; v < 3; ++v) {
            a[v] = {hn::Load(d, pairs.a[v][0] + l), hn::Load(d, pairs.a[v][1] + l), hn::Load(d, pairs.a[v][2] + l)};
            b[v] = {hn::Load(d, pairs.b[v][0] + l), hn::Load(d, pairs.b[v][1] + l), hn::Load(d, pairs.b[v][2] + l)};
        }
        const Face face_a = face_of(d, a), face_b = face_of(d, b);
        VD best = hn::Set(d, 1e308);
        for (int i = 0; i < 3; ++i) {
            const int i1 = (i + 1) % 3;
            best = hn::Min(best, hn::Min(squared_to_face(d, a[i], b, face_b), squared_to_face(d, b[i], a, face_a)));
            for (int j = 0; j < 3; ++j) {
                const int j1 = (j + 1) % 3;
                best = hn::Min(best, squared_to_segment(d, a[i], b[j], b[j1]));
                best = hn::Min(best, squared_to_segment(d, b[j], a[i], a[i1]));
                best = hn::Min(best, squared_between_lines(d, a[i], a[i1], b[j], b[j1]));
            }
        }
        lanes |= bits_of(d, hn::Lt(best, hn::Set(d, limit)), l);
    }
    return lanes & ((1u << pairs.count) - 1u);
}

}  // namespace crofton::mesh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
