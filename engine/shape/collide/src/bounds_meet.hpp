// SPDX-License-Identifier: MIT
// Tests exactly whether the axis-aligned bounds of two boxes overlap.
#pragma once
#include <crofton/geometry/box.hpp>

namespace crofton::collide {

// True iff the smallest axis-aligned boxes around the two exact parallelepipeds share a point. For boxes that
// validate(Obb) accepts.
[[nodiscard]] bool bounds_meet(const Obb& a, const Obb& b);

}  // namespace crofton::collide
