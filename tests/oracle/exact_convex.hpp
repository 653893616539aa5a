// SPDX-License-Identifier: MIT
// Oracle: polytopes where they stand, in exact integers (GMP): proofs that they meet or not, and brute force.
#pragma once
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <cstdlib>
#include <vector>

namespace crofton::oracle {

using Integer = mpz_class;
using Vec3z = std::array<Integer, 3>;

inline Integer dot(const Vec3z& a, const Vec3z& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3z cross(const Vec3z& a, const Vec3z& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3z minus(const Vec3z& a, const Vec3z& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// value · 2^bits; ends the program if that is no integer.
inline Integer scaled(double value, int bits) {
    int exponent = 0;
    Integer whole(std::ldexp(std::frexp(value, &exponent), 53));
    const int shift = exponent - 53 + bits;
    if (shift >= 0) return whole << static_cast<unsigned>(shift);
    const Integer low = whole & ((Integer(1) << static_cast<unsigned>(-shift)) - 1);
    if (low != 0) std::abort();
    return whole >> static_cast<unsigned>(-shift);
}
constexpr int kBits = 300;  // of rotations and of vertices; images have twice as many
inline Vec3z scaled(const glm::dvec3& v, int bits) {
    return {scaled(v.x, bits), scaled(v.y, bits), scaled(v.z, bits)};
}

struct ExactPolytope {
    std::vector<Vec3z> points;  // in units of 2^-(2 kBits)
    std::vector<std::array<std::size_t, 3>> triangles;
};

inline std::vector<std::array<std::size_t, 3>> triangles_of(const convex::Body& body) {
    std::vector<std::array<std::size_t, 3>> result;
    if (body.kind() == convex::Kind::box)
        return {{0, 4, 2}, {4, 6, 2}, {1, 3, 5}, {3, 7, 5}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {6, 7, 3}, {0, 2, 1}, {2, 3, 1}, {4, 5, 6}, {5, 7, 6}};
    if (body.hull() == nullptr) return {{0, 1, 2}, {0, 2, 1}};
    const auto indices = body.hull()->triangles();
    for (std::size_t i = 0; i < indices.size(); i += 3) result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    return result;
}

inline ExactPolytope exact_polytope(const convex::Placed& placed) {
    ExactPolytope result;
    const Vec3z columns[3] = {scaled(placed.pose.rotation[0], kBits), scaled(placed.pose.rotation[1], kBits),
                              scaled(placed.pose.rotation[2], kBits)};
    const Vec3z at = scaled(placed.pose.translation, 2 * kBits);
    for (int i = 0; i < placed.body.vertex_count(); ++i) {
        const Vec3z v = scaled(placed.body.vertex(i), kBits);
        Vec3z image;
        for (std::size_t c = 0; c < 3; ++c)
            image[c] = columns[0][c] * v[0] + columns[1][c] * v[1] + columns[2][c] * v[2] + at[c];
        result.points.push_back(image);
    }
    result.triangles = triangles_of(placed.body);
    return result;
}

// min over b − max over a of dot(n, ·): positive iff n parts them.
inline Integer gap_along(const ExactPolytope& a, const ExactPolytope& b, const Vec3z& n) {
    Integer most = dot(n, a.points[0]), least = dot(n, b.points[0]);
    for (const Vec3z& p : a.points)
        if (const Integer v = dot(n, p); v > most) most = v;
    for (const Vec3z& p : b.points)
        if (const Integer v = dot(n, p); v < least) least = v;
    return least - most;
}

inline bool contains(const ExactPolytope& a, const Vec3z& x) {
    for (const auto& t : a.triangles) {
        const Vec3z &p = a.points[t[0]], n = cross(minus(a.points[t[1]], p), minus(a.points[t[2]], p));
        if (dot(n, minus(x, p)) > 0) return false;
    }
    return true;
}

// The separating-axis theorem: normals of faces, products of edges.
inline bool meet_by_axes(const ExactPolytope& a, const ExactPolytope& b) {
    for (int side = 0; side < 2; ++side)
        for (const auto& t : (side == 0 ? a : b).triangles) {
            const auto& p = (side == 0 ? a : b).points;
            Vec3z n = cross(minus(p[t[1]], p[t[0]]), minus(p[t[2]], p[t[0]]));
            if (side == 1)
                for (Integer& c : n) c = -c;
            if (gap_along(a, b, n) > 0) return false;
        }
    for (const auto& s : a.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            if (s[i] > s[(i + 1) % 3]) continue;
            const Vec3z u = minus(a.points[s[(i + 1) % 3]], a.points[s[i]]);
            for (const auto& t : b.triangles)
                for (std::size_t j = 0; j < 3; ++j) {
                    if (t[j] > t[(j + 1) % 3]) continue;
                    Vec3z n = cross(u, minus(b.points[t[(j + 1) % 3]], b.points[t[j]]));
                    if (gap_along(a, b, n) > 0) return false;
                    for (Integer& c : n) c = -c;
                    if (gap_along(a, b, n) > 0) return false;
                }
        }
    return true;
}

// A proof first: a plane between them, or a common point, among those guessed (from `origin`); else brute force.
inline bool meet(const ExactPolytope& a, const ExactPolytope& b, const std::vector<glm::dvec3>& normals,
                 const glm::dvec3& origin, const std::vector<glm::dvec3>& points, bool* brute = nullptr) {
    for (const glm::dvec3& n : normals)
        if (gap_along(a, b, scaled(n, 2 * kBits)) > 0) return false;
    for (const glm::dvec3& p : points) {
        Vec3z x = scaled(p, 2 * kBits);
        const Vec3z from = scaled(origin, 2 * kBits);
        for (std::size_t k = 0; k < 3; ++k) x[k] += from[k];
        if (contains(a, x) && contains(b, x)) return true;
    }
    if (brute != nullptr) *brute = true;
    return meet_by_axes(a, b);
}

// The least over all faces of the difference body { p − q } of its distance from the origin, squared: by all triples of
// its points. The bodies overlap.
inline mpq_class squared_depth(const ExactPolytope& a, const ExactPolytope& b) {
    std::vector<Vec3z> w;
    for (const Vec3z& p : a.points)
        for (const Vec3z& q : b.points) w.push_back(minus(p, q));
    mpq_class best = -1;
    for (std::size_t i = 0; i < w.size(); ++i)
        for (std::size_t j = i + 1; j < w.size(); ++j)
            for (std::size_t k = j + 1; k < w.size(); ++k) {
                const Vec3z n = cross(minus(w[j], w[i]), minus(w[k], w[i]));
                if (n == Vec3z{0, 0, 0}) continue;
                const Integer level = dot(n, w[i]);
                bool above = false, below = false;
                for (std::size_t l = 0; l < w.size() && !(above && below); ++l) {
                    const Integer side = dot(n, w[l]) - level;
                    above = above || side > 0;
                    below = below || side < 0;
                }
                if (above && below) continue;
                const mpq_class squared = mpq_class(level * level, dot(n, n) << (4 * kBits));
                if (best < 0 || squared < best) best = squared;
            }
    best.canonicalize();
    return best;
}

}  // namespace crofton::oracle
