// SPDX-License-Identifier: MIT
// `crofton fit --views`: boxes for the directions in which a recorded camera path looks, and what they save.
#pragma once
#include <crofton/core/error.hpp>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

struct ViewsRun {
    std::vector<std::string> files;
    std::string views_path;  // as pipeline::load_camera_path takes it
    std::string json_path;
    bool trees = false;  // the files are scenes: see run_fit_view_trees
    ReadOptions read = {};
};

// For each mesh as it stands in its file: the box that uniform directions ask for beside the one that the path's do;
// the ratio of their measures, by the formula for boxes; and of their improper tests, counted: the mesh is put at
// random near the faces of the path's view volumes.
[[nodiscard]] Result<int> run_fit_views(const ViewsRun& run);

}  // namespace crofton::cli
