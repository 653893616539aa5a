// SPDX-License-Identifier: MIT
// `crofton fit --views PATH --trees SCENE…`: does a tree that is built for a path's directions pay on that path?
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/study/query_distribution.hpp>
#include <span>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct ViewTreesRun {
    std::vector<std::string> scenes;
    std::string views_path, json_path;
    std::span<const Camera> cameras;
    const study::QueryDistribution& distribution;
    ReadOptions read = {};
};

// For axis-aligned bounds the measure of the planes of a distribution is 2π Σ edge_k · w_k, with w_k its mean |cosine|
// along axis k. That is the edge sum in a world that is stretched by the weights. So each tree is built by the plain
// criterion there, over the stretched boxes, and asked by the stretched views: intersections are the same, and the
// nodes visited are those of a tree that chose by the weights.
[[nodiscard]] Result<int> run_fit_view_trees(const ViewTreesRun& run);

}  // namespace crofton::cli
