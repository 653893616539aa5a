// SPDX-License-Identifier: MIT
// Form factors by global lines against known values, and the paper's other ways to draw lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/lines/lines.hpp>
#include <crofton/radiosity/patches.hpp>
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

// Adds the six faces of a box, seen from inside; face 2k lies at the low end of axis k, face 2k + 1 at the high end.
void add_box(const glm::vec3& low, const glm::vec3& high, TriangleMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1u ? high.x : low.x, i & 2u ? high.y : low.y, i & 4u ? high.z : low.z);
    for (const auto& f : {std::array{0u, 2u, 6u, 4u},
                          {1u, 5u, 7u, 3u},
                          {0u, 4u, 5u, 1u},
                          {2u, 3u, 7u, 6u},
                          {0u, 1u, 3u, 2u},
                          {4u, 6u, 7u, 5u}})
        for (const std::uint32_t k : {f[0], f[1], f[2], f[0], f[2], f[3]}) mesh.indices.push_back(first + k);
}

// Local lines from one face of a unit cube, by each of both densities that are right.
void local_lines(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 6, local lines";
    TriangleMesh cube;
    add_box(glm::vec3(0.0f), glm::vec3(1.0f), cube);
    const std::uint32_t faces[] = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
    const std::vector<radiosity::Material> materials(6);
    const auto patches = radiosity::make_patches(cube, faces, materials);
    const auto tracer = lines::LineTracer::build(cube);
    if (!patches || !tracer) return rows.push_back(untried_row("form factors by local lines", source));
    const double opposite = standard_pairs()[0].factor, beside = 0.25 * (1.0 - opposite);
    const std::uint64_t count = std::max<std::uint64_t>(options.trials, 50'000);
    for (const auto density : {radiosity::LocalDensity::cosine, radiosity::LocalDensity::uniform}) {
        const bool weighted = density == radiosity::LocalDensity::uniform;
        const std::string name = weighted ? ", uniform lines weighted by 2 cosines" : ", lines by the cosine";
        // The first has less spread: it alone is to see an error of one percent.
        const auto row = radiosity::factors_by_local_lines(*tracer, *patches, 4, weighted ? count : 8 * count, density,
                                                           options.seed);
        rows.push_back(measured_row("from a cube's face to the opposite one" + name, source, opposite, row.factors[5],
                                    row.standard_errors[5]));
        rows.push_back(measured_row("from a cube's face to one beside it" + name, source, beside, row.factors[0],
                                    row.standard_errors[0]));
    }
    const auto wrong = radiosity::factors_by_local_lines(*tracer, *patches, 4, count,
                                                         radiosity::LocalDensity::uniform_unweighted, options.seed);
    rows.push_back(
        wrong_row("uniform local lines need no weight", source, opposite, wrong.factors[5], wrong.standard_errors[5]));
}

// Lines through a domain meet a closed convex box in it, twice, with the ratio of both surfaces.
void crossings(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const char* const source = "theory.md section 6, crossings";
    TriangleMesh boxes;
    add_box({2.0f, 2.0f, 2.0f}, {6.0f, 5.0f, 4.0f}, boxes);
    add_box({1.0f, 1.0f, 1.0f}, {8.0f, 7.0f, 6.0f}, boxes);
    const auto tracer = lines::LineTracer::build(boxes);
    if (!tracer) return rows.push_back(untried_row("crossings of nested boxes", source));
    const lines::LineSource domain({{-1.0, 0.0, 0.0}, {10.0, 9.0, 8.0}}, lines::LineMethod::walls, options.seed);
    const double p = 214.0 / domain.surface_area(), q = 52.0 / domain.surface_area();
    const double mean = 2.0 * (p + q), square = 16.0 * q + 4.0 * (p - q), spread = std::sqrt(square - mean * mean);
    const double fourth = 256.0 * q + 16.0 * (p - q), third = 64.0 * q + 8.0 * (p - q);
    const auto seen = lines::visibility_complexity(*tracer, domain, std::max<std::uint64_t>(options.trials / 500, 100));
    const double n = static_cast<double>(seen.lines);
    rows.push_back(measured_row("mean crossings of two nested boxes: 2·S/F", source, mean, seen.mean_crossings,
                                spread / std::sqrt(n)));
    rows.push_back(
        measured_row("share of lines that miss both", source, 1.0 - p, seen.wasted, std::sqrt(p * (1.0 - p) / n)));
    // The variance's own variance, by its moments around the mean.
    const double around = fourth - 4.0 * mean * third + 6.0 * mean * mean * square - 3.0 * mean * mean * mean * mean;
    const double variance = spread * spread;
    rows.push_back(measured_row("variance of the crossings from line to line", source, variance,
                                seen.deviation * seen.deviation, std::sqrt((around - variance * variance) / n)));
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
    local_lines(options, rows);
    crossings(options, rows);
    return rows;
}

}  // namespace crofton::cli
