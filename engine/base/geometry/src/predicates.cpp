// SPDX-License-Identifier: MIT
#include <crofton/geometry/expansion.hpp>
#include <crofton/geometry/plane_filter.hpp>
#include <crofton/geometry/predicates.hpp>
#include <cstdint>
#include <initializer_list>
#include <optional>

namespace crofton {
namespace {

template <std::size_t N>
auto cross(const Expansion<N>& ax, const Expansion<N>& ay, const Expansion<N>& bx, const Expansion<N>& by) {
    return ax * by - ay * bx;
}

// Whether a − b is exact.
bool representable(const glm::dvec2& a, const glm::dvec2& b) {
    return detail::two_sum(a.x, -b.x).low == 0.0 && detail::two_sum(a.y, -b.y).low == 0.0;
}

// Small integers: where the absolute products add up to less than this, all sums of them are exact in double. Half of
// 2^53, as the sum itself may be rounded.
constexpr double kExactIntegers = 0x1p52;

bool integral(std::initializer_list<double> values) {
    for (const double v : values) {
        if (v != std::trunc(v)) return false;
    }
    return true;
}

template <std::size_t N>
int in_circle_sign(const Expansion<N>& ax, const Expansion<N>& ay, const Expansion<N>& bx, const Expansion<N>& by,
                   const Expansion<N>& cx, const Expansion<N>& cy) {
    const auto a_lift = ax * ax + ay * ay;
    const auto b_lift = bx * bx + by * by;
    const auto c_lift = cx * cx + cy * cy;
    const auto a_part = a_lift * cross(bx, by, cx, cy);
    const auto b_part = b_lift * cross(cx, cy, ax, ay);
    const auto c_part = c_lift * cross(ax, ay, bx, by);
    return (a_part + b_part + c_part).sign();
}

// Returns no answer if the arguments are not small integers.
std::optional<int> small_in_circle_sign(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const double bc = b.x * c.y, cb = c.x * b.y, ca = c.x * a.y, ac = a.x * c.y, ab = a.x * b.y, ba = b.x * a.y;
    const double a_lift = a.x * a.x + a.y * a.y, b_lift = b.x * b.x + b.y * b.y, c_lift = c.x * c.x + c.y * c.y;
    const double absolute = (std::fabs(bc) + std::fabs(cb)) * a_lift + (std::fabs(ca) + std::fabs(ac)) * b_lift +
                            (std::fabs(ab) + std::fabs(ba)) * c_lift;
    if (!(absolute < kExactIntegers) || !integral({a.x, a.y, b.x, b.y, c.x, c.y})) return std::nullopt;
    return detail::sign_of(a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba));
}

// high + low, where low is at most about half a unit in the last place of high. A sum errs by less than 2^-101 of the
// operands' absolute values, a product by less than 2^-101 of itself.
struct DoubleDouble {
    double high, low;

    friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
        const auto s = detail::two_sum(a.high, b.high), t = detail::two_sum(a.low, b.low);
        const auto u = detail::two_sum(s.high, s.low + t.high);
        const auto v = detail::two_sum(u.high, u.low + t.low);
        return {v.high, v.low};
    }
    friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
        return a + DoubleDouble{-b.high, -b.low};
    }
    friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
        const auto p = detail::two_product(a.high, b.high);
        const auto s = detail::two_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
        return {s.high, s.low};
    }
};

DoubleDouble difference(double a, double b) {
    const auto d = detail::two_sum(a, -b);
    return {d.high, d.low};
}

// Points that are cocircular but for their rounding, as on discs and caps: 100 bits decide, at a thirtieth of what
// expansions cost. 0 if they do not decide. No path from the differences, which are exact, to the determinant has more
// than eight operations. So it errs by less than 2^-97 of the permanent, and the permanent in double by far less than
// half of it. Below the threshold underflow would add to that.
int in_circle_to_100_bits(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    constexpr double kBound = 0x1p-95, kSmallest = 1e-200;
    const DoubleDouble ax = difference(a.x, d.x), ay = difference(a.y, d.y), bx = difference(b.x, d.x),
                       by = difference(b.y, d.y), cx = difference(c.x, d.x), cy = difference(c.y, d.y);
    const DoubleDouble a_lift = ax * ax + ay * ay, b_lift = bx * bx + by * by, c_lift = cx * cx + cy * cy;
    const DoubleDouble bc = bx * cy, cb = cx * by, ca = cx * ay, ac = ax * cy, ab = ax * by, ba = bx * ay;
    const DoubleDouble determinant = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba);
    const double permanent = a_lift.high * (std::fabs(bc.high) + std::fabs(cb.high)) +
                             b_lift.high * (std::fabs(ca.high) + std::fabs(ac.high)) +
                             c_lift.high * (std::fabs(ab.high) + std::fabs(ba.high));
    if (permanent < kSmallest || std::fabs(determinant.high) <= kBound * permanent) return 0;
    return detail::sign_of(determinant.high);
}

}  // namespace

// Where every difference is one double the expansions are eight times shorter, which grids profit from.
int detail::orientation_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    if (representable(a, c) && representable(b, c)) {
        const glm::dvec2 ac = a - c, bc = b - c;
        const double left = ac.x * bc.y, right = ac.y * bc.x;
        if (std::fabs(left) + std::fabs(right) < kExactIntegers && integral({ac.x, ac.y, bc.x, bc.y}))
            return sign_of(left - right);
        return cross(exact(ac.x), exact(ac.y), exact(bc.x), exact(bc.y)).sign();
    }
    return cross(exact_difference(a.x, c.x), exact_difference(a.y, c.y), exact_difference(b.x, c.x),
                 exact_difference(b.y, c.y))
        .sign();
}

int detail::in_circle_exact(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    if (representable(a, d) && representable(b, d) && representable(c, d)) {
        const glm::dvec2 ad = a - d, bd = b - d, cd = c - d;
        if (const auto sign = small_in_circle_sign(ad, bd, cd)) return *sign;
        if (const int sign = in_circle_to_100_bits(a, b, c, d); sign != 0) return sign;
        return in_circle_sign(exact(ad.x), exact(ad.y), exact(bd.x), exact(bd.y), exact(cd.x), exact(cd.y));
    }
    if (const int sign = in_circle_to_100_bits(a, b, c, d); sign != 0) return sign;
    return in_circle_sign(exact_difference(a.x, d.x), exact_difference(a.y, d.y), exact_difference(b.x, d.x),
                          exact_difference(b.y, d.y), exact_difference(c.x, d.x), exact_difference(c.y, d.y));
}

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const int sign = PlaneFilter(a, b, c).side(d);
    if (sign != kUnknownSign) return sign;
    const auto ax = exact_difference(a.x, d.x), ay = exact_difference(a.y, d.y), az = exact_difference(a.z, d.z);
    const auto bx = exact_difference(b.x, d.x), by = exact_difference(b.y, d.y), bz = exact_difference(b.z, d.z);
    const auto cx = exact_difference(c.x, d.x), cy = exact_difference(c.y, d.y), cz = exact_difference(c.z, d.z);
    return (cross(bx, by, cx, cy) * az + cross(cx, cy, ax, ay) * bz + cross(ax, ay, bx, by) * cz).sign();
}

}  // namespace crofton
