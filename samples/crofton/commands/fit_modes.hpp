// SPDX-License-Identifier: MIT
// What `crofton fit` does with --views, --trees, --bounds and --planar.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/query_distribution.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "read_options.hpp"

namespace crofton::cli {

// `crofton fit --views`: boxes for the directions in which a recorded camera path looks, and what they save.
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

// `crofton fit --views PATH --trees SCENE…`: does a tree that is built for a path's directions pay on that path?
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

// `crofton fit --bounds`: spheres, boxes and k-DOPs around each mesh, and which of them costs least.
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

// `crofton fit --planar`: the best rectangle, disc and triangle around polygons, with what proves them best.
struct PlanarFitRun {
    std::vector<std::string> files;  // as read_polygons takes them
    std::string json_path, svg_path;
    ReadOptions read = {};
    std::size_t drawn = 12;  // polygons in the picture, the largest hulls first
};

// Fits around the outer ring of every polygon. A polygon that is refused is named on stderr and makes the exit status
// kBadInput; the others are done.
[[nodiscard]] Result<int> run_fit_planar(const PlanarFitRun& run);

}  // namespace crofton::cli
