// SPDX-License-Identifier: MIT
// Numbers that a test of signs is written for once: doubles with an error bound first, exact ones where these cannot
// tell.
#pragma once
#include <array>
#include <cmath>
#include <crofton/geometry/dyadic.hpp>
#include <cstdint>

#include "exact/box_constraints.hpp"

namespace crofton::cull {

// A double and a bound on its error. Each operation passes its inputs' errors on and adds its own rounding, with a
// little to spare for the rounding of the bound.
class Bounded {
  public:
    Bounded(double value = 0.0, double error = 0.0) : value_(value), error_(error) {}

    friend Bounded operator+(const Bounded& a, const Bounded& b) {
        const double value = a.value_ + b.value_;
        return {value, kGrow * (a.error_ + b.error_ + kUnit * std::fabs(value))};
    }
    friend Bounded operator-(const Bounded& a, const Bounded& b) { return a + Bounded(-b.value_, b.error_); }
    friend Bounded operator*(const Bounded& a, const Bounded& b) {
        const double value = a.value_ * b.value_;
        const double error = std::fabs(a.value_) * b.error_ + std::fabs(b.value_) * a.error_ + a.error_ * b.error_;
        return {value, kGrow * (error + kUnit * std::fabs(value)) + kUnderflow};
    }

    [[nodiscard]] bool is_negative() const { return value_ < -error_; }
    [[nodiscard]] bool is_positive() const { return value_ > error_; }

  private:
    static constexpr double kGrow = 1.0 + 0x1p-50;
    static constexpr double kUnderflow = 1e-300;
    double value_, error_;
};

class Exact {
  public:
    Exact() = default;
    explicit Exact(double value) : value_(value) {}
    friend Exact operator+(const Exact& a, const Exact& b) { return Exact(a.value_ + b.value_); }
    friend Exact operator-(const Exact& a, const Exact& b) { return Exact(a.value_ - b.value_); }
    friend Exact operator*(const Exact& a, const Exact& b) { return Exact(a.value_ * b.value_); }
    [[nodiscard]] bool is_negative() const { return value_.sign() < 0; }
    [[nodiscard]] bool is_positive() const { return value_.sign() > 0; }

  private:
    explicit Exact(const Dyadic& value) : value_(value) {}
    Dyadic value_;
};

enum class Answer : std::uint8_t { no, yes, unknown };

template <class Number>
using Vector3 = std::array<Number, 3>;

template <class Number>
Number dot(const Vector3<Number>& a, const Vector3<Number>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Number>
Vector3<Number> cross(const Vector3<Number>& a, const Vector3<Number>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace crofton::cull
