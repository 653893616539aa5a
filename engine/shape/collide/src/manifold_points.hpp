// SPDX-License-Identifier: MIT
// Collects the points of a manifold and reduces them to the wanted number.
#pragma once
#include <crofton/collide/bound_contacts.hpp>

namespace crofton::collide {

// Keeps at most four points, in their order: the deepest, the one farthest from it, and the two that with these span
// the largest area on either side.
void reduce(Manifold& manifold);

// The manifold's depth is that of its deepest point.
void set_depth(Manifold& manifold);

}  // namespace crofton::collide
