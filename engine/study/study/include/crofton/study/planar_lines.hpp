// SPDX-License-Identifier: MIT
// The measure of the lines of the plane that hit all of n convex figures, docs/theory.md (3): the probability that a
// node of a hierarchy is tested.
#pragma once
#include <crofton/study/planar_support.hpp>
#include <span>

namespace crofton::study {

// Returns ∫₀^π max(0, min_i h_i(φ) + min_i h_i(φ + π)) dφ, by exact integration between the zeros and changes of piece.
//
// For one figure it is the perimeter, for two that overlap L₁ + L₂ − L_hull (the paper's (7)). Its only error is
// rounding: about 1e-15 of the largest |coordinate| times the number of pieces. O(n log n) for n discs. Without figures
// it is infinity, the measure of all lines.
[[nodiscard]] double measure_of_lines_hitting_all(std::span<const PlanarSupport> figures);
// Does the same for figures given as the lower envelope of their support functions.
[[nodiscard]] double measure_of_lines_hitting_all(const PlanarSupport& envelope);

// Computes the same for discs by the paper's (9), a sum of arcs and common tangents. From every disc it takes the arcs
// on which only it is the lowest. It adds signed lengths of tangents: outer ones where one disc takes over from
// another, inner ones where lines begin or cease to exist. O(n³), for cross-checks.
[[nodiscard]] double measure_of_lines_by_tangents(std::span<const Disc> discs);

}  // namespace crofton::study
