// SPDX-License-Identifier: MIT
// The globally best frame around a cloud, by branch and bound over all orientations.
#pragma once
#include <crofton/core/executor.hpp>
#include <cstdint>
#include <limits>

#include "cloud/point_cloud.hpp"
#include "search/local_search.hpp"

namespace crofton::fit {

struct SearchLimits {
    double gap = 2e-7;  // stop when the value is proved within this of the optimum, relatively
    std::uint64_t cells = std::numeric_limits<std::uint64_t>::max();
    // Called with the best value and the proved bound so far, each time that some 0.1 ms of work are done; false stops
    // the search. May be null.
    const FunctionRef<bool(double value, double lower_bound, std::uint64_t cells)>* should_stop = nullptr;
};

struct SearchResult {
    Candidate best;            // axes in the cloud's coordinates, value in normalised units
    double lower_bound = 0.0;  // proved: no box around the cloud has a lower value
    std::uint64_t cells = 0;   // orientation cells bounded
    std::size_t subset = 0;    // points that the proof needed
    bool complete = false;     // the gap was reached
};

// Searches from the frame `start`; a good one saves work. Lower bounds are computed for a subset of the points. They
// hold for all points, since every criterion is monotone. The subset begins with `subset` (in canonical order). Where
// it makes an orientation look better than the best, the cloud's support points join it. docs/notes/fit.md derives the
// bounds.
[[nodiscard]] SearchResult branch_and_bound(PointCloud& cloud, const Weights& weights,
                                            std::span<const glm::dvec3> subset, const glm::dmat3& start,
                                            const SearchLimits& limits, SearchBuffers& buffers);

}  // namespace crofton::fit
