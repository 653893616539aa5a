// SPDX-License-Identifier: MIT
// Mass of rounded bodies: the core, and what lies within the radius of its faces, edges and corners (Steiner 1840).
#pragma once
#include <crofton/convex/body.hpp>

namespace crofton::convex {

// Of a rounded box, hull or triangle; radius > 0. Closed forms, rounded.
[[nodiscard]] MassProperties mass_of_rounded_polytope(const Body& body);

// Of a rounded cylinder or cone, likewise.
[[nodiscard]] MassProperties mass_of_rounded_revolution(const Body& body);

}  // namespace crofton::convex
