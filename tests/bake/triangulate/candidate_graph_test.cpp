// SPDX-License-Identifier: MIT
// A part of the search for the minimum weight: which pairs of vertices it considers at all.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/triangulate/triangulate.hpp>
#include <minimum_weight/candidate_graph.hpp>
#include <numbers>
#include <random>
#include <set>
#include <span>
#include <utility>

using namespace crofton;
using namespace crofton::triangulate;

namespace {

// Whether some point lies in the isosceles triangle over the segment from p to q, on its left. `tangent` is that of the
// angles at p and q.
bool has_witness(std::span<const glm::dvec2> points, const glm::dvec2& p, const glm::dvec2& q, double tangent) {
    const glm::dvec2 d = q - p;
    for (const glm::dvec2& y : points) {
        const glm::dvec2 v = y - p;
        const double along = d.x * v.x + d.y * v.y, across = d.x * v.y - d.y * v.x;
        if (across > 0.0 && across < tangent * along && across < tangent * (d.x * d.x + d.y * d.y - along)) return true;
    }
    return false;
}

}  // namespace

TEST_SUITE("triangulate/candidate_graph") {
    TEST_CASE("among random points the candidates are the pairs that pass the diamond test, and few more") {
        std::mt19937_64 random(51);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        Polygon polygon;
        polygon.points = {{-0.1, -0.1}, {1.1, -0.1}, {1.1, 1.1}, {-0.1, 1.1}};
        polygon.ring_ends = {4};
        for (std::uint32_t i = 0; i < 300; ++i) {
            polygon.points.emplace_back(unit(random), unit(random));
            polygon.ring_ends.push_back(5 + i);
        }
        Domain domain;
        REQUIRE(domain.build(polygon).has_value());
        const TriangulateOptions options{.work = TriangulateOptions::kUnlimitedWork};
        Watch watch(options);
        CandidateGraph graph;
        CandidateFinder finder;
        REQUIRE(finder.find(domain, std::size_t{1} << 20, watch, graph));
        const std::span<const glm::dvec2> points = domain.mesh().points;
        std::set<std::pair<Index, Index>> candidates;
        for (Index v = 0; v < points.size(); ++v)
            for (Index h = graph.first[v]; h < graph.first[v + 1]; ++h) candidates.emplace(v, graph.destination[h]);
        const double tangent = std::tan(std::numbers::pi / 4.6);
        std::size_t passing = 0, missing = 0, more = 0;
        for (Index p = 0; p < points.size(); ++p)
            for (Index q = p + 1; q < points.size(); ++q) {
                const bool excluded = has_witness(points, points[p], points[q], tangent) &&
                                      has_witness(points, points[q], points[p], tangent);
                const bool found = candidates.count({p, q}) != 0;
                CHECK(found == (candidates.count({q, p}) != 0));
                passing += !excluded;
                missing += !excluded && !found;
                more += excluded && found;
            }
        CHECK(missing == 0);
        CHECK(more < passing / 20);  // witnesses are sought among the nearest by angle
    }
}
