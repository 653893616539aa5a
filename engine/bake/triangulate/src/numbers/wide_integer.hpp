// SPDX-License-Identifier: MIT
// Non-negative integers of any size, for the rare comparisons that double cannot decide. Written to be short, not fast.
#pragma once
#include <compare>
#include <crofton/core/memory.hpp>
#include <cstdint>

namespace crofton::triangulate {

class WideInteger {
  public:
    WideInteger() = default;
    explicit WideInteger(std::uint64_t value);

    [[nodiscard]] bool is_zero() const { return limbs_.empty(); }
    [[nodiscard]] std::size_t bit_count() const;
    [[nodiscard]] int compare(const WideInteger& other) const;
    WideInteger& operator+=(const WideInteger& other);
    WideInteger& operator-=(const WideInteger& other);  // requires *this >= other
    [[nodiscard]] WideInteger operator*(const WideInteger& other) const;
    [[nodiscard]] WideInteger operator<<(std::size_t bits) const;

    // floor(√x); `exact` is set if x is a square.
    [[nodiscard]] static WideInteger square_root(const WideInteger& x, bool& exact);

  private:
    void trim();
    Vector<std::uint32_t> limbs_;  // least significant first, no leading zeros
};

}  // namespace crofton::triangulate
