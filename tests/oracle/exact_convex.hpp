// SPDX-License-Identifier: MIT
// Oracle: polytopes where they stand, in exact integers (GMP): proofs that they meet or not, and brute force.
#pragma once
#include <gmpxx.h>

#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <cstdlib>
#include <oracle/polytopes.hpp>
#include <oracle/tracked.hpp>
#include <type_traits>
#include <vector>

namespace crofton::oracle {

using Integer = mpz_class;
using Vec3z = Vec3<Integer>;

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

using ExactPolytope = Polytope<Integer>;  // points are in units of 2^-(2 kBits)

inline ExactPolytope exact_polytope(const convex::ShapeAtPose& placed) {
    ExactPolytope result;
    const Vec3z columns[3] = {scaled(placed.pose.rotation[0], kBits), scaled(placed.pose.rotation[1], kBits),
                              scaled(placed.pose.rotation[2], kBits)};
    const Vec3z at = scaled(placed.pose.translation, 2 * kBits);
    for (int i = 0; i < placed.shape.vertex_count(); ++i) {
        const Vec3z v = scaled(placed.shape.vertex(i), kBits);
        Vec3z image;
        for (std::size_t c = 0; c < 3; ++c)
            image[c] = columns[0][c] * v[0] + columns[1][c] * v[1] + columns[2][c] * v[2] + at[c];
        result.points.push_back(image);
    }
    result.triangles = triangles_of(placed.shape);
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

inline int parts(const ExactPolytope& a, const ExactPolytope& b, const Vec3z& n) {
    return gap_along(a, b, n) > 0;
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
        if (contains(a, x) == 1 && contains(b, x) == 1) return true;
    }
    if (brute != nullptr) *brute = true;
    return meet_by_axes(a, b);
}

// meet() in the first kind of number that can tell. Everything is relative to a's place.
inline bool meet_quickly(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                         const std::vector<glm::dvec3>& normals, const std::vector<glm::dvec3>& points) {
    return decide_by<Integer>([&]<class Number>() {
        if constexpr (std::is_same_v<Number, Integer>)
            return meet(exact_polytope(a), exact_polytope(b), normals, a.pose.translation, points);
        else
            return meet_in<Number>(a, b, normals, points);
    });
}

// The least over all faces of the difference body { p − q } of its distance from the origin, squared: by all triples of
// its points. The shapes overlap.
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
