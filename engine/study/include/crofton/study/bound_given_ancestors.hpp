// SPDX-License-Identifier: MIT
// The oriented box around an object that fewest queries hit together with all its ancestors' bounds (paper, section 4).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/query_sample.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

struct BoundGivenAncestors {
    Obb bound;
    std::uint32_t ancestor_hits = 0;  // sampled queries that hit all ancestors
    std::uint32_t hits = 0;           // of those, how many hit `bound` too
    std::uint32_t plain_hits = 0;     // of those, how many hit the box that the criterion alone chooses
};

// Searches orientations from several starts (boxes fitted by the criterion, by area and by edge sum, the ancestors'
// axes, the world's) by turning the best one by ever smaller angles, for planes, rays or frusta as the sample holds;
// ties go to the criterion. A good local optimum of the count, never worse than the plain fit; no certificate. The box
// contains all points. Errors: as fit_obb; a criterion that fails validate.
[[nodiscard]] Result<BoundGivenAncestors> bound_given_ancestors(std::span<const glm::dvec3> points,
                                                                std::span<const Obb> ancestors,
                                                                const study::QuerySample& queries,
                                                                const measure::Criterion& criterion);

}  // namespace crofton::study
