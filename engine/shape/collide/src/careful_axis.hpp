// SPDX-License-Identifier: MIT
// Decides pairs of boxes that float cannot decide.
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <cstdint>

namespace crofton::collide {

// The two edges whose product an axis is: 0-2 are those of a, 3-5 those of b.
struct GeneratorPair {
    std::uint8_t p, q;
};
inline constexpr GeneratorPair kGenerators[kAxisCount] = {{1, 2}, {2, 0}, {0, 1}, {4, 5}, {5, 3},
                                                          {3, 4}, {0, 3}, {0, 4}, {0, 5}, {1, 3},
                                                          {1, 4}, {1, 5}, {2, 3}, {2, 4}, {2, 5}};

// As separating_axis, starting in double.
[[nodiscard]] int careful_axis(const Obb& a, const Obb& b, int hint = kNotSeparated);

}  // namespace crofton::collide
