// SPDX-License-Identifier: MIT
// Exact numbers of any size that doubles can make: where an expansion's range would not do.
#pragma once
#include <array>
#include <cstdint>

namespace crofton {

// sign · Σ limbs[i] · 2^(32 (i + exponent)): sums and products are exact. The capacity holds every polynomial of degree
// 4 in plane coefficients times coordinates up to 1e30, denormals included: terms from 2^-6600 to 2^3200. Nothing is
// allocated; only the limbs in use are copied.
class Dyadic {
  public:
    static constexpr std::uint32_t kMaxLimbs = 320;

    Dyadic() = default;
    explicit Dyadic(double value);  // finite
    Dyadic(const Dyadic& other) { copy(other); }
    Dyadic& operator=(const Dyadic& other) {
        copy(other);
        return *this;
    }

    [[nodiscard]] int sign() const { return sign_; }
    // value = scaled(e) · 2^e: rounded, off by less than 2^-51 of itself; e ≥ exponent() keeps it below 1.
    [[nodiscard]] int exponent() const { return 32 * (exponent_ + static_cast<std::int32_t>(count_)); }
    [[nodiscard]] double scaled(int exponent) const;
    [[nodiscard]] Dyadic operator-() const;
    friend Dyadic operator+(const Dyadic& a, const Dyadic& b);
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b);
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b);

  private:
    void copy(const Dyadic& other);
    void trim();
    static Dyadic add_magnitudes(const Dyadic& a, const Dyadic& b);
    static Dyadic subtract_magnitudes(const Dyadic& larger, const Dyadic& smaller);
    static int compare_magnitudes(const Dyadic& a, const Dyadic& b);
    [[nodiscard]] std::uint32_t limb_at(std::int32_t position) const;

    std::int32_t sign_ = 0;
    std::int32_t exponent_ = 0;
    std::uint32_t count_ = 0;
    std::array<std::uint32_t, kMaxLimbs> limbs_;  // [0, count_) are in use
};

[[nodiscard]] inline Dyadic abs(const Dyadic& value) {
    return value.sign() < 0 ? -value : value;
}

}  // namespace crofton
