// SPDX-License-Identifier: MIT
// How often a bound misleads: a query meets the bound but not the object, or contains the object but not the bound.
#pragma once
#include <crofton/measure/intrinsic_volumes.hpp>
#include <crofton/measure/planar.hpp>

namespace crofton::measure {

// m_o: the measure of motions under which `query` hits the bound and misses the object (its hull), exactly, by (1).
// Rays of length ℓ are intrinsic_volumes_of_segment(ℓ): α = V − V₀ and β = (F − F₀)·ℓ/4. Requires object ⊂ bound, both
// convex.
[[nodiscard]] double improper_outside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                      const IntrinsicVolumes& object);
[[nodiscard]] double improper_outside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                      const PlanarMeasures& object);

// m_i: the measure of motions under which `query` contains the object but not the bound, to first order for queries
// large beside the bound: F_B·(M − M₀)/4π in space, L_B·(L − L₀)/2π in the plane. What is left out grows with the total
// length of the query's edges (space) and not at all (plane). Rays contain nothing: 0.
[[nodiscard]] double improper_inside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                     const IntrinsicVolumes& object);
[[nodiscard]] double improper_inside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                     const PlanarMeasures& object);

}  // namespace crofton::measure
