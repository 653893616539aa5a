// SPDX-License-Identifier: MIT
// The measure of the lines of the plane that hit all of n convex figures, theory.md (3): the chance that a node of a
// hierarchy is tested.
#pragma once
#include <crofton/study/planar_support.hpp>
#include <span>

namespace crofton::study {

// ∫₀^π max(0, min_i h_i(φ) + min_i h_i(φ + π)) dφ, by exact integration between the zeros and changes of piece. For one
// figure it is its perimeter, for two that meet L₁ + L₂ − L_hull (the paper's (7)). Rounding only: about 1e-15 of the
// largest |coordinate| times the number of pieces. O(n log n) for n discs. No figures: infinitely many lines, infinity.
[[nodiscard]] double measure_of_lines_hitting_all(std::span<const PlanarSupport> figures);
// Likewise, the figures given as the lower envelope of their support functions.
[[nodiscard]] double measure_of_lines_hitting_all(const PlanarSupport& envelope);

// The same for discs as the paper's (9) has it, a sum of arcs and common tangents. Of every disc it takes the arcs on
// which it alone is the lowest. It adds signed lengths of tangents: outer ones where one disc takes over from another,
// inner ones where lines begin or cease to exist. O(n³), for cross-checks.
[[nodiscard]] double measure_of_lines_by_tangents(std::span<const Disc> discs);

}  // namespace crofton::study
