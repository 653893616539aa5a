// SPDX-License-Identifier: MIT
// The check of many boxes, in vectors of sixteen.
#pragma once
#include <crofton/geometry/box.hpp>
#include <cstddef>

namespace crofton::boxtree {

// How many boxes from the first on, `stride` bytes apart, certainly pass validate(Obb). Where a box is within float
// rounding of what is allowed, or one among 15 others, the answer may be too small.
[[nodiscard]] std::size_t count_certainly_valid(const Obb* boxes, std::size_t count, std::size_t stride = sizeof(Obb));

}  // namespace crofton::boxtree
