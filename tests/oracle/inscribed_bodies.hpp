// SPDX-License-Identifier: MIT
// Oracle: is a body inside a solid, in exact rational arithmetic: no triangle in the open body, points of it inside.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <optional>
#include <random>
#include <vector>

#include "oracle/exact_boxes.hpp"

namespace crofton::oracle {

struct HalfSpaceQ {
    Vec3q normal;
    Rational offset;  // dot(normal, x) <= offset
};

using TriangleQ = std::array<Vec3q, 3>;

inline TriangleQ rational_triangle(const TriangleMesh& mesh, std::size_t t) {
    TriangleQ result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = rational(mesh.positions[mesh.indices[3 * t + k]]);
    return result;
}

inline std::vector<HalfSpaceQ> half_spaces_of(const Obb& box) {
    std::vector<HalfSpaceQ> sides;
    const Vec3q center = rational(box.center);
    for (int k = 0; k < 3; ++k) {
        Vec3q n = cross(rational(box.axes[(k + 1) % 3]), rational(box.axes[(k + 2) % 3]));
        const Rational projected_radius = abs(dot(n, rational(box.axes[k]))) * Rational(double(box.half_extents[k]));
        sides.push_back({n, dot(n, center) + projected_radius});
        for (Rational& c : n) c = -c;
        sides.push_back({n, dot(n, center) + projected_radius});
    }
    return sides;
}

// Whether a triangle meets the interior of a body: what the closed half-spaces leave of it is a convex polygon, and the
// mean of its corners is inside strictly unless the whole polygon lies in one boundary plane.
inline bool meets_interior(const std::vector<HalfSpaceQ>& body, const TriangleQ& triangle) {
    std::vector<Vec3q> polygon(triangle.begin(), triangle.end());
    for (const HalfSpaceQ& side : body) {
        std::vector<Vec3q> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec3q &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const Rational a = dot(side.normal, p) - side.offset, b = dot(side.normal, q) - side.offset;
            if (a <= 0) kept.push_back(p);
            if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
                const Rational t = a / (a - b);
                kept.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]), p[2] + t * (q[2] - p[2])});
            }
        }
        polygon = std::move(kept);
        if (polygon.empty()) return false;
    }
    Vec3q middle{0, 0, 0};
    for (const Vec3q& p : polygon)
        for (std::size_t k = 0; k < 3; ++k) middle[k] += p[k] / Rational(static_cast<unsigned long>(polygon.size()));
    for (const HalfSpaceQ& side : body)
        if (dot(side.normal, middle) >= side.offset) return false;
    return true;
}

// How often the mesh winds round a point and the parity of the crossings, along a random ray; redrawn where it meets a
// side or the plane of a triangle that holds the point. None where the point is on the surface.
struct WindingQ {
    int number = 0;
    bool odd = false;
};

inline WindingQ winding_by_rays(const TriangleMesh& mesh, const Vec3q& point, std::mt19937_64& random) {
    std::uniform_int_distribution<int> any(-1000, 1000);
    for (;;) {
        const Vec3q d{any(random), any(random), any(random)};
        WindingQ result;
        bool generic = true;
        for (std::size_t i = 0; i < mesh.triangle_count() && generic; ++i) {
            const TriangleQ t = rational_triangle(mesh, i);
            const Vec3q a = minus(t[0], point), b = minus(t[1], point), c = minus(t[2], point);
            const Vec3q n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
            if (n == Vec3q{0, 0, 0}) continue;
            const Rational u = dot(d, cross(a, b)), v = dot(d, cross(b, c)), w = dot(d, cross(c, a));
            const bool pierces = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
            const bool misses = (u > 0 || v > 0 || w > 0) && (u < 0 || v < 0 || w < 0);
            generic = pierces || misses;
            if (!pierces) continue;
            const Rational along = dot(n, d), ahead = dot(n, a);  // dot(n, x − point) over dot(n, d): the ray's way
            if (ahead == 0) generic = false;
            if (ahead * along <= 0) continue;
            result.number += along > 0 ? 1 : -1;
            result.odd = !result.odd;
        }
        if (generic) return result;
    }
}

}  // namespace crofton::oracle
