// SPDX-License-Identifier: MIT
// Oracle: do two triangles meet, in exact rational arithmetic, by a method with no cases.
#pragma once
#include <array>
#include <vector>

#include "oracle/exact_boxes.hpp"

namespace crofton::oracle {

// Two convex sets meet iff their difference body contains the origin. For triangles it is the hull of the nine
// differences of vertices, and by Carathéodory's theorem it contains the origin iff a simplex of at most four of them
// does.
inline bool origin_in_simplex(const std::vector<Vec3q>& s) {
    const Vec3q zero{0, 0, 0};
    if (s.size() == 1) return s[0] == zero;
    if (s.size() == 2) {
        const Vec3q c = cross(s[0], s[1]);
        return c == zero && dot(s[0], s[1]) <= 0;
    }
    if (s.size() == 3) {
        const Vec3q n = cross(minus(s[1], s[0]), minus(s[2], s[0]));
        if (n == zero || dot(n, s[0]) != 0) return false;  // its edges are tried by themselves
        for (std::size_t k = 0; k < 3; ++k)
            if (dot(cross(s[k], s[(k + 1) % 3]), n) < 0) return false;
        return true;
    }
    const auto det = [](const Vec3q& a, const Vec3q& b, const Vec3q& c) { return dot(cross(a, b), c); };
    const Rational whole = det(minus(s[1], s[0]), minus(s[2], s[0]), minus(s[3], s[0]));
    if (whole == 0) return false;
    const Rational parts[4] = {det(s[1], s[2], s[3]), -det(s[0], s[2], s[3]), det(s[0], s[1], s[3]),
                               -det(s[0], s[1], s[2])};
    for (const Rational& part : parts)
        if (part * whole < 0) return false;
    return true;
}

template <class Triangle>
bool triangles_meet(const Triangle& a, const Triangle& b) {
    std::vector<Vec3q> d;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) d.push_back(minus(rational(a[i]), rational(b[j])));
    for (std::size_t i = 0; i < 9; ++i) {
        if (origin_in_simplex({d[i]})) return true;
        for (std::size_t j = i + 1; j < 9; ++j) {
            if (origin_in_simplex({d[i], d[j]})) return true;
            for (std::size_t k = j + 1; k < 9; ++k) {
                if (origin_in_simplex({d[i], d[j], d[k]})) return true;
                for (std::size_t l = k + 1; l < 9; ++l)
                    if (origin_in_simplex({d[i], d[j], d[k], d[l]})) return true;
            }
        }
    }
    return false;
}

}  // namespace crofton::oracle
