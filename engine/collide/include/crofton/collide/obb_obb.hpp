// SPDX-License-Identifier: MIT
// Do two oriented boxes meet? Exactly.
#pragma once
#include <crofton/geometry/obb.hpp>

namespace crofton::collide {

// True iff the two exact parallelepipeds share a point; touching counts. Filtered separating-axis test (Gottschalk,
// Lin, Manocha 1996) with a proven error bound, then exact arithmetic. Exact for every pair of boxes that validate(Obb)
// accepts; a box with NaN or infinite members meets nothing.
[[nodiscard]] bool intersects(const Obb& a, const Obb& b);

// Which axis tells two boxes apart, for statistics and for warm starts. Axes 0-2 are the face normals of `a`, 3-5 those
// of `b`, 6 + 3i + j the cross product of edge i of `a` with edge j of `b`.
inline constexpr int kAxisCount = 15;
inline constexpr int kNotSeparated = -1;

// The first separating axis found, or kNotSeparated when the boxes meet. Starts with `hint`, an axis that separated
// them before, when that is in [0, 15). Which of several separating axes is returned is the same on every machine.
[[nodiscard]] int separating_axis(const Obb& a, const Obb& b, int hint = kNotSeparated);

}  // namespace crofton::collide
