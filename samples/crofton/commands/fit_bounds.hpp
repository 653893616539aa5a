// SPDX-License-Identifier: MIT
// `crofton fit --bounds`: spheres, boxes and k-DOPs around each mesh, and which of them costs least.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct BoundsRun {
    std::vector<std::string> files;
    std::string criterion_name, json_path;
    measure::Criterion criterion;
    bool only_best = false;
    double region = 20.0;                     // radius of the sphere that queries hit, over that of the mesh's sphere
    double triangle_cost = 1.0;               // nanoseconds for a triangle that is passed on
    std::vector<glm::dvec3> directions = {};  // half of a k-DOP's, the user's own; empty: none
    ReadOptions read = {};
};

// The cost of N_v views is N_v·C_v + N_p·C_p, measured: each bound is tested against the same views, through
// cull::classify. C_v is the time of a test, N_p the number of views that see the bound, C_p the mesh's triangles times
// their cost. Beside it stands the share that the criterion predicts.
[[nodiscard]] Result<int> run_fit_bounds(const BoundsRun& run);

}  // namespace crofton::cli
