// SPDX-License-Identifier: MIT
// Space: which criterion ranks bounds right for which query, minimal boxes, planes and lines through all, formula (6).
#include <algorithm>
#include <crofton/fit/fit.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/spatial_lines.hpp>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>

#include "bodies.hpp"
#include "topics.hpp"

namespace crofton::cli {
namespace {

using measure::IntrinsicVolumes;
using std::numbers::pi;

// The ratio of two means over the same trials, its error by the delta method.
class Ratio {
  public:
    void add(double a, double b) {
        const double n = static_cast<double>(++count_);
        const double da = a - a_, db = b - b_;
        a_ += da / n, b_ += db / n;
        aa_ += da * (a - a_), bb_ += db * (b - b_), ab_ += da * (b - b_);
    }
    [[nodiscard]] double value() const { return a_ / b_; }
    [[nodiscard]] double standard_error() const {
        const double n = static_cast<double>(count_), r = value();
        return std::sqrt(std::max(0.0, aa_ - 2.0 * r * ab_ + r * r * bb_) / (n * (n - 1.0))) / b_;
    }

  private:
    std::uint64_t count_ = 0;
    double a_ = 0.0, b_ = 0.0, aa_ = 0.0, bb_ = 0.0, ab_ = 0.0;
};

struct Ratios {
    Ratio outside, total;
};

// A sphere of `radius` must hold both bounds well inside: the query's boundary is anchored in that sphere.
Ratios compare(const Body& query, const Body& first, const Body& second, const Body& object, double radius,
               std::uint64_t trials, std::uint64_t seed) {
    const sampling::UnitPoints points(seed);
    Ratios result;
    for (std::uint64_t i = 0; i < trials; ++i) {
        const Anchored q = anchored(query, radius, points.at<8>(i));
        const bool hits = meet(q.body, object), inside = hits && !q.body.faces.empty() && holds(q.body, object);
        const auto outside = [&](const Body& bound) { return !hits && meet(q.body, bound) ? q.weight : 0.0; };
        const auto within = [&](const Body& bound) { return inside && !holds(q.body, bound) ? q.weight : 0.0; };
        const double a = outside(first), b = outside(second);
        result.outside.add(a, b);
        result.total.add(a + within(first), b + within(second));
    }
    return result;
}

// The correction of section 3.7: a cube (F 6, M 3π) and a plate (F 3.67, M 3.15π) around a point.
void ranking_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const Body cube = box_body({0.5, 0.5, 0.5}), plate = box_body({1.2, 0.35, 0.025});
    const Body point = box_body(glm::dvec3(1e-9));  // nearly
    const IntrinsicVolumes c = measure::intrinsic_volumes_of_box(1.0, 1.0, 1.0),
                           p = measure::intrinsic_volumes_of_box(2.4, 0.7, 0.05), none;
    std::uint64_t seed = options.seed * 1000 + 200;
    const auto exact = [&](const IntrinsicVolumes& q) {
        return measure::improper_outside(q, c, none) / measure::improper_outside(q, p, none);
    };
    const double long_ray = 50.0;
    const Ratios rays = compare(segment_body(long_ray), cube, plate, point, 2.6, 4 * options.trials, seed++);
    rows.push_back(measured_row("rays of length 50: improper tests of the cube over the plate's", "theory.md section 2",
                                exact(measure::intrinsic_volumes_of_segment(long_ray)), rays.outside.value(),
                                rays.outside.standard_error()));
    rows.push_back(computed_row("rays: the ratio tends to that of F", "paper, section 3; theory.md section 2",
                                c.area / p.area, exact(measure::intrinsic_volumes_of_segment(1e6)), 1e-4));
    for (const double depth : {0.5, 5.0, 20.0, 100.0, 1000.0}) {
        char size[48];
        std::snprintf(size, sizeof size, "frustum of depth %g: ", depth);
        const Body frustum = frustum_body(1.0, 0.6, 0.01 * depth, depth, true);
        const Ratios ratios = compare(frustum, cube, plate, point, 2.6, options.trials, seed++);
        rows.push_back(measured_row(size + std::string("improper outside tests of the cube over the plate's"),
                                    "theory.md section 2", exact(frustum_volumes(1.0, 0.6, 0.01 * depth, depth, true)),
                                    ratios.outside.value(), ratios.outside.standard_error()));
        if (depth == 0.5)
            rows.push_back(
                at_most_row(size + std::string("the plate misleads less, as F says (plate/cube, both kinds)"),
                            "theory.md section 2", 1.0, 1.0 / ratios.total.value(),
                            ratios.total.standard_error() / std::pow(ratios.total.value(), 2.0)));
        if (depth >= 20.0)
            rows.push_back(at_most_row(size + std::string("the cube misleads less, as M says (cube/plate, both kinds)"),
                                       "theory.md section 2", 1.0, ratios.total.value(),
                                       ratios.total.standard_error()));
        if (depth == 1000.0)
            rows.push_back(wrong_row(size + std::string("improper tests rank as F"), "paper, section 3.7, for 3D",
                                     c.area / p.area, ratios.total.value(), ratios.total.standard_error()));
    }
    rows.push_back(computed_row("frusta: the ratio tends to that of M", "theory.md section 2",
                                c.mean_curvature / p.mean_curvature, exact(frustum_volumes(1.0, 0.6, 1e4, 1e6, true)),
                                1e-4));
}

Body body_of(const Obb& box) {
    Body body = box_body(glm::dvec3(box.half_extents));
    return moved(body, {glm::dmat3(box.axes), box.center});
}

// Minimal boxes by F for rays and by M for large frusta, against boxes of random orientation around the same
// tetrahedron.
void box_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::vector<glm::dvec3> corners = {{-0.9, -0.2, -0.1}, {1.0, -0.3, 0.0}, {0.1, 0.6, -0.2}, {0.2, 0.1, 0.5}};
    Body object;
    object.corners = corners;
    object.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    for (const auto& f : object.faces)
        object.normals.push_back(
            glm::normalize(glm::cross(corners[f[1]] - corners[f[0]], corners[f[2]] - corners[f[0]])));
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) object.edges.push_back(corners[j] - corners[i]);
    struct Case {
        const char* claim;
        measure::Criterion criterion;
        Body query;
    };
    const Case cases[] = {{"rays: improper tests of the minimal-area box over those of random boxes",
                           measure::minimal_area(), segment_body(60.0)},
                          {"large frusta: improper tests of the minimal-perimeter box over those of random boxes",
                           measure::minimal_perimeter(), frustum_body(1.0, 0.6, 1.0, 60.0, true)}};
    std::uint64_t seed = options.seed * 1000 + 250;
    for (const Case& c : cases) {
        const auto best = fit::fit_obb(corners, {.criterion = c.criterion, .quality = fit::Quality::exact});
        if (!best) {
            rows.push_back(untried_row(c.claim, "theory.md section 3"));
            continue;
        }
        const Body minimal = body_of(*best);
        const sampling::UnitPoints points(seed++);
        sampling::Random random(options.seed, seed);
        Ratio ratio;
        for (std::uint64_t i = 0; i < options.trials; ++i) {
            const Anchored q = anchored(c.query, 3.0, points.at<8>(i));
            const bool hits = meet(q.body, object), inside = hits && !q.body.faces.empty() && holds(q.body, object);
            const auto misled = [&](const Body& bound) {
                return hits ? (inside && !holds(q.body, bound)) : meet(q.body, bound);
            };
            const auto other = fit::fit_oriented(corners, glm::mat3(sampling::rotation(random.point<3>())));
            ratio.add(misled(minimal) ? q.weight : 0.0, misled(body_of(*other)) ? q.weight : 0.0);
        }
        rows.push_back(
            at_most_row(c.claim, "paper, section 3; theory.md section 2", 1.0, ratio.value(), ratio.standard_error()));
    }
}

void common_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    Obb a, b;
    a.half_extents = glm::vec3(1.0f, 0.5f, 0.25f);
    b.half_extents = glm::vec3(0.75f, 0.75f, 0.125f);
    b.center = glm::dvec3(0.5, 0.4, 0.3);
    b.axes = glm::mat3(sampling::rotation({0.3, 0.7, 0.2}));
    const std::vector<study::ConvexBody> bodies = {study::ConvexBody::box(a), study::ConvexBody::box(b),
                                                   study::ConvexBody::sphere(glm::dvec3(-0.3, 0.0, 0.4), 0.6)};
    const double radius = 2.5;
    const sampling::UnitPoints points(options.seed * 1000 + 260);
    std::uint64_t planes = 0, lines = 0;
    const auto box_met = [](const Obb& box, const Line& line) {  // by slabs
        double low = -1e300, high = 1e300;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 axis(box.axes[k]);
            const double at = glm::dot(axis, line.point - box.center), along = glm::dot(axis, line.direction),
                         h = double{box.half_extents[k]};
            const double s = (-h - at) / along, t = (h - at) / along;
            low = std::max(low, std::min(s, t)), high = std::min(high, std::max(s, t));
        }
        return low <= high;
    };
    for (std::uint64_t i = 0; i < options.trials; ++i) {
        const auto u = points.at<4>(i);
        const glm::dvec3 n = sampling::direction({u[0], u[1]});
        const double distance = radius * (2.0 * u[2] - 1.0);
        planes += std::all_of(bodies.begin(), bodies.end(), [&](const study::ConvexBody& k) {
            return -support(k, -n) <= distance && distance <= support(k, n);
        });
        const Line line = sampling::line_through_disc({glm::dvec3(0.0), radius}, u);
        const glm::dvec3 d = bodies[2].points[0] - line.point;
        const bool sphere = glm::length(glm::cross(d, line.direction)) <= bodies[2].radius;
        lines += sphere && box_met(a, line) && box_met(b, line);
    }
    const auto row = [&](const char* claim, const char* source, const study::Enclosure& exact, double all,
                         std::uint64_t hits) {
        const Share share = share_of(hits, options.trials);
        rows.push_back(measured_row(claim, source, exact.value, all * share.value,
                                    std::hypot(all * share.standard_error, exact.error / kMaxZ)));
    };
    row("planes that hit two boxes and a sphere", "theory.md (4)", *measure_of_planes_hitting_all(bodies),
        4.0 * pi * radius, planes);
    row("lines that hit two boxes and a sphere", "theory.md (5)",
        *measure_of_lines_hitting_all(bodies, {.tolerance = 1e-2, .max_cells = 40000}),
        sampling::measure_of_lines(4.0 * pi * radius * radius), lines);
}

// Formula (6) on an L of two triangulations, lighter and heavier.
void triangulation_rows(const VerifyOptions& options, std::vector<VerifyRow>& rows) {
    const std::vector<glm::dvec3> v = {{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {3.0, 1.0, 0.0},
                                       {1.0, 1.0, 0.0}, {1.0, 4.0, 0.0}, {0.0, 4.0, 0.0}};
    using Triangles = std::vector<std::array<std::size_t, 3>>;
    const Triangles light = {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}},
                    heavy = {{0, 1, 3}, {1, 2, 3}, {0, 4, 5}, {0, 3, 4}};
    const double boundary = 14.0, area = 6.0;
    struct Lens {
        const char* name;
        bool perspective;
        double tan_x, tan_y, near, far;
    };
    const Lens lenses[] = {{"perspective", true, 1.0, 0.6, 0.1, 6.0}, {"orthographic", false, 2.0, 1.2, 0.0, 6.0}};
    std::uint64_t seed = options.seed * 1000 + 270;
    for (const Lens& lens : lenses)
        for (const bool heavier : {false, true}) {
            const Triangles& triangles = heavier ? heavy : light;
            // Diagonals: 1–3 and 0–3 in both; 3–5 or 0–4.
            const double weight = glm::length(v[1] - v[3]) + glm::length(v[0] - v[3]) +
                                  (heavier ? glm::length(v[0] - v[4]) : glm::length(v[3] - v[5]));
            std::vector<Body> parts;
            for (const auto& t : triangles) parts.push_back(flat_body({v[t[0]], v[t[1]], v[t[2]]}));
            const Body frustum = frustum_body(lens.tan_x, lens.tan_y, lens.near, lens.far, lens.perspective);
            const IntrinsicVolumes b = frustum_volumes(lens.tan_x, lens.tan_y, lens.near, lens.far, lens.perspective);
            const Placements placements(frustum, flat_body(v));
            const sampling::UnitPoints points(seed++);
            Mean passed;
            for (std::uint64_t i = 0; i < options.trials / 2; ++i) {
                const Body view = moved(frustum, placements.motion(points.at<6>(i)));
                double count = 0.0;
                for (const Body& t : parts) count += meet(view, t);
                passed.add(count);
            }
            const double predicted =
                measure::triangles_met(b, {static_cast<double>(triangles.size()), area, boundary, weight});
            rows.push_back(measured_row(std::string(lens.name) + " frusta: triangles passed, " +
                                            (heavier ? "heavier" : "lighter") + " triangulation of an L",
                                        "theory.md (6)", predicted, placements.measure() * passed.value(),
                                        placements.measure() * passed.standard_error()));
        }
}

}  // namespace

std::vector<VerifyRow> criterion_rows(const VerifyOptions& options) {
    std::vector<VerifyRow> rows;
    ranking_rows(options, rows);
    box_rows(options, rows);
    common_rows(options, rows);
    triangulation_rows(options, rows);
    return rows;
}

}  // namespace crofton::cli
