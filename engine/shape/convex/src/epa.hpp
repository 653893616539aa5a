// SPDX-License-Identifier: MIT
// The depth of two overlapping cores, in double, with a bound on either side.
#pragma once
#include "simplex.hpp"

namespace crofton::convex {

struct Depth {
    double lower = 0.0, upper = 0.0;  // proven
    glm::dvec3 normal{0.0};           // unit, from a to b: moving b by `upper` along it parts them
    Simplex face;                     // of the difference body, across `normal`: the deepest points
    bool has_face = false;            // the deepest points are known
};

// Expanding polytope from the simplex in which the origin was found. The cores meet.
[[nodiscard]] Depth expand(const Pair& pair, const Simplex& start);
// Tests whether the cores, which meet, are proved to overlap by more than `limit`. Stops as soon as that is known.
[[nodiscard]] bool is_deeper(const Pair& pair, const Simplex& start, double limit);

// All separating axes of two polytopes: normals of triangles and products of edges. Slow; for what `expand` leaves.
[[nodiscard]] Depth depth_by_axes(const Pair& pair, const Depth& known);

}  // namespace crofton::convex
