// From a good frame to the flush optimum beside it.
#pragma once
#include "local_search.hpp"

namespace crofton::fit {

// The angles, in radians, of the first step of a slide and of where it may stop.
struct Steps {
    double first, last;
};
inline constexpr Steps kFineSteps{1e-6, 1e-11}, kCoarseSteps{1e-5, 1e-9};

// Slides along the one-parameter families of frames that keep two adjacent faces flush with their edges (O'Rourke 1985,
// theory.md section 3) while that lowers the value, a few degrees at most each time. The value never rises.
void polish(const Weights& weights, std::span<const glm::dvec3> points, Candidate& candidate, SearchBuffers& buffers,
            const Steps& steps = kFineSteps);

}  // namespace crofton::fit
