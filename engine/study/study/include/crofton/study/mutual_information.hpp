// SPDX-License-Identifier: MIT
// Visibility complexity in bits: how much the start of a ray says about its end. Source: (Feixas, del Acebo, Bekaert
// and Sbert, "An information theory framework for the analysis of scene complexity", 1999).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstdint>

namespace crofton::study {

struct MutualInformation {
    double bits = 0.0;  // Σ p_ij log₂(p_ij / (p_i p_j)), less the bias
    double bias = 0.0;  // the average addition by counting: (pairs seen − rows − columns + 1) / (2·rays·ln 2)
    double entropy_bits = 0.0;  // of where a ray starts, −Σ p_i log₂ p_i: `bits` is no more
    std::uint64_t rays = 0;     // counted, both ways
    std::uint64_t pairs = 0;    // (i, j) with a ray from i to j
};

// Computes the mutual information of the start and the end of a ray.
//
// p_ij is the share of the rays that go from i to j, F_ij·A_i over the whole area, as counted in `factors`. Rays that
// escape go to one more patch, the sky; rays that meet a back go to another; and as many rays come from these as go
// there. The result is 0 if every patch sees the others in proportion to their areas, as inside a sphere, and grows
// with the number of walls. It depends on the patches: finer ones give more, up to a limit. It is reliable if bias ≪
// bits. Errors: no rays.
[[nodiscard]] Result<MutualInformation> mutual_information(const radiosity::FactorMatrix& factors);

}  // namespace crofton::study
