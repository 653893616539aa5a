// SPDX-License-Identifier: MIT
// Branch and bound over the orientations of a tight box, by the sampled queries that hit it.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/study/query_sample.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

struct CountProof {
    std::uint32_t lower_bound = 0;
    std::uint64_t cells = 0;
};

// Proves how many candidates hit every tight box around the points. `known` is the count of some box. `consider(axes)`
// is called with orientations that may have fewer, and returns the least count so far. `triangles` are those of the
// points' hull.
[[nodiscard]] CountProof prove_count(std::span<const glm::dvec3> points, std::span<const std::uint32_t> triangles,
                                     const QuerySample& queries, std::span<const std::uint32_t> candidates,
                                     std::uint32_t known, double tolerance, std::uint64_t max_cells,
                                     FunctionRef<std::uint32_t(const glm::dmat3&)> consider);

}  // namespace crofton::study
