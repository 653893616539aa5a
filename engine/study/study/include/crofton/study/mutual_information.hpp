// SPDX-License-Identifier: MIT
// Visibility complexity in bits: what the place where a ray starts tells of the place where it arrives. Source:
// (Feixas, del Acebo, Bekaert and Sbert, "An information theory framework for the analysis of scene complexity", 1999).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/radiosity/patches.hpp>
#include <cstdint>

namespace crofton::study {

struct MutualInformation {
    double bits = 0.0;  // Σ p_ij log₂(p_ij / (p_i p_j)), less the bias
    double bias = 0.0;  // what counting adds on average: (pairs seen − rows − columns + 1) / (2·rays·ln 2)
    double entropy_bits = 0.0;  // of where a ray starts, −Σ p_i log₂ p_i: `bits` is no more
    std::uint64_t rays = 0;     // counted, both ways
    std::uint64_t pairs = 0;    // (i, j) with a ray from i to j
};

// p_ij is the share of the rays that go from i to j, F_ij·A_i over the whole area, as `factors` has counted them. What
// escapes goes to one more patch, the sky; what meets a back, to another; and rays come from there as many as go. 0
// where every patch sees the others by their area alone, as inside a sphere; the more walls, the more. Depends on the
// patches: finer ones give more, up to a limit. Trust it where bias ≪ bits. Errors: no rays.
[[nodiscard]] Result<MutualInformation> mutual_information(const radiosity::FactorMatrix& factors);

}  // namespace crofton::study
