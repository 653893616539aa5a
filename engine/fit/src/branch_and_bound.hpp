// The global optimum over all orientations, with a proof.
#pragma once
#include <crofton/core/function_ref.hpp>
#include <cstdint>
#include <limits>

#include "local_search.hpp"
#include "point_cloud.hpp"

namespace crofton::fit {

struct SearchLimits {
    double gap = 2e-7;  // stop when the value is proved within this of the optimum, relatively
    std::uint64_t cells = std::numeric_limits<std::uint64_t>::max();
    // Asked now and then with the best value and the proved bound so far; false stops the search. May be null.
    const FunctionRef<bool(double value, double lower_bound, std::uint64_t cells)>* go_on = nullptr;
};

struct SearchResult {
    Candidate best;            // axes in the cloud's coordinates, value in normalised units
    double lower_bound = 0.0;  // proved: no box around the cloud has a lower value
    std::uint64_t cells = 0;   // orientation cells bounded
    std::size_t subset = 0;    // points that the proof needed
    bool complete = false;     // the gap was reached
};

// Branch and bound over the orientations, from the frame `start` (a good one saves work). Bounds come from a subset of
// the points, which holds for all of them since every criterion is monotone; the subset begins with `subset`
// (canonical) and grows where it makes an orientation look better than the whole cloud does. docs/fit.md derives the
// bounds.
[[nodiscard]] SearchResult branch_and_bound(PointCloud& cloud, const Weights& weights,
                                            std::span<const glm::dvec3> subset, const glm::dmat3& start,
                                            const SearchLimits& limits, SearchBuffers& buffers);

}  // namespace crofton::fit
