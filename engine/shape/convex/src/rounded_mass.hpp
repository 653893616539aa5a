// SPDX-License-Identifier: MIT
// Mass of rounded shapes: the core, and all points within the radius of its faces, edges and corners (Steiner 1840).
#pragma once
#include <crofton/convex/shape.hpp>

namespace crofton::convex {

// Of a rounded box, hull or triangle; radius > 0. Closed forms, rounded.
[[nodiscard]] MassProperties mass_of_rounded_polytope(const Shape& shape);

// Of a rounded cylinder or cone, likewise.
[[nodiscard]] MassProperties mass_of_rounded_revolution(const Shape& shape);

}  // namespace crofton::convex
