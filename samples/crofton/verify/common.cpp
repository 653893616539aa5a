// SPDX-License-Identifier: MIT
// The sharp rows on section 4 of theory.md and on the plane: what hits all of several bodies, by plain quadrature over
// directions.
#include <algorithm>
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/planar_lines.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using std::numbers::pi;
using study::PlanarSupport;
using Support = std::function<double(const glm::dvec2&)>;  // of a unit vector

Support support_of(const Disc& d) {
    return [d](const glm::dvec2& n) { return glm::dot(d.center, n) + d.radius; };
}
Support support_of(const Figure& figure) {
    return [figure](const glm::dvec2& n) {
        double h = -HUGE_VAL;
        for (const glm::dvec2& p : figure) h = std::max(h, glm::dot(p, n));
        return h;
    };
}

// ∫ over [0, π) of the room that all figures leave to a line of that direction.
double lines_through(const std::vector<Support>& figures) {
    return pi * mean_over_angles([&](double angle) {
               const glm::dvec2 n(std::cos(0.5 * angle), std::sin(0.5 * angle));
               double front = HUGE_VAL, back = HUGE_VAL;
               for (const Support& h : figures) front = std::min(front, h(n)), back = std::min(back, h(-n));
               return std::max(0.0, front + back);
           });
}

void planar_lines(std::vector<VerifyRow>& rows) {
    const std::vector<Disc> discs = {{{0.0, 0.0}, 1.5}, {{1.0, 0.5}, 1.0}, {{-0.5, 0.8}, 1.2}, {{2.5, 0.0}, 0.4}};
    const Figure triangle = {{-1.0, -0.5}, {2.0, 0.0}, {0.0, 1.5}};
    const Rectangle rectangle{{0.5, 0.2}, {0.8, 0.6}, {1.5, 0.3}};
    const glm::dvec2 x = 1.5 * rectangle.axis, y = 0.3 * glm::dvec2(-rectangle.axis.y, rectangle.axis.x);
    const Figure corners = {rectangle.center - x - y, rectangle.center + x - y, rectangle.center + x + y,
                            rectangle.center - x + y};
    std::vector<PlanarSupport> circles;
    std::vector<Support> plain;
    for (const Disc& d : discs) circles.emplace_back(d), plain.push_back(support_of(d));
    const std::vector<PlanarSupport> mixed = {circles[0], PlanarSupport::of_convex_polygon(triangle),
                                              PlanarSupport(rectangle)};
    const auto row = [&](const char* claim, const char* source, double predicted, const std::vector<Support>& figures,
                         double less = 0.0) {
        rows.push_back(computed_row(claim, source, predicted, lines_through(figures) - less, 1e-5 * predicted));
    };
    row("lines that hit a triangle, by quadrature", "paper (1), lines of the plane",
        measure::measure_of_lines(measure::planar_measures_of_convex_polygon(triangle)), {support_of(triangle)});
    row("lines that hit a disc, a triangle and a rectangle, by quadrature", "theory.md (3)",
        measure_of_lines_hitting_all(mixed), {plain[0], support_of(triangle), support_of(corners)});
    row("lines that hit four discs, by quadrature", "theory.md (3)", measure_of_lines_hitting_all(circles), plain);
    row("two discs that meet: L1 + L2 - L_hull, by quadrature", "paper (7)",
        circles[0].integral() + circles[1].integral() - max(circles[0], circles[1]).integral(), {plain[0], plain[1]});
    row("four discs: arcs and tangents, by quadrature", "paper (9)", study::measure_of_lines_by_tangents(discs), plain);
    row("triangle example: m(R→l) = (2π − 4)·l, by quadrature", "paper (8), completed by −4l", 2.0 * pi - 4.0,
        {support_of(Disc{{0.0, 0.0}, 1.0})}, 4.0);
}

// Blaschke's formula: the mean area of K ⊕ −B. The sum's corners are sums of corners.
void planar_motions(std::vector<VerifyRow>& rows) {
    const Figure wedge = {{0.0, 0.0}, {3.0, -1.0}, {3.0, 1.0}}, segment = {{-1.0, 0.0}, {1.0, 0.0}};
    const Figure bound = {{-0.8, -0.4}, {0.9, -0.4}, {0.9, 0.6}, {-0.8, 0.6}},
                 object = {{-0.8, -0.3}, {0.9, -0.4}, {0.2, 0.6}};
    const auto measures = [](const Figure& f) { return measure::planar_measures_of_convex_polygon(f); };
    const auto mean_area = [](const Figure& b, const Figure& k) {
        return mean_over_angles([&](double angle) {
            const glm::dvec2 turn(std::cos(angle), std::sin(angle));
            Figure sum;
            for (const glm::dvec2& p : b)
                for (const glm::dvec2& q : k)
                    sum.push_back(q - glm::dvec2(turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y));
            return hull_area(sum);
        });
    };
    for (const auto& [name, query] : {std::pair("a plane frustum", &wedge), std::pair("a segment", &segment)}) {
        const double hits = mean_area(*query, bound), object_hits = mean_area(*query, object);
        const double predicted = measure::kinematic_measure(measures(*query), measures(bound));
        rows.push_back(computed_row(std::string("mean area of the sum of ") + name + " and a rectangle",
                                    "theory.md (1), in the plane", predicted, hits, 1e-5 * predicted));
        const double outside = measure::improper_outside(measures(*query), measures(bound), measures(object));
        rows.push_back(computed_row(std::string("improper outside tests of ") + name, "paper, Theorems 1 and 2, m_o",
                                    outside, hits - object_hits, 1e-4 * outside));
    }
    // A large triangle contains K in the places of a smaller one of its shape: its sides move in by h_K.
    const double size = 1e6;
    const Figure far = {{0.0, 0.0}, {size, -0.4 * size}, {size, 0.4 * size}};
    const auto containing = [&](const Figure& k) {
        const double area = measures(far).area;
        return mean_over_angles([&](double angle) {
            double taken = 0.0;
            for (std::size_t i = 0; i < 3; ++i) {
                const glm::dvec2 side = far[(i + 1) % 3] - far[i], turn(std::cos(angle), std::sin(angle));
                taken +=
                    support_of(k)(glm::dvec2(turn.x * side.y + turn.y * side.x, turn.y * side.y - turn.x * side.x) /
                                  glm::length(side)) *
                    glm::length(side);
            }
            return area - taken + 0.25 * taken * taken / area;
        });
    };
    const double inside = measure::improper_inside(measures(far), measures(bound), measures(object));
    rows.push_back(computed_row("improper inside tests of a plane frustum of depth 1,000,000", "paper, Theorem 2, m_i",
                                inside, containing(object) - containing(bound), 1e-3 * inside));
}

struct Solid {
    Corners3 corners;
    double radius;
    [[nodiscard]] double support(const glm::dvec3& n) const {
        double h = -HUGE_VAL;
        for (const glm::dvec3& p : corners) h = std::max(h, glm::dot(p, n));
        return h + radius;
    }
    // A sphere's is a polygon of its disc's area.
    [[nodiscard]] Figure shadow(const glm::dvec3& x, const glm::dvec3& y) const {
        Figure points;
        for (const glm::dvec3& p : corners) points.emplace_back(glm::dot(p, x), glm::dot(p, y));
        if (radius == 0.0) {
            const auto hull = *measure::convex_hull(points);
            return Figure(hull.begin(), hull.end());
        }
        constexpr int kSides = 64;
        const double r = radius * std::sqrt(2.0 * pi / kSides / std::sin(2.0 * pi / kSides));
        Figure disc;
        for (int i = 0; i < kSides; ++i)
            disc.push_back(points[0] +
                           r * glm::dvec2(std::cos(2.0 * pi * i / kSides), std::sin(2.0 * pi * i / kSides)));
        return disc;
    }
};

void spatial(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    Obb a, b;
    a.half_extents = glm::vec3(1.0f, 0.5f, 0.25f);
    b.half_extents = glm::vec3(0.75f, 0.75f, 0.125f);
    b.center = glm::dvec3(0.5, 0.4, 0.3);
    b.axes = glm::mat3(sampling::rotation({0.3, 0.7, 0.2}));
    const std::vector<study::ConvexBody> bodies = {study::ConvexBody::box(a), study::ConvexBody::box(b),
                                                   study::ConvexBody::sphere(glm::dvec3(-0.3, 0.0, 0.4), 0.6)};
    std::vector<Solid> plain;
    for (const Obb& box : {a, b}) {
        const auto c = corners(box);
        plain.push_back({Corners3(c.begin(), c.end()), 0.0});
    }
    plain.push_back({{glm::dvec3(-0.3, 0.0, 0.4)}, 0.6});
    const Mean planes = mean_over_directions(options.seed * 1000 + 400, effort(options, 256), [&](const glm::dvec3& n) {
        double front = HUGE_VAL, back = HUGE_VAL;
        for (const Solid& k : plain) front = std::min(front, k.support(n)), back = std::min(back, k.support(-n));
        return std::max(0.0, front + back);
    });
    const Mean lines = mean_over_directions(options.seed * 1000 + 401, effort(options, 256), [&](const glm::dvec3& n) {
        const auto [x, y] = sampling::orthonormal_frame(n);
        Figure common = plain[0].shadow(x, y);
        for (std::size_t i = 1; i < plain.size(); ++i) common = clipped(common, plain[i].shadow(x, y));
        return common.size() < 3 ? 0.0 : hull_area(common);
    });
    const auto row = [&](const char* claim, const char* source, double predicted, const Mean& mean) {
        rows.push_back(
            measured_row(claim, source, predicted, 2.0 * pi * mean.value(), 2.0 * pi * mean.standard_error()));
    };
    row("planes that hit two boxes and a sphere, by quadrature", "theory.md (4)",
        measure_of_planes_hitting_all(bodies)->value, planes);
    row("lines that hit two boxes and a sphere, by clipped shadows", "theory.md (5)",
        measure_of_lines_hitting_all(bodies, {.tolerance = 1e-2, .max_cells = 40000})->value, lines);
}

}  // namespace

std::vector<VerifyRow> common_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    planar_lines(rows);
    planar_motions(rows);
    spatial(options, rows);
    return rows;
}

}  // namespace crofton::cli
