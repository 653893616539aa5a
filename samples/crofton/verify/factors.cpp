// SPDX-License-Identifier: MIT
// Form factors by global lines against known values, and the paper's other ways to draw lines.
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/other_lines.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry.hpp"
#include "standard_pairs.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using std::numbers::pi;

void pair_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    for (const StandardPair& pair : standard_pairs()) {
        const auto found =
            factor_by_global_lines(pair, effort(options, pair.factor < 0.25 ? 5000 : 2000), options.seed);
        if (!found) {
            rows.push_back(untried_row("form factor of " + pair.name, pair.source));
            continue;
        }
        rows.push_back(measured_row("form factor of " + pair.name, "theory.md section 6, " + pair.source, pair.factor,
                                    found->value, found->standard_error));
    }
}

// Lines through opposite faces of the unit cube: of all of them, and of those through the same quarter of both.
void opposite_faces(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::vector<StandardPair> pairs = standard_pairs();
    const double all = pi * pairs[0].factor;
    // A quarter each: squares of side 1/2 at distance 1, by Howell's C-11 with X = Y = 1/2.
    const double x = 0.5, p = 1.0 + x * x;
    const double factor = 2.0 / (pi * x * x) *
                          (std::log(std::sqrt(p * p / (p + x * x))) +
                           2.0 * x * std::sqrt(p) * std::atan(x / std::sqrt(p)) - 2.0 * x * std::atan(x));
    const double quarters = 0.25 * pi * factor;
    const Aabb cube{glm::dvec3(0.0), glm::dvec3(1.0)};
    const sampling::UnitPoints points(options.seed * 1000 + 470);
    Mean whole, both, unweighted;
    // Enough to see what is wrong, however few trials are asked for.
    for (std::uint64_t i = 0; i < std::max<std::uint64_t>(4 * options.trials, 100'000); ++i) {
        const auto u = points.at<4>(i);
        const study::WeightedLine line = study::line_through_opposite_faces(cube, 2, u);
        const glm::dvec3 a = line.line.point, b = a + line.line.direction / line.line.direction.z;
        const bool same = a.x < 0.5 && a.y < 0.5 && b.x < 0.5 && b.y < 0.5;
        whole.add(line.weight);
        both.add(same ? line.weight : 0.0);
        unweighted.add(same ? 1.0 : 0.0);
    }
    const char* const source = "paper, section 6, opposite faces";
    rows.push_back(measured_row("lines through opposite faces of a cube, weighted 1/r⁴: their measure", source, all,
                                whole.value(), whole.standard_error()));
    rows.push_back(measured_row("of these, through the same quarter of both", source, quarters, both.value(),
                                both.standard_error()));
    rows.push_back(wrong_row("lines through opposite faces are uniform without a weight", source, quarters / all,
                             unweighted.value(), unweighted.standard_error()));
}

void parallelograms(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    // A rectangle in the sphere: crossed where the foot lies inside. Given the direction the mean is A·|cosine|/Δ: what
    // is known of that is taken off, since the directions' density has rows of its own.
    const glm::dvec3 corner(-0.4, -0.3, 0.1), x(0.8, 0.0, 0.2), y(0.0, 0.7, 0.0);
    const glm::dvec3 normal = glm::cross(x, y);
    const glm::dvec2 first(0.2, 0.0), second(0.13, 0.1);
    const double cell = 0.02, area = glm::length(normal);
    sampling::Random random(options.seed, 41);
    Vector<Line> lines;
    Mean hits;
    for (int i = 0; i < static_cast<int>(effort(options, 8'000)); ++i) {
        lines.clear();
        study::append_parallelogram_bundle({glm::dvec3(0.0), 1.0}, first, second, random, lines);
        double count = 0.0;
        for (const Line& line : lines) {
            const double t = glm::dot(corner - line.point, normal) / glm::dot(line.direction, normal);
            const glm::dvec3 p = line.point + t * line.direction - corner;
            const double u = glm::dot(p, x) / glm::dot(x, x), v = glm::dot(p, y) / glm::dot(y, y);
            count += u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0;
        }
        hits.add(count - std::abs(glm::dot(lines[0].direction, normal)) / cell + 0.5 * area / cell);
    }
    rows.push_back(measured_row("mean hits of a rectangle per bundle with parallelograms for cells: A/(2Δ)",
                                "paper, section 6, parallelograms", area / (2.0 * cell), hits.value(),
                                hits.standard_error()));
}

}  // namespace

std::vector<VerifyRow> factor_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    pair_rows(options, rows);
    opposite_faces(options, rows);
    parallelograms(options, rows);
    return rows;
}

}  // namespace crofton::cli
