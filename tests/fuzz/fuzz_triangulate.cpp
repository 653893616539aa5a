// SPDX-License-Identifier: MIT
// Polygons with a hole, star-shaped or any at all: against the rules of a triangulation and the minimum by brute force.
#include <algorithm>
#include <crofton/triangulate/triangulate.hpp>
#include <oracle/minimum_weight.hpp>
#include <oracle/triangulation_check.hpp>

#include "shapes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

int turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return oracle::decide([&]<class Number>() {
        return sgn(oracle::twice_area<Number>({a.x, a.y}, {b.x, b.y}, {c.x, c.y}));
    });
}
bool between(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return turn(a, b, c) == 0 && std::min(a.x, b.x) <= c.x && c.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= c.y &&
           c.y <= std::max(a.y, b.y);
}
bool touch(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    if (between(a, b, c) || between(a, b, d) || between(c, d, a) || between(c, d, b)) return true;
    return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

// Edges meet in common corners alone, and the hole is inside.
bool is_simple(const Polygon& polygon) {
    struct Edge {
        std::size_t ring, from, to;
    };
    std::vector<Edge> edges;
    for (std::size_t r = 0, first = 0; r < polygon.ring_count(); first = polygon.ring_ends[r++]) {
        const std::size_t count = polygon.ring_ends[r] - first;
        if (count < 3) return false;
        for (std::size_t i = 0; i < count; ++i) edges.push_back({r, first + i, first + (i + 1) % count});
    }
    const auto& p = polygon.points;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Edge& e = edges[i];
        if (p[e.from] == p[e.to]) return false;
        for (std::size_t j = i + 1; j < edges.size(); ++j) {
            const Edge& f = edges[j];
            if (e.to == f.from || f.to == e.from) {
                const std::size_t mid = e.to == f.from ? e.to : e.from, a = e.to == f.from ? e.from : e.to,
                                  b = e.to == f.from ? f.to : f.from;
                if (between(p[mid], p[a], p[b]) || between(p[mid], p[b], p[a])) return false;
            } else if (touch(p[e.from], p[e.to], p[f.from], p[f.to])) {
                return false;
            }
        }
    }
    if (polygon.ring_count() < 2) return true;
    // Nothing touches, so one corner of the hole tells: is it inside?
    const glm::dvec2 c = p[polygon.ring_ends[0]];
    bool inside = false;
    for (const Edge& e : edges) {
        if (e.ring != 0) continue;
        const glm::dvec2 a = p[e.from], b = p[e.to];
        if ((a.y > c.y) != (b.y > c.y) && (turn(a, b, c) > 0) == (b.y > a.y)) inside = !inside;
    }
    return inside;
}

// Around a middle by angle, where asked for: most such rings are simple.
void add_ring(fuzz::Shapes& in, Polygon& polygon, unsigned count, const glm::dvec2& middle, double scale) {
    std::vector<glm::dvec2> ring(count);
    for (glm::dvec2& p : ring) {
        p.x = scale * (in.below(8) ? in.grid() : in.coordinate());
        p.y = scale * in.grid();
    }
    if (in.below(4) != 0)
        std::sort(ring.begin(), ring.end(), [](const glm::dvec2& a, const glm::dvec2& b) {
            const double angle_a = std::atan2(a.y, a.x), angle_b = std::atan2(b.y, b.x);
            return angle_a < angle_b || (angle_a == angle_b && glm::dot(a, a) < glm::dot(b, b));
        });
    for (const glm::dvec2& p : ring) polygon.points.push_back(middle + p);
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
}

}  // namespace

CROFTON_FUZZ(in) {
    Polygon polygon;
    add_ring(in, polygon, 3 + in.below(12), {0.0, 0.0}, 1.0);
    if (in.below(3) == 0) add_ring(in, polygon, in.below(5), glm::dvec2(in.grid_point()) / 8.0, 1.0 / 16.0);
    const bool simple = is_simple(polygon);
    double weights[3] = {};
    bool optimal = false;
    triangulate::Triangulator triangulator;
    for (const auto method :
         {triangulate::Method::ear, triangulate::Method::delaunay, triangulate::Method::minimum_weight}) {
        triangulate::TriangulateOptions options;
        options.method = method;
        options.work = 3'000'000;
        triangulate::Triangulation result;
        const auto done = triangulator.triangulate(polygon, options, result);
        demand(done.has_value() || !simple, "a simple polygon is refused");
        if (!done) {
            demand(result.triangles.empty(), "a refused polygon leaves triangles");
            return;
        }
        const std::string wrong = oracle::decide(
            [&]<class Number>() { return oracle::check_triangulation<Number>(polygon, result.triangles, !simple); });
        demand(wrong.empty(), wrong.c_str());
        if (simple && method == triangulate::Method::delaunay)
            demand(oracle::decide([&]<class Number>() {
                       return oracle::is_constrained_delaunay<Number>(polygon, result.triangles);
                   }),
                   "a diagonal that is not Delaunay");
        weights[static_cast<int>(method)] = result.weight;
        if (method == triangulate::Method::minimum_weight) optimal = result.optimal;
    }
    demand(weights[2] <= weights[0] * (1.0 + 1e-12) && weights[2] <= weights[1] * (1.0 + 1e-12), "the lightest");
    if (simple && optimal && polygon.points.size() <= 12) {
        const auto least = static_cast<double>(oracle::MinimumWeightReference(polygon).solve());
        demand(std::fabs(weights[2] - least) <= 1e-9 * (1.0 + least), "the minimum weight");
    }
}
