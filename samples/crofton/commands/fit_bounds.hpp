// SPDX-License-Identifier: MIT
// `crofton fit --bounds`: spheres, boxes and k-DOPs around each mesh, and which of them costs least.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/measure/measure.hpp>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct BoundsRun {
    std::vector<std::string> files;
    std::string criterion_name, json_path;
    measure::Criterion criterion;
    bool only_best = false;
    double region = 20.0;        // radius of the ball that queries hit, over that of the mesh's sphere
    double triangle_cost = 1.0;  // nanoseconds for a triangle that is passed on
    ReadOptions read = {};
};

// The cost of a query is C_v + p·C_p: C_v, the time of one test of the bound, is measured here; p is the chance that a
// query that hits the region hits the bound, by the criterion; C_p the mesh's triangles times their cost.
[[nodiscard]] Result<int> run_fit_bounds(const BoundsRun& run);

}  // namespace crofton::cli
