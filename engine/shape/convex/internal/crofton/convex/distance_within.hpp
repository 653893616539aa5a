// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/convex/query.hpp>

namespace crofton::convex {

// Returns distance(a, b) if that is at most `limit`, and some distance above the limit otherwise. The search ends as
// soon as that is known.
[[nodiscard]] Distance distance_within(const ShapeAtPose& a, const ShapeAtPose& b, double limit);

}  // namespace crofton::convex
