// SPDX-License-Identifier: MIT
// A frustum's planes in a box's own coordinates.
#pragma once
#include <cmath>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/dyadic.hpp>
#include <glm/common.hpp>

namespace crofton::cull {

// The box's points are center + Σ t_k · edge_k, |t_k| ≤ 1, edge_k = half_extents[k] · axes[k]; so plane i keeps the t
// with
//   slope[0] t_0 + slope[1] t_1 + slope[2] t_2 + base ≥ 0,  slope[k] = normal · edge_k,  base = normal · (center −
//   origin) + offset.
// For an Aabb everything is doubled, so that no halving rounds: slope[k] = normal_k (max − min)_k, base = normal ·
// ((min − origin) + (max − origin)) + 2 offset. Computed in double: with u = 2^-53, each number is within kRounding · u
// of the exact one relative to its `size`, the same sum over absolute values. edge_k is exact (a product of two floats
// fits a double). base: one rounding in center − origin (two for an Aabb), one a product, three in the additions, 6u to
// first order; slopes 3u. kRounding = 7 covers the higher orders.
struct Constraint {
    double slope[3];
    double base;
    double slope_size[3];
    double base_size;

    // The largest and least value over the box, each within 12u · size() of the exact one (7u, and 4 more additions).
    [[nodiscard]] double projected_radius() const {
        return std::fabs(slope[0]) + std::fabs(slope[1]) + std::fabs(slope[2]);
    }
    [[nodiscard]] double size() const { return slope_size[0] + slope_size[1] + slope_size[2] + base_size; }
};

inline constexpr double kUnit = 0x1p-53;
inline constexpr double kRounding = 7.0;
// Below this, underflow may have eaten bits; the exact path decides.
inline constexpr double kTiny = 1e-200;

[[nodiscard]] inline glm::dvec3 half_edge(const Obb& box, int k) {
    return glm::dvec3(box.axes[k]) * static_cast<double>(box.half_extents[k]);
}

// The box's size along each axis of the world, in the units of `base`. Σ_k |slope[k]| ≤ Σ_j |normal_j| extents_j, both
// exactly and, within 6u of the latter, as computed.
[[nodiscard]] inline glm::dvec3 extents_of(const Obb& box) {
    return glm::abs(half_edge(box, 0)) + glm::abs(half_edge(box, 1)) + glm::abs(half_edge(box, 2));
}
[[nodiscard]] inline glm::dvec3 extents_of(const Aabb& box) {
    return box.max - box.min;
}

// Sets only base and base_size.
inline void set_base(Constraint& result, const Plane& plane, const glm::dvec3& origin, const Obb& box) {
    const glm::dvec3& n = plane.normal;
    const glm::dvec3 d = box.center - origin;
    const double x = n.x * d.x, y = n.y * d.y, z = n.z * d.z;
    result.base = x + y + z + plane.offset;
    result.base_size = std::fabs(x) + std::fabs(y) + std::fabs(z) + std::fabs(plane.offset);
}

inline void set_base(Constraint& result, const Plane& plane, const glm::dvec3& origin, const Aabb& box) {
    const glm::dvec3& n = plane.normal;
    const glm::dvec3 low = box.min - origin, high = box.max - origin;
    result.base = n.x * (low.x + high.x) + n.y * (low.y + high.y) + n.z * (low.z + high.z) + 2.0 * plane.offset;
    const auto both = [&](int j) { return std::fabs(n[j]) * (std::fabs(low[j]) + std::fabs(high[j])); };
    result.base_size = both(0) + both(1) + both(2) + 2.0 * std::fabs(plane.offset);
}

// Sets only slope and slope_size.
inline void set_slopes(Constraint& result, const Plane& plane, const Obb& box) {
    const glm::dvec3& n = plane.normal;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = half_edge(box, k);
        const double x = n.x * edge.x, y = n.y * edge.y, z = n.z * edge.z;
        result.slope[k] = x + y + z;
        result.slope_size[k] = std::fabs(x) + std::fabs(y) + std::fabs(z);
    }
}

inline void set_slopes(Constraint& result, const Plane& plane, const Aabb& box) {
    const glm::dvec3 size = box.max - box.min;
    for (int k = 0; k < 3; ++k) {
        result.slope[k] = plane.normal[k] * size[k];
        result.slope_size[k] = std::fabs(result.slope[k]);
    }
}

// Entry k of constraint (slopes 0, 1, 2, base 3), exactly.
[[nodiscard]] Dyadic exact_entry(const Plane& plane, const glm::dvec3& origin, const Obb& box, unsigned k);
[[nodiscard]] Dyadic exact_entry(const Plane& plane, const glm::dvec3& origin, const Aabb& box, unsigned k);

// The sign of base + Σ|slope| (the box's innermost corner) or base − Σ|slope| (its outermost), exactly.
template <class Box>
[[nodiscard]] int exact_corner_sign(const Plane& plane, const glm::dvec3& origin, const Box& box, bool innermost) {
    Dyadic sum = exact_entry(plane, origin, box, 3);
    for (unsigned k = 0; k < 3; ++k) {
        const Dyadic projected_radius = abs(exact_entry(plane, origin, box, k));
        sum = innermost ? sum + projected_radius : sum - projected_radius;
    }
    return sum.sign();
}

template <class Box>
[[nodiscard]] int innermost_sign(const Constraint& constraint, const Plane& plane, const glm::dvec3& origin,
                                 const Box& box) {
    const double value = constraint.base + constraint.projected_radius();
    const double bound = 12.0 * kUnit * constraint.size() + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return exact_corner_sign(plane, origin, box, true);
}

template <class Box>
[[nodiscard]] int outermost_sign(const Constraint& constraint, const Plane& plane, const glm::dvec3& origin,
                                 const Box& box) {
    const double value = constraint.base - constraint.projected_radius();
    const double bound = 12.0 * kUnit * constraint.size() + kTiny;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return exact_corner_sign(plane, origin, box, false);
}

// True iff box and frustum share a point, exactly, for boxes that no single plane of the frustum rejects. Planes that
// the whole box is inside of need not be among the frustum's. Box: Obb, Aabb.
template <class Box>
[[nodiscard]] bool meets(const Frustum& frustum, const Box& box, const Constraint* constraints);

// Whether all numbers are finite and small enough for exact arithmetic, and make a bound.
[[nodiscard]] bool is_usable(const Obb& box);
[[nodiscard]] bool is_usable(const Aabb& box);
[[nodiscard]] bool is_usable(const Sphere& sphere);
[[nodiscard]] bool is_usable(const Frustum& frustum);
// Within a thousandth: what the vector kernels' error bounds ask of normals.
[[nodiscard]] bool has_unit_normals(const Frustum& frustum);

// classify() for numbers that are known to be usable.
[[nodiscard]] Verdict classify_usable(const Frustum& frustum, const Obb& box, CullMode mode);
[[nodiscard]] Verdict classify_usable(const Frustum& frustum, const Aabb& box, CullMode mode);
[[nodiscard]] Verdict classify_usable(const Frustum& frustum, const Sphere& sphere, CullMode mode);

}  // namespace crofton::cull
