// SPDX-License-Identifier: MIT
// Points, clusters and peers for fit_bench.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace crofton::bench {

using Points = std::vector<glm::vec3>;

// A generated surface of 438,000 vertices, bumpy like a scanned statue; the others are files of the shared data.
inline const std::string kScan = "scan_438k";
inline const std::vector<std::string> kMeshes = {"suzanne",   "spider",  "wuson",  "cow",   "teapot",
                                                 "homer",     "fandisk", "beetle", "bunny", "engine",
                                                 "armadillo", "horse",   kScan};

[[nodiscard]] std::optional<Points> load_points(const std::string& mesh);
[[nodiscard]] Points turned(const Points& points, std::uint32_t seed);

// The shortest of a few runs, in milliseconds of processor time: the machine's other work can only add.
template <class Work>
double best_milliseconds(int repetitions, const Work& work) {
    double best = 1e300;
    for (int i = 0; i < repetitions; ++i) {
        const std::clock_t start = std::clock();
        work();
        best = std::min(best, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
}

// Triangles split at the median of the longest side of their centres' bounds until a cluster has at most `triangles`.
struct ClusteredMesh {
    Points positions;
    std::vector<std::uint32_t> indices, ends;
};
[[nodiscard]] std::optional<ClusteredMesh> load_clusters(const std::string& mesh, std::size_t triangles);

// The vertices alone, split likewise into clusters of exactly `size` (what is left over makes smaller ones).
[[nodiscard]] std::optional<ClusteredMesh> load_vertex_clusters(const std::string& mesh, std::size_t size);

// The extreme points along the seven directions of DiTO-14 (Larsson and Källberg 2011): its pass over the points.
[[nodiscard]] std::array<std::uint32_t, 14> dito14_pass(const Points& points);

// The shortest of `repetitions` runs of CGAL::oriented_bounding_box with its default parameters (convex hull first);
// nothing where CGAL is not installed.
[[nodiscard]] std::optional<double> cgal_milliseconds(const Points& points, int repetitions);

}  // namespace crofton::bench
