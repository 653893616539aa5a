// SPDX-License-Identifier: MIT
// Decides a few axes exactly, in integers, if the boxes' numbers are of similar magnitude.
#pragma once
#include <crofton/geometry/box.hpp>
#include <cstdint>

#include "pair_columns.hpp"

namespace crofton::collide {

inline constexpr int kTooWide = -2;

// The first of `axes` that separates two finite boxes, kNotSeparated or kTooWide. Components of axes are to be integers
// in units of 2^-48, as floats are from 2^-25 on, and extents and offsets, exactly, integers of 61 bits in some unit.
[[nodiscard]] int first_separating(const Obb& a, const Obb& b, const PairColumns& columns, std::uint32_t axes);

}  // namespace crofton::collide
