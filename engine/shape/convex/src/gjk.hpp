// SPDX-License-Identifier: MIT
// The distance of two cores in double, with a bound on either side.
#pragma once
#include "simplex.hpp"

namespace crofton::convex {

enum class Relation : std::uint8_t { apart, overlapping, unknown };

struct Nearest {
    Relation relation = Relation::unknown;  // of the cores; certain but for `unknown`
    Simplex simplex;                        // of the nearest point
    double lower = 0.0, upper = 0.0;        // of the cores' distance, proven
    glm::dvec3 normal{0.0};                 // unit, from a to b: the plane across it proves `lower`
};

// Gilbert, Johnson, Keerthi 1988. Stops as soon as the distance is known to be above `far`, or not above `near`, or to
// be above `near` within that share of what is beyond; else when nothing better is found.
[[nodiscard]] Nearest nearest_points(const Pair& pair, const PairCache* cache, double near, double far,
                                     double share = 0.0);

void remember(const Nearest& nearest, PairCache* cache);

}  // namespace crofton::convex
