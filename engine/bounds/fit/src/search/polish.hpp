// SPDX-License-Identifier: MIT
// The last digits of a local optimum: slides along frames that keep two faces flush with edges.
#pragma once
#include "search/local_search.hpp"

namespace crofton::fit {

// Angles in radians: the first step of a slide, and the accuracy at which it stops.
struct Steps {
    double first, last;
};
inline constexpr Steps kFineSteps{1e-6, 1e-11}, kCoarseSteps{1e-5, 1e-9};

// Slides along the one-parameter families of frames that keep two adjacent faces flush with their edges (O'Rourke 1985,
// theory.md section 3), by at most 2.3 degrees each time, while that lowers the value. The value never rises.
void polish(const Weights& weights, std::span<const glm::dvec3> points, Candidate& candidate, SearchBuffers& buffers,
            const Steps& steps = kFineSteps);

}  // namespace crofton::fit
