// SPDX-License-Identifier: MIT
// Trees: what the criterion expects a query to visit, against bounds counted as the trees store them.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>

#include "topics.hpp"

namespace crofton::cli {
namespace {

using boxtree::Orientation;

// Bundles of parallel beams, each turned its own way.
std::vector<Obb> beams(std::uint64_t seed) {
    sampling::Random random(seed);
    std::vector<Obb> boxes;
    while (boxes.size() < 2048) {
        const glm::dmat3 axes = sampling::rotation(random.point<3>());
        const glm::dvec3 at = 20.0 * sampling::ball_point(random.point<3>());
        for (int i = 0; i < 128; ++i)
            boxes.push_back({at + axes * glm::dvec3(0.0, 0.4 * (i % 8), 0.4 * (i / 8)), glm::mat3(axes),
                             glm::vec3(5.0f, 0.1f, 0.1f)});
    }
    return boxes;
}

// The bounds of a tree's children, as centres and half edges.
struct Bound {
    glm::dvec3 center, edges[3];
};
std::vector<Bound> bounds_of(const boxtree::BoxTree& tree) {
    std::vector<Bound> bounds;
    for (const boxtree::Node& node : tree.structure().nodes()) {
        const boxtree::Axes& axes = tree.structure().axes_of(node);
        for (unsigned lane = 0; lane < node.count; ++lane) {
            Bound bound{{node.origin[0], node.origin[1], node.origin[2]}, {}};
            for (unsigned k = 0; k < 3; ++k) {
                const glm::dvec3 axis(axes.rows[k][0], axes.rows[k][1], axes.rows[k][2]);
                bound.center += double{node.unit} * boxtree::middle_of(node, lane, k) * axis;
                bound.edges[k] = double{node.unit} * boxtree::half_of(node, lane, k) * axis;
            }
            bounds.push_back(bound);
        }
    }
    return bounds;
}

VerifyRow counted(const char* claim, Orientation orientation, const VerifyOptions& options) {
    const std::vector<Obb> boxes = beams(options.seed);
    const auto tree = boxtree::BoxTree::build(boxes, {.orientation = orientation});
    const std::vector<Bound> bounds = bounds_of(*tree);
    double perimeters = 0.0, radius = 0.0;
    for (const Bound& bound : bounds) {
        double diagonal = 0.0;
        for (const glm::dvec3& edge : bound.edges) {
            perimeters += 2.0 * glm::length(edge);
            diagonal += glm::dot(edge, edge);
        }
        radius = std::max(radius, glm::length(bound.center) + std::sqrt(diagonal));
    }
    // A plane that meets a sphere of radius R meets a box of edges a, b, c with probability (a + b + c)/(4 R).
    const sampling::UnitPoints points(options.seed * 1000 + 900);
    const std::uint64_t trials = 3 * options.trials;
    double mean = 0.0, squares = 0.0;
    for (std::uint64_t i = 0; i < trials; ++i) {
        const std::array<double, 3> u = points.at<3>(i);
        const glm::dvec3 normal = sampling::direction({u[0], u[1]});
        const double offset = radius * (2.0 * u[2] - 1.0);
        std::uint64_t hits = 0;
        for (const Bound& bound : bounds) {
            double half = 0.0;
            for (const glm::dvec3& edge : bound.edges) half += std::fabs(glm::dot(normal, edge));
            hits += std::fabs(glm::dot(normal, bound.center) - offset) <= half;
        }
        const double value = static_cast<double>(hits), away = value - mean;
        mean += away / static_cast<double>(i + 1);
        squares += away * (value - mean);
    }
    const double n = static_cast<double>(trials);
    return measured_row(claim, "theory.md section 4", perimeters / (4.0 * radius), mean,
                        std::sqrt(squares / (n * (n - 1.0))));
}

}  // namespace

std::vector<VerifyRow> tree_rows(const VerifyOptions& options) {
    return {counted("bounds of an aligned tree that a plane meets: their perimeters", Orientation::aligned, options),
            counted("bounds of an oriented tree that a plane meets: their perimeters", Orientation::oriented, options)};
}

}  // namespace crofton::cli
