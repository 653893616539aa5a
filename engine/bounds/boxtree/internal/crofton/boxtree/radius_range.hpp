// SPDX-License-Identifier: MIT
// The least and the largest radius of some items, in 32 bits. A radius is half a box's diagonal.
#pragma once
#include <bit>
#include <cmath>
#include <crofton/boxtree/layout.hpp>
#include <crofton/geometry/box.hpp>

namespace crofton::boxtree {

// The upper half is the largest and the lower half the least, each as the upper half of a float, rounded outward: 2^-7
// of itself. As radii are not negative, these halves are ordered as integers are.
inline constexpr RadiusRange kNoRadii = 0x00007f80u;  // of no items: least infinite, largest 0

[[nodiscard]] inline double square_of_radius(const Obb& box) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) square += double{box.half_extents[k]} * double{box.half_extents[k]};
    return square;
}

// From the least and the largest square. In double a root is within 2^-51 of itself; 2^-20 covers that and the rounding
// to float, 2^-148 what is too small for its digits.
[[nodiscard]] inline RadiusRange radius_range_of_squares(double least_square, double most_square) {
    const auto least = static_cast<float>(std::fmax(0.0, std::sqrt(least_square) * (1.0 - 0x1p-20) - 0x1p-148));
    const auto most = static_cast<float>(std::sqrt(most_square) * (1.0 + 0x1p-20) + 0x1p-148);
    return ((std::bit_cast<std::uint32_t>(most) + 0xffffu) & 0xffff0000u) | std::bit_cast<std::uint32_t>(least) >> 16;
}

[[nodiscard]] inline RadiusRange radius_range_of(const Obb& box) {
    const double square = square_of_radius(box);
    return radius_range_of_squares(square, square);
}

[[nodiscard]] constexpr RadiusRange united(RadiusRange a, RadiusRange b) {
    const std::uint32_t most_a = a & 0xffff0000u, most_b = b & 0xffff0000u;
    const std::uint32_t least_a = a & 0xffffu, least_b = b & 0xffffu;
    return (most_a > most_b ? most_a : most_b) | (least_a < least_b ? least_a : least_b);
}

[[nodiscard]] constexpr bool includes(RadiusRange range, RadiusRange part) {
    return united(range, part) == range;
}

}  // namespace crofton::boxtree
