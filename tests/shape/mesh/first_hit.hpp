// SPDX-License-Identifier: MIT
// What a ray meets first in a mesh, in rational arithmetic.
#pragma once
#include <cmath>
#include <crofton/mesh/mesh_query.hpp>
#include <optional>

#include "oracle/exact_boxes.hpp"
#include "shape/mesh/meshes.hpp"

namespace crofton::testing {

// The first triangle that the ray meets, in rational arithmetic.
inline std::optional<double> oracle_hit(const Ray& ray, const TriangleMesh& mesh) {
    using namespace oracle;
    std::optional<Rational> best;
    const Vec3q o = rational(ray.origin), d = rational(ray.direction);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const Vec3q a = minus(rational(vertex(mesh, t, 0)), o), b = minus(rational(vertex(mesh, t, 1)), o),
                    c = minus(rational(vertex(mesh, t, 2)), o);
        const Rational u = dot(d, cross(a, b)), v = dot(d, cross(b, c)), w = dot(d, cross(c, a));
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
        const Vec3q n = cross(minus(b, a), minus(c, a));
        const Rational speed = dot(n, d);
        if (speed == 0) continue;
        const Rational at = dot(n, a) / speed;
        if (at < 0 || (std::isfinite(ray.max_t) && at > Rational(ray.max_t))) continue;
        if (!best || at < *best) best = at;
    }
    if (!best) return std::nullopt;
    return best->get_d();
}

inline bool are_same(const std::optional<mesh::TriangleHit>& a, const std::optional<mesh::TriangleHit>& b) {
    return a.has_value() == b.has_value() && (!a || (a->t == b->t && a->triangle == b->triangle));
}

}  // namespace crofton::testing
