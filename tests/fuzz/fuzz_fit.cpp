// SPDX-License-Identifier: MIT
// Boxes around few points: they contain them exactly, are the same for any order, and keep to the proven optimum.
#include <algorithm>
#include <crofton/fit/fit.hpp>
#include <oracle/exact_boxes.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

measure::Criterion criterion(fuzz::Shapes& in) {
    const unsigned kind = in.below(4);
    if (kind == 0) return {1.0, 0.0, 0.0};
    if (kind == 1) return {0.0, 1.0, 0.0};
    if (kind == 2) return {in.byte() / 16.0, in.byte() / 16.0, 1.0};
    return measure::minimal_perimeter();
}

double value_of(const measure::Criterion& criterion, const Obb& box) {
    const glm::dvec3 edges = 2.0 * glm::dvec3(box.half_extents);
    return criterion(edges.x, edges.y, edges.z);
}

bool same(const Obb& a, const Obb& b) {
    return a.center == b.center && a.axes == b.axes && a.half_extents == b.half_extents;
}

void check_points(fuzz::Shapes& in) {
    std::vector<glm::dvec3> points(1 + in.below(24));
    const bool flat = in.below(4) == 0;
    for (glm::dvec3& p : points) p = flat ? in.grid_point() * glm::dvec3(1.0, 1.0, 0.0) : in.point();
    fit::FitOptions options{criterion(in), in.flag() ? fit::Quality::fast : fit::Quality::tight};
    const auto box = fit::fit_obb(std::span<const glm::dvec3>(points), options);
    demand(box.has_value() && validate(*box).has_value(), "a box around points");
    for (const glm::dvec3& p : points) demand(contains(*box, p), "a point outside its box");

    std::vector<glm::dvec3> other(points);
    for (std::size_t i = 1; i < other.size(); ++i) std::swap(other[i], other[in.byte() % (i + 1)]);
    other.push_back(other[in.byte() % other.size()]);
    const auto again = fit::fit_obb(std::span<const glm::dvec3>(other), options);
    demand(again.has_value() && same(*again, *box), "the order of points");

    const auto oriented = fit::fit_oriented(std::span<const glm::dvec3>(points), box->axes);
    if (oriented)
        for (const glm::dvec3& p : points) demand(contains(*oriented, p), "a point outside a turned box");

    fit::ExactOptions exact;
    exact.criterion = options.criterion;
    exact.gap = 1e-3;
    exact.max_cells = 300;
    const auto best = fit::fit_exact(std::span<const glm::dvec3>(points), exact);
    demand(best.has_value(), "the best box");
    for (const glm::dvec3& p : points) demand(contains(best->box, p), "a point outside the best box");
    demand(best->lower_bound <= best->value, "the bound of the best box");
    demand(best->lower_bound <= value_of(options.criterion, *box) * (1.0 + 1e-12),
           "a box better than the proof allows");

    const auto sphere = fit::minimal_sphere(points);
    demand(sphere.has_value(), "the least sphere");
    for (const glm::dvec3& p : points)
        demand(glm::length(p - sphere->center) <= sphere->radius, "a point outside the least sphere");
}

// Does `outer` contain the whole of `inner`, exactly.
bool holds(const Obb& outer, const Obb& inner) {
    return oracle::decide([&]<class Number>() {
        using namespace oracle;
        for (int k = 0; k < 3; ++k) {
            const Vec3<Number> n =
                cross(vector_of<Number>(outer.axes[(k + 1) % 3]), vector_of<Number>(outer.axes[(k + 2) % 3]));
            Number farthest =
                abs(oracle::dot(n, minus(vector_of<Number>(inner.center), vector_of<Number>(outer.center))));
            for (int j = 0; j < 3; ++j)
                farthest +=
                    Number(double(inner.half_extents[j])) * abs(oracle::dot(n, vector_of<Number>(inner.axes[j])));
            const Number reach =
                Number(double(outer.half_extents[k])) * abs(oracle::dot(n, vector_of<Number>(outer.axes[k])));
            if (sgn(Number(farthest - reach)) > 0) return false;
        }
        return true;
    });
}

void check_merge(fuzz::Shapes& in) {
    std::vector<Obb> boxes = in.boxes(6);
    if (boxes.empty()) boxes.push_back(in.box());
    const auto merged = fit::merge(boxes, criterion(in));
    demand(merged.has_value() && validate(*merged).has_value(), "a box around boxes");
    for (const Obb& box : boxes) demand(holds(*merged, box), "a box outside what is around it");
}

void check_plane(fuzz::Shapes& in) {
    std::vector<glm::dvec2> points(1 + in.below(12));
    for (glm::dvec2& p : points) p = {in.coordinate(), in.coordinate()};
    const auto which = in.flag() ? fit::PlanarCriterion::area : fit::PlanarCriterion::perimeter;
    const auto of = [&](double a, double b) { return which == fit::PlanarCriterion::area ? a * b : 2.0 * (a + b); };
    double size = 0.0, least = std::numeric_limits<double>::infinity();
    for (const glm::dvec2& p : points) size = std::max(size, glm::length(p));
    for (const glm::dvec2& p : points)
        for (const glm::dvec2& q : points) {
            if (p == q && points.size() > 1) continue;
            const glm::dvec2 u = p == q ? glm::dvec2(1.0, 0.0) : glm::normalize(q - p), v(-u.y, u.x);
            glm::dvec2 low(1e300), high(-1e300);
            for (const glm::dvec2& r : points) {
                const glm::dvec2 at(glm::dot(r, u), glm::dot(r, v));
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
            least = std::min(least, of(high.x - low.x, high.y - low.y));
        }
    const auto best = fit::minimal_rectangle(points, which);
    demand(best.has_value(), "a rectangle");
    // Some pair of points is a side of the hull, or all points are equal.
    const double value = of(2.0 * best->half_extents.x, 2.0 * best->half_extents.y);
    if (least < 1e300)
        demand(value <= least + 1e-9 * (which == fit::PlanarCriterion::area ? size * size : size),
               "the best rectangle");
    for (const glm::dvec2& p : points) {
        const glm::dvec2 d = p - best->center;
        demand(std::fabs(glm::dot(d, best->axis)) <= best->half_extents.x + 1e-12 * size &&
                   std::fabs(best->axis.x * d.y - best->axis.y * d.x) <= best->half_extents.y + 1e-12 * size,
               "a point outside its rectangle");
    }
    const auto disc = fit::minimal_disc(points);
    demand(disc.has_value(), "a disc");
    for (const glm::dvec2& p : points)
        demand(glm::length(p - disc->center) <= disc->radius + 1e-12 * size, "a point outside its disc");
    const auto triangle = fit::minimal_triangle(points, which);
    demand(triangle.has_value(), "a triangle");
}

}  // namespace

CROFTON_FUZZ(in) {
    const unsigned kind = in.below(4);
    if (kind < 2) check_points(in);
    if (kind == 2) check_merge(in);
    if (kind == 3) check_plane(in);
}
