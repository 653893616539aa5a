// SPDX-License-Identifier: MIT
// Oracle: do two boxes meet, in exact rational arithmetic (GMP), by two unrelated methods.
#pragma once
#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <oracle/box_axes.hpp>
#include <oracle/tracked.hpp>
#include <vector>

namespace crofton::oracle {

using Vec3q = Vec3<Rational>;

template <class V>
Vec3q rational(const V& v) {
    return vector_of<Rational>(v);
}

// The same in the first kind of number that can tell: a thousand times as fast.
inline bool boxes_meet(const Obb& a, const Obb& b) {
    return decide([&]<class Number>() { return boxes_meet_by_axes<Number>(a, b); });
}

// Numbers as integers times one power of two, so that no fraction has ever to be reduced.
class CommonScale {
  public:
    void include(double value) {
        int exponent = 0;
        if (value != 0.0) std::frexp(value, &exponent), bits_ = std::max(bits_, 53 - exponent);
    }
    [[nodiscard]] int bits() const { return bits_; }
    [[nodiscard]] mpz_class operator()(double value) const {
        int exponent = 0;
        const double mantissa = std::ldexp(std::frexp(value, &exponent), 53);
        mpz_class whole(mantissa);
        if (whole != 0) whole <<= static_cast<unsigned>(exponent - 53 + bits_);
        return whole;
    }

  private:
    int bits_ = 0;
};

// boxes_meet_by_axes without fractions, ten times as fast.
inline bool boxes_meet_by_integers(const Obb& a, const Obb& b) {
    CommonScale axes, halves, centers;
    for (const Obb* box : {&a, &b})
        for (int k = 0; k < 3; ++k) {
            halves.include(double(box->half_extents[k]));
            centers.include(box->center[k]);
            for (int i = 0; i < 3; ++i) axes.include(double(box->axes[k][i]));
        }
    mpz_class edge[6][3], half[6], offset[3], n[3];
    for (int k = 0; k < 6; ++k) {
        const Obb& box = k < 3 ? a : b;
        half[k] = halves(double(box.half_extents[k % 3]));
        for (int i = 0; i < 3; ++i) edge[k][i] = axes(double(box.axes[k % 3][i]));
    }
    for (int i = 0; i < 3; ++i) offset[i] = centers(b.center[i]) - centers(a.center[i]);
    for (int p = 0; p < 6; ++p)
        for (int q = p + 1; q < 6; ++q) {
            for (int i = 0; i < 3; ++i)
                n[i] = edge[p][(i + 1) % 3] * edge[q][(i + 2) % 3] - edge[p][(i + 2) % 3] * edge[q][(i + 1) % 3];
            mpz_class projected_radius = 0, distance = offset[0] * n[0] + offset[1] * n[1] + offset[2] * n[2];
            for (int k = 0; k < 6; ++k)
                if (k != p && k != q)
                    projected_radius +=
                        half[k] * abs(mpz_class(edge[k][0] * n[0] + edge[k][1] * n[1] + edge[k][2] * n[2]));
            // In units of 2^-(2 axes + centers) and 2^-(3 axes + halves).
            distance = abs(distance) << static_cast<unsigned>(axes.bits() + halves.bits());
            projected_radius <<= static_cast<unsigned>(centers.bits());
            if (distance > projected_radius) return false;
        }
    return true;
}

// Linear programming by brute force: the points common to both boxes form a polytope of twelve half-spaces; it is empty
// iff no intersection of three of the planes lies in all half-spaces.
inline bool boxes_meet_by_vertices(const Obb& a, const Obb& b) {
    struct HalfSpace {
        Vec3q normal;  // dot(normal, x) <= offset
        Rational offset;
    };
    std::vector<HalfSpace> sides;
    for (const Obb* box : {&a, &b})
        for (int k = 0; k < 3; ++k) {
            const Vec3q u = rational(box->axes[k]);
            Vec3q n = cross(rational(box->axes[(k + 1) % 3]), rational(box->axes[(k + 2) % 3]));
            const Rational projected_radius = abs(dot(u, n)) * Rational(double(box->half_extents[k]));
            const Rational center = dot(n, rational(box->center));
            sides.push_back({n, center + projected_radius});
            for (Rational& c : n) c = -c;
            sides.push_back({n, projected_radius - center});
        }
    for (std::size_t i = 0; i < 12; ++i)
        for (std::size_t j = i + 1; j < 12; ++j)
            for (std::size_t k = j + 1; k < 12; ++k) {
                const Vec3q jk = cross(sides[j].normal, sides[k].normal), ki = cross(sides[k].normal, sides[i].normal),
                            ij = cross(sides[i].normal, sides[j].normal);
                const Rational det = dot(sides[i].normal, jk);
                if (det == 0) continue;
                Vec3q x;
                for (std::size_t c = 0; c < 3; ++c)
                    x[c] = (sides[i].offset * jk[c] + sides[j].offset * ki[c] + sides[k].offset * ij[c]) / det;
                bool inside = true;
                for (const HalfSpace& side : sides) inside = inside && dot(side.normal, x) <= side.offset;
                if (inside) return true;
            }
    return false;
}

}  // namespace crofton::oracle
