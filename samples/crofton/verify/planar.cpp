// SPDX-License-Identifier: MIT
// The paper's plane: measures of lines (3), (7), (8), (9), Theorems 1 and 2, bounds given ancestors, minimal
// rectangles.
#include <algorithm>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_bounds.hpp>
#include <crofton/study/planar_lines.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "bodies.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using measure::PlanarMeasures;
using std::numbers::pi;
using study::PlanarSupport;

// Uniform lines: a normal direction and a distance in [−R, R], R the radius; the measure of all of them is 2π R.
VerifyRow counted_lines(std::string claim, std::string source, double predicted,
                        const std::vector<PlanarSupport>& figures, const VerifyOptions& options, std::uint64_t salt,
                        double subtract = 0.0) {
    const double radius = 4.0;
    const std::uint64_t trials = 4 * options.trials;
    const sampling::UnitPoints points(options.seed * 1000 + salt);
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < trials; ++i) {
        const auto u = points.at<2>(i);
        const double phi = pi * u[0], distance = radius * (2.0 * u[1] - 1.0);
        hits += std::all_of(figures.begin(), figures.end(),
                            [&](const PlanarSupport& h) { return -h(phi + pi) <= distance && distance <= h(phi); });
    }
    const double all = 2.0 * pi * radius;
    const Share share = share_of(hits, trials);
    return measured_row(std::move(claim), std::move(source), predicted, all * share.value - subtract,
                        all * share.standard_error);
}

void line_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::vector<glm::dvec2> triangle = {{-1.0, -0.5}, {2.0, 0.0}, {0.0, 1.5}};
    const PlanarSupport polygon = PlanarSupport::of_convex_polygon(triangle);
    const std::vector<Disc> discs = {{{0.0, 0.0}, 1.5}, {{1.0, 0.5}, 1.0}, {{-0.5, 0.8}, 1.2}, {{2.5, 0.0}, 0.4}};
    std::vector<PlanarSupport> circles;
    for (const Disc& d : discs) circles.emplace_back(d);
    const std::vector<PlanarSupport> mixed = {circles[0], polygon,
                                              PlanarSupport(Rectangle{{0.5, 0.2}, {0.8, 0.6}, {1.5, 0.3}})};
    const std::vector<PlanarSupport> two = {circles[0], circles[1]},
                                     apart = {circles[1], PlanarSupport(Disc{{-3.0, 0.0}, 0.7})};

    rows.push_back(counted_lines("lines that hit a triangle: its perimeter", "theory.md section 1",
                                 measure::planar_measures_of_convex_polygon(triangle).perimeter, {polygon}, options,
                                 101));
    rows.push_back(counted_lines("lines that hit a disc, a triangle and a rectangle", "theory.md (3)",
                                 measure_of_lines_hitting_all(mixed), mixed, options, 102));
    rows.push_back(counted_lines("lines that hit four discs", "theory.md (3)", measure_of_lines_hitting_all(circles),
                                 circles, options, 103));
    rows.push_back(counted_lines("lines that hit two discs apart", "theory.md (3)", measure_of_lines_hitting_all(apart),
                                 apart, options, 104));
    const double seven = two[0].integral() + two[1].integral() - max(two[0], two[1]).integral();
    rows.push_back(computed_row("two discs that meet: L1 + L2 - L_hull = (3)", "paper (7)", seven,
                                measure_of_lines_hitting_all(two), 1e-12));
    rows.push_back(
        counted_lines("two discs that meet: L1 + L2 - L_hull lines hit both", "paper (7)", seven, two, options, 105));
    rows.push_back(computed_row("four discs: arcs and tangents = (3)", "paper (9)",
                                study::measure_of_lines_by_tangents(discs), measure_of_lines_hitting_all(circles),
                                1e-12));
    rows.push_back(counted_lines("four discs: as many lines hit all as arcs and tangents say", "paper (9)",
                                 study::measure_of_lines_by_tangents(discs), circles, options, 106));
}

void triangle_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    // The degenerate triangle, a segment of length 2 (l = 1): 4 lines hit it. Its ancestor is the unit disc.
    const PlanarSupport first(Disc{{0.0, 0.0}, 1.0});
    rows.push_back(counted_lines("triangle example: m(R→l) = (2π − 4)·l lines hit the circle and miss the triangle",
                                 "paper (8), completed by −4l", 2.0 * pi - 4.0, {first}, options, 110, 4.0));
    VerifyRow misprint = counted_lines("", "", 2.0 * pi, {first}, options, 110, 4.0);
    rows.push_back(wrong_row("triangle example without the term −4l: m(R→l) = 2π·l", "paper (8) as printed", 2.0 * pi,
                             misprint.measured, misprint.standard_error));
    const std::vector<glm::dvec2> triangle = {{-1.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}};
    const auto best = study::optimal_disc(triangle, first);
    const double least = best->measure - 4.0;
    rows.push_back(computed_row("triangle example: the best second circle leaves 1.3637·l improper tests",
                                "paper, section 4", 1.3637, least, 1e-4));
    rows.push_back(
        computed_row("triangle example: its radius is 1.871·l", "paper, section 4", 1.871, best->bound.radius, 1e-3));
    rows.push_back(computed_row("triangle example: the gain is approximately 40 %", "paper, section 4", 0.403,
                                1.0 - least / (2.0 * pi - 4.0), 1e-3));
    rows.push_back(computed_row("triangle example: no circle is better (certificate)", "theory.md section 4",
                                best->measure, best->lower_bound, 2.0 * pi * 1e-9));
    rows.push_back(counted_lines("triangle example: as many lines as that hit both circles and miss the triangle",
                                 "paper, section 4", least, {first, PlanarSupport(best->bound)}, options, 111, 4.0));
}

// --- Theorems 1 and 2: improper tests of rays and frusta of growing size R ---

struct Improper {
    Mean outside, inside;
};

// The measures of improper tests of `bound` around `object`, for motions of `query`.
Improper improper(const Figure& query, const Figure& bound, const Figure& object, double radius,
                  const VerifyOptions& options, std::uint64_t salt) {
    const sampling::UnitPoints points(options.seed * 1000 + salt);
    Improper result;
    for (std::uint64_t i = 0; i < options.trials; ++i) {
        const AnchoredFigure q = anchored(query, radius, points.at<4>(i));
        const bool hits_bound = meet(q.figure, bound), hits_object = hits_bound && meet(q.figure, object);
        result.outside.add(hits_bound && !hits_object ? q.weight : 0.0);
        const bool inside = query.size() > 2 && hits_object && holds(q.figure, object) && !holds(q.figure, bound);
        result.inside.add(inside ? q.weight : 0.0);
    }
    return result;
}

// The mean over all rotations of the area of positions at which a triangular frustum contains K: the inner parallel
// triangle is similar, of area A·(1 − Σ ℓ_i·h_i/2A)². Valid while it exists for every rotation.
double measure_of_containing(const Figure& triangle, const PlanarSupport& k) {
    const double area = measure::planar_measures_of_convex_polygon(triangle).area;
    const int steps = 1 << 16;
    double sum = 0.0;
    for (int s = 0; s < steps; ++s) {
        double taken = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 d = triangle[(i + 1) % 3] - triangle[i];
            taken += glm::length(d) * k(std::atan2(-d.x, d.y) + (s + 0.5) * 2.0 * pi / steps);
        }
        sum += area * (1.0 - taken / (2.0 * area)) * (1.0 - taken / (2.0 * area)) / steps;
    }
    return sum;
}

void theorem_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const Figure object = {{-0.8, -0.3}, {0.9, -0.4}, {0.2, 0.6}};
    const Figure bound = {{-0.8, -0.4}, {0.9, -0.4}, {0.9, 0.6}, {-0.8, 0.6}};
    const PlanarMeasures o = measure::planar_measures_of_convex_polygon(object),
                         b = measure::planar_measures_of_convex_polygon(bound);
    const PlanarSupport oh = PlanarSupport::of_convex_polygon(object), bh = PlanarSupport::of_convex_polygon(bound);
    const double gap = b.perimeter - o.perimeter;
    std::uint64_t salt = 120;
    for (const double size : {10.0, 100.0, 1000.0}) {
        const std::string at = " at R = " + std::to_string(static_cast<int>(size));
        const Figure ray = {{0.0, 0.0}, {size, 0.0}};
        const double scale = gap * size;
        const auto row = [&](const std::string& claim, const char* source, double exact, const Mean& mean) {
            rows.push_back(
                measured_row(claim + at, source, exact / scale, mean.value() / scale, mean.standard_error() / scale));
        };
        const Improper rays = improper(ray, bound, object, 2.5, options, salt++);
        row("rays: improper tests m/((L − L0)·R)", "paper, Theorem 1",
            measure::improper_outside(measure::planar_measures_of_segment(size), b, o), rays.outside);
        const Figure wedge = {{0.0, 0.0}, {size, -0.4 * size}, {size, 0.4 * size}};
        const PlanarMeasures w = measure::planar_measures_of_convex_polygon(wedge);
        const Improper frusta = improper(wedge, bound, object, 2.5, options, salt++);
        row("frusta: improper outside m_o/((L − L0)·R)", "paper, Theorem 2", measure::improper_outside(w, b, o),
            frusta.outside);
        row("frusta: improper inside m_i/((L − L0)·R)", "paper, Theorem 2",
            measure_of_containing(wedge, oh) - measure_of_containing(wedge, bh), frusta.inside);
    }
    // The limits: exact values at a size where what is left over is below the tolerance.
    const double far = 1e6;
    const Figure wedge = {{0.0, 0.0}, {far, -0.4 * far}, {far, 0.4 * far}};
    const PlanarMeasures w = measure::planar_measures_of_convex_polygon(wedge);
    rows.push_back(computed_row("rays: m/((L − L0)·R) tends to 1/π", "paper, Theorem 1", 1.0 / pi,
                                measure::improper_outside(measure::planar_measures_of_segment(far), b, o) / (gap * far),
                                1e-5));
    rows.push_back(computed_row("frusta: m_o/((L − L0)·R) tends to L_B/(2πR)", "paper, Theorem 2",
                                w.perimeter / (2.0 * pi * far), measure::improper_outside(w, b, o) / (gap * far),
                                1e-5));
    rows.push_back(
        computed_row("frusta: m_i/((L − L0)·R) tends to the same", "paper, Theorem 2", w.perimeter / (2.0 * pi * far),
                     (measure_of_containing(wedge, oh) - measure_of_containing(wedge, bh)) / (gap * far), 1e-4));
}

// Minimal-perimeter rectangle against rectangles of random orientation, in improper tests of a large frustum.
void rectangle_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    sampling::Random random(options.seed, 5);
    Figure points;
    for (int i = 0; i < 12; ++i) points.push_back(glm::dvec2(1.0, 0.35) * sampling::disc_point(random.point<2>()));
    const auto hull = *measure::convex_hull(points);
    const Figure object(hull.begin(), hull.end());
    const auto rectangle = [&](const glm::dvec2& axis) {
        const glm::dvec2 across(-axis.y, axis.x);
        glm::dvec2 low(1e300), high(-1e300);
        for (const glm::dvec2& p : object) {
            const glm::dvec2 q(glm::dot(p, axis), glm::dot(p, across));
            low = glm::min(low, q), high = glm::max(high, q);
        }
        const auto corner = [&](double x, double y) { return x * axis + y * across; };
        return Figure{corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)};
    };
    const auto perimeter = [](const Figure& f) { return measure::planar_measures_of_convex_polygon(f).perimeter; };
    Figure best = rectangle({1.0, 0.0});
    for (std::size_t i = 0; i < object.size(); ++i) {  // one side of the minimum is flush
        const Figure flush = rectangle(glm::normalize(object[(i + 1) % object.size()] - object[i]));
        if (perimeter(flush) < perimeter(best)) best = flush;
    }
    const Figure wedge = {{0.0, 0.0}, {60.0, -30.0}, {60.0, 30.0}};
    const sampling::UnitPoints queries(options.seed * 1000 + 150);
    Mean difference, minimal;
    for (std::uint64_t i = 0; i < options.trials; ++i) {
        const AnchoredFigure q = anchored(wedge, 2.5, queries.at<4>(i));
        const bool hits = meet(q.figure, object), inside = holds(q.figure, object);
        const auto misled = [&](const Figure& bound) {
            return (meet(q.figure, bound) && !hits) || (inside && !holds(q.figure, bound));
        };
        const double mine = misled(best) ? q.weight : 0.0;
        const double other = misled(rectangle(sampling::circle_point(random.uniform()))) ? q.weight : 0.0;
        minimal.add(mine);
        difference.add(mine - other);
    }
    rows.push_back(
        at_most_row("frusta: improper tests of the minimal-perimeter rectangle less those of random rectangles",
                    "paper, Theorem 2", 0.0, difference.value(), difference.standard_error()));
    const PlanarMeasures w = measure::planar_measures_of_convex_polygon(wedge),
                         b = measure::planar_measures_of_convex_polygon(best),
                         o = measure::planar_measures_of_convex_polygon(object);
    const double exact = measure::improper_outside(w, b, o) +
                         measure_of_containing(wedge, PlanarSupport::of_convex_polygon(object)) -
                         measure_of_containing(wedge, PlanarSupport::of_convex_polygon(best));
    rows.push_back(measured_row("frusta: improper tests of the minimal-perimeter rectangle, m_o + m_i",
                                "paper, Theorem 2", exact, minimal.value(), minimal.standard_error()));
}

}  // namespace

std::vector<VerifyRow> planar_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    line_rows(options, rows);
    triangle_rows(options, rows);
    theorem_rows(options, rows);
    rectangle_rows(options, rows);
    return rows;
}

}  // namespace crofton::cli
