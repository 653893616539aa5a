// SPDX-License-Identifier: MIT
// Global lines: the right densities pass a test of uniformity, the wrong ones fail it; what a patch expects of N lines.
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/wrong_lines.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "bodies.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using sampling::Random;
using std::numbers::pi;

// Uniform lines through the unit ball, whose shadow is a disc: their direction is uniform on the sphere and, given
// that, their place is uniform in the disc. Equal cells of both: 4 heights × 8 longitudes, 4 distances × 8 angles.
constexpr std::size_t kCells = 1024;

class Uniformity {
  public:
    // Lines that miss the unit ball do not count.
    void add(const Line& line) {
        const glm::dvec3& d = line.direction;
        const glm::dvec3 foot = line.point - glm::dot(line.point, d) * d;
        const double squared = glm::dot(foot, foot);
        if (squared >= 1.0) return;
        const auto [x, y] = sampling::orthonormal_frame(d);
        const auto part = [](double u, std::size_t n) {
            return std::min(n - 1, static_cast<std::size_t>(u * static_cast<double>(n)));
        };
        const auto turn = [](double s, double c) { return std::atan2(s, c) / (2.0 * pi) + 0.5; };
        const std::size_t direction = part(0.5 * (d.z + 1.0), 4) * 8 + part(turn(d.y, d.x), 8);
        const std::size_t place = part(squared, 4) * 8 + part(turn(glm::dot(foot, y), glm::dot(foot, x)), 8);
        ++counts_[direction * 32 + place];
        ++total_;
    }
    // χ² of equal cells: mean k − 1, variance 2(k − 1)(n − 1)/n.
    [[nodiscard]] double chi_square() const {
        const double expected = static_cast<double>(total_) / kCells;
        double sum = 0.0;
        for (const std::uint64_t c : counts_)
            sum += (static_cast<double>(c) - expected) * (static_cast<double>(c) - expected) / expected;
        return sum;
    }

  private:
    std::array<std::uint64_t, kCells> counts_{};
    std::uint64_t total_ = 0;
};

constexpr double kMeanChiSquare = kCells - 1.0;
const double kErrorOfChiSquare = std::sqrt(2.0 * kMeanChiSquare);

const Sphere kUnitSphere{glm::dvec3(0.0), 1.0};
const Aabb kBox{glm::dvec3(-1.5, -1.0, -1.0), glm::dvec3(1.0, 2.0, 1.25)};  // around the unit ball

TriangleMesh octahedron(float radius) {
    TriangleMesh mesh;
    mesh.positions = {{radius, 0.0f, 0.0f},  {-radius, 0.0f, 0.0f}, {0.0f, radius, 0.0f},
                      {0.0f, -radius, 0.0f}, {0.0f, 0.0f, radius},  {0.0f, 0.0f, -radius}};
    mesh.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    return mesh;
}

template <class Sample>
double chi_square(std::uint64_t trials, std::uint64_t seed, Sample sample) {
    Uniformity uniformity;
    Random random(seed, 11);
    for (std::uint64_t i = 0; i < trials; ++i) uniformity.add(sample(random));
    return uniformity.chi_square();
}

void uniformity_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::uint64_t trials = 4 * options.trials;
    const auto right = [&](const char* name, auto sample, std::uint64_t lines) {
        rows.push_back(measured_row(std::string("χ² of directions and places, 1,024 cells: ") + name,
                                    "theory.md section 6", kMeanChiSquare, chi_square(lines, options.seed, sample),
                                    kErrorOfChiSquare));
    };
    right(
        "(a) two sphere points",
        [](Random& r) { return sampling::line_through_two_sphere_points(kUnitSphere, r.point<4>()); }, trials);
    right(
        "(b) a direction and a disc point",
        [](Random& r) { return sampling::line_through_disc(kUnitSphere, r.point<4>()); }, trials);
    right(
        "(d) cosine-weighted from a box", [](Random& r) { return sampling::line_from_box(kBox, r.point<5>()); },
        trials);
    const auto hull = sampling::LinesFromHull::make(octahedron(2.0f));
    right(
        "(d) cosine-weighted from an octahedron", [&](Random& r) { return (*hull)(r.point<5>()); }, trials);
    // (c): lines of one bundle are not independent, so at most one of each is taken: number k, where there are so many,
    // with k uniform below the most there can be (one a cell), which prefers no bundle.
    const auto number_in_bundle = [](Random& r, Vector<Line>& bundle) {
        constexpr double cell = 0.5, most = 36.0;  // 6 × 6 cells of side 0.71 can reach the unit disc
        bundle.clear();
        sampling::append_line_bundle(kUnitSphere, cell, r, bundle);
        return static_cast<std::size_t>(most * r.uniform());
    };
    Vector<Line> bundle;
    right(
        "(c) one line of each jittered bundle",
        [&](Random& r) {
            for (;;)
                if (const std::size_t k = number_in_bundle(r, bundle); k < bundle.size()) return bundle[k];
        },
        trials / 4);

    // Enough lines to see what is wrong, however few trials are asked for.
    const std::uint64_t enough = std::max<std::uint64_t>(trials, 200'000);
    const auto wrong = [&](const char* name, auto sample) {
        rows.push_back(wrong_row(std::string("χ² of directions and places: ") + name + " are uniform",
                                 "theory.md section 6", kMeanChiSquare, chi_square(enough, options.seed, sample),
                                 kErrorOfChiSquare));
    };
    wrong("lines through two uniform points of a box",
          [](Random& r) { return study::wrong::line_through_two_box_points(kBox, r.point<6>()); });
    wrong("lines from a sphere point in uniform directions",
          [](Random& r) { return study::wrong::line_from_sphere_uniform_direction(kUnitSphere, r.point<4>()); });
}

// In the plane: distances from the centre are uniform on [0, R].
void plane_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    constexpr std::size_t cells = 64;
    const std::uint64_t trials = std::max<std::uint64_t>(options.trials, 50'000);
    const auto chi = [&](auto distance) {
        std::array<std::uint64_t, cells> counts{};
        Random random(options.seed, 12);
        for (std::uint64_t i = 0; i < trials; ++i)
            ++counts[std::min(cells - 1, static_cast<std::size_t>(distance(random) * static_cast<double>(cells)))];
        const double expected = static_cast<double>(trials) / cells;
        double sum = 0.0;
        for (const std::uint64_t c : counts)
            sum += (static_cast<double>(c) - expected) * (static_cast<double>(c) - expected) / expected;
        return sum;
    };
    const double mean = cells - 1.0, error = std::sqrt(2.0 * mean);
    rows.push_back(wrong_row("in the plane, lines through two points of a circle are uniform", "theory.md section 6",
                             mean, chi([](Random& r) {
                                 const auto line = study::wrong::line_through_two_circle_points(1.0, r.point<2>());
                                 return std::abs(line.point.x * line.direction.y - line.point.y * line.direction.x);
                             }),
                             error));
    rows.push_back(measured_row("in the plane, cosine-weighted lines from a point of a circle are uniform",
                                "theory.md section 6", mean, chi([](Random& r) {
                                    // The sine of the angle to the normal is uniform.
                                    const glm::dvec2 a = sampling::circle_point(r.uniform()), across(-a.y, a.x);
                                    const double sine = 2.0 * r.uniform() - 1.0;
                                    const glm::dvec2 d = sine * across - std::sqrt(1.0 - sine * sine) * a;
                                    return std::abs(a.x * d.y - a.y * d.x);
                                }),
                                error));
}

// Crossings of a bent patch, two rectangles of 0.5 × 0.6 along a common edge; area 0.6.
struct Patch {
    glm::dvec3 corner{-0.2, -0.3, 0.1};
    glm::dvec3 edge{0.0, 0.6, 0.0};
    std::array<glm::dvec3, 2> sides = {glm::dvec3(0.5, 0.0, 0.0), glm::dvec3(-0.3, 0.0, 0.4)};
    static constexpr double kArea = 0.6;

    [[nodiscard]] double crossings(const Line& line) const {
        double count = 0.0;
        for (const glm::dvec3& side : sides) {
            const glm::dvec3 normal = glm::cross(side, edge);
            const double t = glm::dot(corner - line.point, normal) / glm::dot(line.direction, normal);
            const glm::dvec3 p = line.point + t * line.direction - corner;
            const double u = glm::dot(p, side) / glm::dot(side, side), v = glm::dot(p, edge) / glm::dot(edge, edge);
            count += u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0;
        }
        return count;
    }
};

void patch_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const Patch patch;
    const auto row = [&](const char* name, double surface, auto sample) {
        Random random(options.seed, 13);
        Mean mean;
        for (std::uint64_t i = 0; i < 2 * options.trials; ++i) mean.add(patch.crossings(sample(random)));
        rows.push_back(measured_row(std::string("mean hits of a bent patch per line: ") + name, "theory.md section 6",
                                    2.0 * Patch::kArea / surface, mean.value(), mean.standard_error()));
    };
    const glm::dvec3 size = kBox.max - kBox.min;
    row("(a), A/(2πR²)", 4.0 * pi,
        [](Random& r) { return sampling::line_through_two_sphere_points(kUnitSphere, r.point<4>()); });
    row("(b), A/(2πR²)", 4.0 * pi, [](Random& r) { return sampling::line_through_disc(kUnitSphere, r.point<4>()); });
    row("(d) from a box, 2A/F", 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x),
        [](Random& r) { return sampling::line_from_box(kBox, r.point<5>()); });
    const auto hull = sampling::LinesFromHull::make(octahedron(2.0f));
    row("(d) from an octahedron, 2A/F", hull->area(), [&](Random& r) { return (*hull)(r.point<5>()); });

    const double cell = 0.02;
    Vector<Line> lines;
    Random random(options.seed, 14);
    Mean mean, lines_per_bundle;
    for (std::uint64_t i = 0; i < std::max<std::uint64_t>(options.trials / 50, 400); ++i) {
        lines.clear();
        sampling::append_line_bundle(kUnitSphere, cell, random, lines);
        double hits = 0.0;
        for (const Line& line : lines) hits += patch.crossings(line);
        mean.add(hits);
        lines_per_bundle.add(static_cast<double>(lines.size()));
    }
    rows.push_back(measured_row("mean hits of a bent patch per bundle: (c), A/(2Δ)", "theory.md section 6",
                                Patch::kArea / (2.0 * cell), mean.value(), mean.standard_error()));
    rows.push_back(measured_row("lines of a bundle: πR²/Δ", "theory.md section 6", pi / cell, lines_per_bundle.value(),
                                lines_per_bundle.standard_error()));
    rows.push_back(wrong_row("mean hits of a bent patch per bundle: 2A/Δ", "paper, section 6, as printed",
                             2.0 * Patch::kArea / cell, mean.value(), mean.standard_error()));
}

}  // namespace

std::vector<VerifyRow> verify_lines(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    uniformity_rows(options, rows);
    plane_rows(options, rows);
    patch_rows(options, rows);
    for (VerifyRow& row : factor_rows(options)) rows.push_back(std::move(row));
    return rows;
}

}  // namespace crofton::cli
