// SPDX-License-Identifier: MIT
// Mass of rounded shapes: the core, and all points within the radius of its faces, edges and corners (Steiner 1840).
#pragma once
#include <crofton/convex/shape.hpp>

namespace crofton::convex {

// Returns the mass of a rounded box, hull or triangle by closed forms. Requires radius > 0.
[[nodiscard]] MassProperties mass_of_rounded_polytope(const Shape& shape);

// Does the same for a rounded cylinder or cone.
[[nodiscard]] MassProperties mass_of_rounded_revolution(const Shape& shape);

}  // namespace crofton::convex
