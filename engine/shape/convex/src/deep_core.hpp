// SPDX-License-Identifier: MIT
// The depth of a point or a segment in a solid core, in closed form.
#pragma once
#include "epa.hpp"

namespace crofton::convex {

// Of a sphere in a box, a hull, a cylinder or a cone, and of a capsule in a box; rounded or not, in either order.
// Returns false where rounding decides, where they are apart, and of all other pairs. If it returns true, the cores
// surely meet: no search need tell.
[[nodiscard]] bool deep_in_closed_form(const Pair& pair, Depth& depth);

}  // namespace crofton::convex
