#include <algorithm>
#include <cmath>
#include <crofton/fit/fit.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "enclose.hpp"
#include "local_search.hpp"
#include "point_cloud.hpp"

namespace crofton::fit {
namespace {

// Half of the directions to the faces, edges and corners of a cube: the 26-DOP.
constexpr glm::dvec3 kDirections[] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1},
                                      {0, 1, 1}, {0, 1, -1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

// Flat and straight sets have boxes of no volume in many frames: among these the surface area chooses.
constexpr double kFlat = 1e-13;

// Local optima on a growing subset: fit the subset, add what the box leaves outside, go on until it leaves nothing.
Candidate search(const PointCloud& cloud, const Weights& weights, int starts) {
    Vector<glm::dvec3> subset;
    cloud.extremes(kDirections, subset);
    make_canonical(subset);
    Vector<glm::dmat3> frames = {glm::dmat3(1.0)};
    tetrahedral_frames(subset, frames);
    Vector<Candidate> candidates;
    for (const glm::dmat3& frame : frames) candidates.push_back({frame, value_of(weights, subset, frame)});
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.value < b.value; });
    if (candidates.size() > static_cast<std::size_t>(starts)) candidates.resize(static_cast<std::size_t>(starts));

    SearchBuffers buffers;
    Candidate best;
    best.value = std::numeric_limits<double>::infinity();
    for (Candidate& candidate : candidates) {
        for (int round = 0; round < 8; ++round) {
            descend(weights, subset, candidate, buffers);
            const Supports supports = cloud.supports(candidate.axes);
            const double value = value_of(weights, supports, candidate.axes);
            if (value < best.value) best = {candidate.axes, value};
            if (value <= candidate.value * (1.0 + 1e-12)) break;
            subset.insert(subset.end(), supports.begin(), supports.end());
            make_canonical(subset);
        }
    }
    return best;
}

template <class Point>
Result<Obb> fit_points(std::span<const Point> points, const Options& options) {
    if (auto valid = measure::validate(options.criterion); !valid) return tl::unexpected(valid.error());
    Result<PointCloud> cloud = PointCloud::make(points);
    if (!cloud) return tl::unexpected(cloud.error());
    const Weights weights = normalised_weights(options.criterion, cloud->unit());
    const int starts = options.quality == Quality::fast ? 1 : options.quality == Quality::tight ? 4 : 22;
    Candidate best = search(*cloud, weights, starts);
    if (weights.pairs + weights.sum == 0.0 && best.value <= kFlat) best = search(*cloud, {0.0, 1.0, 0.0}, starts);
    return enclose(points, rounded(best.axes), cloud->origin());
}

}  // namespace

Result<Obb> fit_obb(std::span<const glm::vec3> points, const Options& options) {
    return fit_points(points, options);
}
Result<Obb> fit_obb(std::span<const glm::dvec3> points, const Options& options) {
    return fit_points(points, options);
}

Result<Obb> fit_oriented(std::span<const glm::dvec3> points, const glm::mat3& axes) {
    Obb shape;
    shape.axes = axes;
    if (auto valid = validate(shape); !valid) return tl::unexpected(valid.error());
    Result<PointCloud> cloud = PointCloud::make(points);
    if (!cloud) return tl::unexpected(cloud.error());
    return enclose(points, axes, cloud->origin());
}

}  // namespace crofton::fit
