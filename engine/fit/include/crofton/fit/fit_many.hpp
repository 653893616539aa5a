// SPDX-License-Identifier: MIT
// Boxes around many small clusters at once, as the leaves and nodes of trees need them.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/fit/fit.hpp>
#include <cstdint>
#include <span>

namespace crofton::fit {

// Cluster i holds the points positions[indices[j]], j in [ends[i − 1], ends[i]); the first begins at 0. An index may
// occur in several clusters, and several times in one.
struct Clusters {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> indices;
    std::span<const std::uint32_t> ends;
};

// As fit_obb for every cluster: writes boxes[i] for cluster i. The same bits with any executor. A cluster that cannot
// be fitted (no points, a bad index or point) gets a default box; the others get theirs, and the error names the first
// bad cluster. Requires boxes.size() == clusters.ends.size(), and ends that never decrease and stay within `indices`.
[[nodiscard]] Result<void> fit_many(const Clusters& clusters, const FitOptions& options, Executor& executor,
                                    std::span<Obb> boxes);

}  // namespace crofton::fit
