// SPDX-License-Identifier: MIT
// Doubles that carry a bound on their error: an oracle's quick first answer, which is right or is none. What rounds
// nothing has a bound of 0, so that bodies on a coarse grid that touch are decided, too.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace crofton::oracle {

// Thrown by sgn() of a number whose error bound is larger than itself; told() returns kUnknown.
struct Undecided {};
inline constexpr int kUnknown = 2;

namespace detail {

struct Rounded {
    double value, residual;  // their sum is exact
};
// Knuth's: exact for all finite doubles, subnormal ones too.
inline Rounded sum(double a, double b) {
    const double s = a + b, part = s - a;
    return {s, (a - (s - part)) + (b - part)};
}
// Exact unless the product is below kLeast; then what the residual lacks is far below kLeast.
inline constexpr double kLeast = 0x1p-900;
inline Rounded product(double a, double b) {
    const double p = a * b;
#if defined(__MINGW32__) && !defined(__FMA__)
    // Its std::fma rounds twice. Halves of 26 bits have exact products (Dekker).
    const auto upper = [](double v) {
        constexpr std::uint64_t kUnit = std::uint64_t{1} << 27;
        return std::bit_cast<double>((std::bit_cast<std::uint64_t>(v) + kUnit / 2) & ~(kUnit - 1));
    };
    const double a1 = upper(a), b1 = upper(b), a2 = a - a1, b2 = b - b1;
    return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
#else
    return {p, std::fma(a, b, -p)};
#endif
}
inline bool is_lost(double p, double a, double b) {
    return std::fabs(p) < kLeast && a != 0.0 && b != 0.0;
}
// Of a sum of at most 32 terms, none negative, each a product of at most three. It is rounded down by less than
// 64 · 2^-53 of itself and by 32 subnormal steps.
inline double rounded_up(double error) {
    return error * (1.0 + 0x1p-46) + kLeast;
}

}  // namespace detail

// One double. |exact − value| ≤ error.
class Tracked {
  public:
    Tracked(double value = 0.0) : value_(value) {}

    [[nodiscard]] double value() const { return value_; }
    [[nodiscard]] double error() const { return error_; }

    friend Tracked operator+(const Tracked& a, const Tracked& b) {
        const auto [s, rest] = detail::sum(a.value_, b.value_);
        return {s, a.error_ + b.error_ + std::fabs(rest)};
    }
    friend Tracked operator-(const Tracked& a) { return {-a.value_, a.error_, Kept{}}; }
    friend Tracked operator-(const Tracked& a, const Tracked& b) { return a + -b; }
    friend Tracked operator*(const Tracked& a, const Tracked& b) {
        const auto [p, rest] = detail::product(a.value_, b.value_);
        const double lost = detail::is_lost(p, a.value_, b.value_) ? detail::kLeast : 0.0;
        // The bound of the factors is not 0 where their product underflows.
        if (a.error_ == 0.0 && b.error_ == 0.0) return {p, std::fabs(rest) + lost};
        return {p, std::fabs(a.value_) * b.error_ + std::fabs(b.value_) * a.error_ + a.error_ * b.error_ +
                       std::fabs(rest) + detail::kLeast};
    }
    Tracked& operator+=(const Tracked& b) { return *this = *this + b; }
    friend Tracked abs(const Tracked& a) { return {std::fabs(a.value_), a.error_, Kept{}}; }
    friend int told(const Tracked& a) {
        // Not so for NaN, which overflow gives.
        if (std::fabs(a.value_) > a.error_) return a.value_ > 0.0 ? 1 : -1;
        return a.value_ == 0.0 && a.error_ == 0.0 ? 0 : kUnknown;
    }

  private:
    struct Kept {};
    Tracked(double value, double error, Kept) : value_(value), error_(error) {}
    Tracked(double value, double error) : value_(value), error_(error == 0.0 ? 0.0 : detail::rounded_up(error)) {}

    double value_, error_ = 0.0;
};

// The sum of two doubles, for what is apart by little more than the rounding of one. |exact − (high + low)| ≤ error.
class TrackedPair {
  public:
    TrackedPair(double value = 0.0) : high_(value) {}

    [[nodiscard]] double value() const { return high_; }
    [[nodiscard]] double error() const { return error_; }

    friend TrackedPair operator+(const TrackedPair& a, const TrackedPair& b) {
        const auto [high, rest] = detail::sum(a.high_, b.high_);
        const auto [low, rest_of_low] = detail::sum(a.low_, b.low_);
        const auto [all, rest_of_all] = detail::sum(rest, low);
        return {high, all, a.error_ + b.error_ + std::fabs(rest_of_low) + std::fabs(rest_of_all)};
    }
    friend TrackedPair operator-(const TrackedPair& a) {
        TrackedPair result(a);
        result.high_ = -a.high_;
        result.low_ = -a.low_;
        return result;
    }
    friend TrackedPair operator-(const TrackedPair& a, const TrackedPair& b) { return a + -b; }
    friend TrackedPair operator*(const TrackedPair& a, const TrackedPair& b) {
        const auto [high, rest] = detail::product(a.high_, b.high_);
        const auto [p, rest_of_p] = detail::product(a.high_, b.low_);
        const auto [q, rest_of_q] = detail::product(a.low_, b.high_);
        const auto [r, rest_of_r] = detail::product(a.low_, b.low_);
        const auto [x, rest_of_x] = detail::sum(p, q);
        const auto [y, rest_of_y] = detail::sum(r, rest);
        const auto [z, rest_of_z] = detail::sum(x, y);
        double error = std::fabs(rest_of_p) + std::fabs(rest_of_q) + std::fabs(rest_of_r) + std::fabs(rest_of_x) +
                       std::fabs(rest_of_y) + std::fabs(rest_of_z);
        if (detail::is_lost(high, a.high_, b.high_) || detail::is_lost(p, a.high_, b.low_) ||
            detail::is_lost(q, a.low_, b.high_) || detail::is_lost(r, a.low_, b.low_))
            error += 4.0 * detail::kLeast;
        if (a.error_ != 0.0 || b.error_ != 0.0)
            error += a.size() * b.error_ + b.size() * a.error_ + a.error_ * b.error_ + detail::kLeast;
        return {high, z, error};
    }
    TrackedPair& operator+=(const TrackedPair& b) { return *this = *this + b; }
    friend TrackedPair abs(const TrackedPair& a) { return a.high_ < 0.0 ? -a : a; }
    friend int told(const TrackedPair& a) {
        // |low| is at most half a unit in high's last place: the sum is not smaller than this, and has high's sign.
        if (std::fabs(a.high_) * (1.0 - 0x1p-50) > a.error_) return a.high_ > 0.0 ? 1 : -1;
        return a.high_ == 0.0 && a.error_ == 0.0 ? 0 : kUnknown;
    }

  private:
    TrackedPair(double high, double low, double error) {
        const auto [s, rest] = detail::sum(high, low);
        high_ = s;
        low_ = rest;
        error_ = error == 0.0 ? 0.0 : detail::rounded_up(error);
    }
    [[nodiscard]] double size() const { return std::fabs(high_) + std::fabs(low_); }

    double high_, low_ = 0.0, error_ = 0.0;
};

template <class Number>
requires std::is_same_v<Number, Tracked> || std::is_same_v<Number, TrackedPair>
int sgn(const Number& a) {
    const int sign = told(a);
    if (sign == kUnknown) throw Undecided{};
    return sign;
}
// For numbers that never round.
template <class Number>
int told(const Number& a) {
    return sgn(a);
}
// a / b within 1e-12 (1 + |a / b|), or Undecided. b is not 0.
template <class Number>
requires std::is_same_v<Number, Tracked> || std::is_same_v<Number, TrackedPair>
double quotient(const Number& a, const Number& b) {
    const double result = a.value() / b.value();
    const double allowed = 1e-13 * (1.0 + std::fabs(result)) * std::fabs(b.value());
    if (a.error() + std::fabs(result) * b.error() <= allowed) return result;
    throw Undecided{};
}

// How many questions each kind of number has answered.
struct Decisions {
    std::uint64_t doubles = 0, pairs = 0, rationals = 0;
};
inline Decisions decisions;

// ask.operator()<Number>() in the first kind of number that can tell: doubles, pairs of them, Exact.
template <class Exact, class Ask>
auto decide_by(const Ask& ask) {
    try {
        const auto answer = ask.template operator()<Tracked>();
        ++decisions.doubles;
        return answer;
    } catch (const Undecided&) {
    }
    try {
        const auto answer = ask.template operator()<TrackedPair>();
        ++decisions.pairs;
        return answer;
    } catch (const Undecided&) {
    }
    ++decisions.rationals;
    return ask.template operator()<Exact>();
}

template <class Number>
using Vec3 = std::array<Number, 3>;

template <class Number>
Number dot(const Vec3<Number>& a, const Vec3<Number>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Number>
Vec3<Number> cross(const Vec3<Number>& a, const Vec3<Number>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class Number>
Vec3<Number> minus(const Vec3<Number>& a, const Vec3<Number>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class Number, class Vector>
Vec3<Number> vector_of(const Vector& v) {
    return {Number(double(v.x)), Number(double(v.y)), Number(double(v.z))};
}

}  // namespace crofton::oracle
