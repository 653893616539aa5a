// SPDX-License-Identifier: MIT
// Two shapes at their poses, and the corners of their difference body { p − q : p in a, q in b }.
#pragma once
#include <crofton/convex/query.hpp>

#include "support.hpp"

namespace crofton::convex {

// How near to a touch a round shape's answer depends on the search, of the size: with cores of corners alone, and with
// cylinders and cones.
inline constexpr double kRoundedDoubt = 4e-12, kRoundDoubt = 1e-7;

// A point of the difference body of the cores, in the world's axes around a's origin.
struct Corner {
    glm::dvec3 on_a, on_b, w;  // w = on_a − on_b
    int a, b;                  // vertices, where the cores are polytopes
};

// Rounding: with u = 2^-53 and size = reach(a) + reach(b) + |offset|, a coordinate of a rotated point is off by 3.1u
// of the reach; `offset` by u; the sums add 3u: a coordinate of w is off by 6.1u of the size, w by 11u. A rotated
// direction is off by 5.4u of its length, its product with a point by 3u more: `along` is off by 9u of
// size · |direction|, the offset's part by 4.1u. All are below `error` / 2 = 16u · size.
struct Pair {
    Pair(const ShapeAtPose& first, const ShapeAtPose& second)
        : a(first.shape), b(second.shape), pose_a(first.pose), pose_b(second.pose) {
        offset = pose_b.translation - pose_a.translation;
        size = a.core_radius() + b.core_radius() + glm::length(offset);
        error = 0x1p-48 * size;
    }

    [[nodiscard]] static glm::dvec3 local(const glm::dmat3& rotation, const glm::dvec3& d) {
        return {glm::dot(rotation[0], d), glm::dot(rotation[1], d), glm::dot(rotation[2], d)};
    }
    [[nodiscard]] Corner corner(const glm::dvec3& p, const glm::dvec3& q, int i, int j) const {
        const glm::dvec3 on_a = pose_a.rotation * p, on_b = pose_b.rotation * q + offset;
        return {on_a, on_b, on_a - on_b, i, j};
    }
    [[nodiscard]] Corner corner(int i, int j) const { return corner(a.vertex(i), b.vertex(j), i, j); }

    // The farthest corner along d; `along` is the farthest extent dot(d, w), within error / 2 · |d|.
    [[nodiscard]] Corner support(const glm::dvec3& d, double& along) const {
        const Support p = core_support(a, local(pose_a.rotation, d)), q = core_support(b, local(pose_b.rotation, -d));
        along = p.along + (q.along - glm::dot(d, offset));
        return corner(p.point, q.point, p.vertex, q.vertex);
    }
    // As support, without the corner.
    [[nodiscard]] double extent(const glm::dvec3& d) const {
        const Support p = core_support(a, local(pose_a.rotation, d)), q = core_support(b, local(pose_b.rotation, -d));
        return p.along + (q.along - glm::dot(d, offset));
    }
    [[nodiscard]] bool has_polytope_cores() const { return a.has_polytope_core() && b.has_polytope_core(); }
    [[nodiscard]] double rounding() const { return a.radius() + b.radius(); }
    // Cores whose distance is known to be farther than this from `rounding` are decided by any search that knows it.
    // Others are left to `settle`. 0 of polytopes, which are decided exactly.
    [[nodiscard]] double doubt() const {
        if (!has_polytope_cores()) return kRoundDoubt * size;
        return rounding() > 0.0 ? kRoundedDoubt * size : 0.0;
    }

    const Shape &a, &b;
    const RigidTransform &pose_a, &pose_b;
    glm::dvec3 offset{0.0};  // of b's origin from a's
    double size = 0.0, error = 0.0;
};

}  // namespace crofton::convex
