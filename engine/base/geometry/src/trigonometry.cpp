// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <cstdint>
#include <numbers>

namespace crofton {
namespace {

// π/2 in parts of 33 bits and the rest. Products with integers below 2^20 are exact, and what is lost is below 1e-26 of
// the integer.
constexpr double kHalfPiHigh = 0x1.921fb544p+0, kHalfPiMiddle = 0x1.0b4611a6p-34, kHalfPiLow = 0x1.3198a2e037073p-69;

// Σ c[k] y^k
template <std::size_t N>
double polynomial(const double (&c)[N], double y) {
    double sum = c[N - 1];
    for (std::size_t k = N - 1; k-- > 0;) sum = sum * y + c[k];
    return sum;
}

// arctan(u) / u − 1 as a series in −u², |u| ≤ tan(π/16): the first term left out is below 1e-18.
double arc_series(double u) {
    static constexpr double kTerms[] = {1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,  1.0 / 11, 1.0 / 13,
                                        1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21, 1.0 / 23, 1.0 / 25};
    const double y = -u * u;
    return y * polynomial(kTerms, y);
}

// The angle of (x, y), |y| ≤ tan(π/8) x: half of it has tangent y / (x + √(x² + y²)).
double narrow_angle(double y, double x) {
    const double t = y / x, u = t / (1.0 + std::sqrt(1.0 + t * t));
    return 2.0 * (u + u * arc_series(u));
}

}  // namespace

glm::dvec2 detail::cosine_sine_beyond(std::int64_t quarters, double x) {
    const double y = x * x;
    const double c = 1.0 + y * polynomial(kCosineTerms, y), s = x + x * (y * polynomial(kSineTerms, y));
    switch (quarters & 3) {
        case 0:
            return {c, s};
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        default:
            return {s, -c};
    }
}

glm::dvec2 cosine_sine(double angle) {
    const double quarter = std::floor(angle * (2.0 / std::numbers::pi) + 0.5);
    if (!(std::fabs(quarter) < 0x1p52)) return glm::dvec2(angle - angle);  // 0 or NaN: nothing is known that far out
    const double rest = ((angle - quarter * kHalfPiHigh) - quarter * kHalfPiMiddle) - quarter * kHalfPiLow;
    return detail::cosine_sine_beyond(static_cast<std::int64_t>(quarter), rest);
}

double tangent(double angle) {
    const glm::dvec2 p = cosine_sine(angle);
    return p.y / p.x;
}

double arc_tangent(double y, double x) {
    const double a = std::fabs(y), b = std::fabs(x);
    // Reduce to the first octant, by the distance from π/4 if that is less.
    const double least = a < b ? a : b, most = a < b ? b : a;
    double angle = 0.0;
    if (std::isinf(most))
        angle = std::isinf(least) ? std::nan("") : least * 0.0;
    else if (most != 0.0)
        angle = least > 0.414213562373095 * most
                    ? 0.25 * std::numbers::pi + narrow_angle(0.5 * least - 0.5 * most, 0.5 * least + 0.5 * most)
                    : narrow_angle(least, most);
    if (std::isnan(x) || std::isnan(y)) return std::nan("");
    if (a > b) angle = 0.5 * std::numbers::pi - angle;
    if (std::signbit(x)) angle = std::numbers::pi - angle;
    return std::copysign(angle, y);
}

double arc_cosine(double x) {
    return arc_tangent(std::sqrt((1.0 - x) * (1.0 + x)), x);
}

double cube_root(double x) {
    if (!(x > 0.0)) return x;
    int exponent = 0;
    double m = std::frexp(x, &exponent);  // in [1/2, 1)
    const int shift = ((exponent % 3) + 3) % 3;
    m = std::ldexp(m, shift - 3);  // in [1/16, 1/2)
    // Newton's method from above, which descends until rounding stops it.
    double r = 1.0;
    for (;;) {
        const double next = (2.0 * r + m / (r * r)) / 3.0;
        if (!(next < r)) break;
        r = next;
    }
    return std::ldexp(r, (exponent - shift) / 3 + 1);
}

}  // namespace crofton
