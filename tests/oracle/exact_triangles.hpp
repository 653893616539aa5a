// SPDX-License-Identifier: MIT
// Oracle: do two triangles meet, in exact rational arithmetic, by a method with no cases.
#pragma once
#include <array>
#include <initializer_list>

#include "oracle/exact_boxes.hpp"

namespace crofton::oracle {

// Two convex sets meet iff their difference body contains the origin. For triangles it is the hull of the nine
// differences of vertices, and by Carathéodory's theorem it contains the origin iff a simplex of at most four of them
// does.
// 1 or 0, or kUnknown.
template <class Number>
int origin_in_simplex(const Vec3<Number>* s, std::size_t count) {
    const auto is_zero = [](const Vec3<Number>& v) {
        int zero = 1;
        for (const Number& x : v) {
            const int sign = told(x);
            if (sign == 1 || sign == -1) return 0;
            if (sign == kUnknown) zero = kUnknown;
        }
        return zero;
    };
    if (count == 1) return is_zero(s[0]);
    if (count == 2) {
        const int zero = is_zero(cross(s[0], s[1]));
        if (zero != 1) return zero;
        const int side = told(Number(dot(s[0], s[1])));
        return side == kUnknown ? kUnknown : side <= 0;
    }
    int answer = 1;
    if (count == 3) {
        const Vec3<Number> n = cross(minus(s[1], s[0]), minus(s[2], s[0]));
        const int level = told(Number(dot(n, s[0])));
        if (level == 1 || level == -1) return 0;
        const int zero = is_zero(n);
        if (zero == 1) return 0;  // its edges are tried by themselves
        if (level == kUnknown || zero == kUnknown) return kUnknown;
        for (std::size_t k = 0; k < 3; ++k) {
            const int side = told(Number(dot(cross(s[k], s[(k + 1) % 3]), n)));
            if (side == -1) return 0;
            if (side == kUnknown) answer = kUnknown;
        }
        return answer;
    }
    const int whole = told(Number(dot(cross(minus(s[1], s[0]), minus(s[2], s[0])), minus(s[3], s[0]))));
    if (whole == 0 || whole == kUnknown) return whole;
    for (std::size_t k = 0; k < 4; ++k) {
        const int part = told(Number(dot(cross(s[(k + 1) % 4], s[(k + 2) % 4]), s[(k + 3) % 4])));
        if (part == kUnknown)
            answer = kUnknown;
        else if (part * whole * (k % 2 == 0 ? 1 : -1) < 0)
            return 0;
    }
    return answer;
}

template <class Number = Rational>
bool triangles_meet(const auto& a, const auto& b) {
    std::array<Vec3<Number>, 9> d;
    for (std::size_t i = 0; i < 9; ++i) d[i] = minus(vector_of<Number>(a[i / 3]), vector_of<Number>(b[i % 3]));
    // A simplex that holds the origin is proof, whatever cannot be told of others.
    bool undecided = false;
    const auto holds = [&](std::initializer_list<std::size_t> corners) {
        std::array<Vec3<Number>, 4> s;
        std::size_t count = 0;
        for (const std::size_t i : corners) s[count++] = d[i];
        const int answer = origin_in_simplex(s.data(), count);
        undecided = undecided || answer == kUnknown;
        return answer == 1;
    };
    for (std::size_t i = 0; i < 9; ++i) {
        if (holds({i})) return true;
        for (std::size_t j = i + 1; j < 9; ++j) {
            if (holds({i, j})) return true;
            for (std::size_t k = j + 1; k < 9; ++k) {
                if (holds({i, j, k})) return true;
                for (std::size_t l = k + 1; l < 9; ++l)
                    if (holds({i, j, k, l})) return true;
            }
        }
    }
    if (undecided) throw Undecided{};
    return false;
}

// Whether a direction is known along which all of `b` lies beyond all of `a`: no proof that they meet if not.
template <class Number>
bool triangles_are_parted(const auto& a, const auto& b) {
    Vec3<Number> p[3], q[3], u[3], v[3];
    for (std::size_t k = 0; k < 3; ++k) {
        p[k] = vector_of<Number>(a[k]);
        q[k] = vector_of<Number>(b[k]);
        u[k] = minus(vector_of<Number>(a[(k + 1) % 3]), p[k]);
        v[k] = minus(vector_of<Number>(b[(k + 1) % 3]), q[k]);
    }
    const auto parts = [&](const Vec3<Number>& n) {
        const int side = told(Number(dot(n, minus(q[0], p[0]))));
        if (side == 0 || side == kUnknown) return false;
        for (std::size_t i = 1; i < 9; ++i)
            if (told(Number(dot(n, minus(q[i / 3], p[i % 3])))) != side) return false;
        return true;
    };
    const Vec3<Number> of_a = cross(u[0], u[1]), of_b = cross(v[0], v[1]);
    if (parts(of_a) || parts(of_b)) return true;
    for (std::size_t i = 0; i < 3; ++i)
        if (parts(cross(of_a, u[i])) || parts(cross(of_b, v[i]))) return true;
    for (std::size_t i = 0; i < 9; ++i)
        if (parts(cross(u[i / 3], v[i % 3])) || parts(minus(q[i / 3], p[i % 3]))) return true;
    return false;
}

// The same answer by the first proof that is found, in the first kind of number that can tell.
bool triangles_meet_quickly(const auto& a, const auto& b) {
    return decide([&]<class Number>() { return !triangles_are_parted<Number>(a, b) && triangles_meet<Number>(a, b); });
}

}  // namespace crofton::oracle
