// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/shape.hpp>
#include <crofton/geometry/predicates.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// No vertex is farther along the normal than the one told, within rounding; narrow are faces of hardly any area.
void check_face(const Hull& hull, int f) {
    const auto at = [&](int v) { return glm::dvec3(hull.vertices()[static_cast<std::size_t>(v)]); };
    const glm::dvec3 n = hull.face_normal(f);
    double most = -HUGE_VAL;
    for (std::size_t v = 0; v < hull.vertices().size(); ++v)
        most = std::max(most, glm::dot(n, at(static_cast<int>(v))));
    CHECK(glm::dot(n, at(hull.face_support(f))) >= most - 0x1p-50 * hull.radius());
    const auto loop = hull.face_vertices(f);
    double longest2 = 0.0;
    glm::dvec3 area(0.0);
    for (std::size_t i = 1; i < loop.size(); ++i) {
        area += glm::cross(at(loop[i - 1]) - at(loop[0]), at(loop[i]) - at(loop[0]));
        longest2 = std::max(longest2, glm::dot(at(loop[i]) - at(loop[0]), at(loop[i]) - at(loop[0])));
        longest2 = std::max(longest2, glm::dot(at(loop[i]) - at(loop[i - 1]), at(loop[i]) - at(loop[i - 1])));
    }
    const double width = glm::length(area) / longest2;
    if (width < 0.99e-6 || width > 1.01e-6) CHECK(hull.is_narrow_face(f) == (width < 1e-6));
}

// Every point lies on or below every triangle, exactly; every edge has two triangles; Euler's formula holds.
void check_hull(const Hull& hull, std::span<const glm::vec3> points) {
    const auto v = hull.vertices();
    const auto t = hull.triangles();
    std::set<std::pair<int, int>> sides;
    int outside = 0;
    for (std::size_t i = 0; i < t.size(); i += 3) {
        const glm::dvec3 a(v[t[i]]), b(v[t[i + 1]]), c(v[t[i + 2]]);
        for (const glm::vec3& p : points) outside += orientation(a, b, c, glm::dvec3(p)) < 0;
        for (std::size_t k = 0; k < 3; ++k) sides.insert({t[i + k], t[i + (k + 1) % 3]});
    }
    CHECK(outside == 0);
    CHECK(sides.size() == t.size());
    for (const auto& [from, to] : sides) CHECK(sides.count({to, from}) == 1);
    CHECK(v.size() + t.size() / 3 == t.size() / 2 + 2);
    // Faces, edges and vertices of the merged faces.
    std::set<int> corners;
    for (int f = 0; f < hull.face_count(); ++f) {
        const auto loop = hull.face_vertices(f);
        const auto edges = hull.face_edges(f);
        REQUIRE(edges.size() == loop.size());
        CHECK(loop.size() >= 3);
        check_face(hull, f);
        for (std::size_t k = 0; k < loop.size(); ++k) {
            corners.insert(loop[k]);
            const HullEdge& edge = hull.edges()[edges[k]];
            const int side = edge.faces[0] == f ? 0 : 1;
            CHECK(edge.faces[side] == f);
            CHECK(edge.vertices[side] == loop[k]);
            CHECK(edge.vertices[1 - side] == loop[(k + 1) % loop.size()]);
        }
    }
    CHECK(corners.size() + static_cast<std::size_t>(hull.face_count()) == hull.edges().size() + 2);
}

}  // namespace

TEST_SUITE("convex/hull") {
    TEST_CASE("bad points and options are named errors") {
        std::vector<glm::vec3> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        CHECK(error_of(Hull::build(p)).code == ErrorCode::empty);
        CHECK(error_of(Hull::build({})).code == ErrorCode::empty);
        p.push_back({1, 1, 0});
        CHECK(error_of(Hull::build(p)).code == ErrorCode::degenerate);
        p.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 1});
        CHECK(error_of(Hull::build(p)).code == ErrorCode::non_finite);
        CHECK(error_of(Hull::build(p)).item == 4);
        p[4] = {0, 1e16f, 1};
        CHECK(error_of(Hull::build(p)).code == ErrorCode::out_of_range);
        CHECK(error_of(Hull::build(std::vector<glm::vec3>(100, glm::vec3(1, 2, 3)))).code == ErrorCode::degenerate);
        std::vector<glm::vec3> line;
        for (int i = 0; i < 50; ++i) line.emplace_back(0.1f * static_cast<float>(i));
        CHECK(error_of(Hull::build(line)).code == ErrorCode::degenerate);
        p[4] = {0, 0, 1};
        CHECK(error_of(Hull::build(p, {.max_vertices = 3})).code == ErrorCode::invalid_argument);
        CHECK(error_of(Hull::build(p, {.face_tolerance = 1.0f})).code == ErrorCode::invalid_argument);
        CHECK(Hull::build(p).has_value());
    }

    TEST_CASE("shapes inside out, NaN or without bounds are named errors") {
        CHECK(error_of(Shape::box({1, -1, 1})).item == 1);
        CHECK(error_of(Shape::sphere(-1)).code == ErrorCode::invalid_argument);
        CHECK(error_of(Shape::capsule(std::numeric_limits<float>::infinity(), 1)).code == ErrorCode::non_finite);
        CHECK(error_of(Shape::cone(1, 1e16f)).code == ErrorCode::out_of_range);
        CHECK(error_of(Shape::half_space({{0, 0, 0}, 1})).code == ErrorCode::degenerate);
        CHECK(error_of(Shape::triangle({0, 0, 0}, {NAN, 0, 0}, {0, 1, 0})).item == 1);
        CHECK(error_of(Shape::rounded(Shape::half_space({{0, 1, 0}, 1}).value(), 1)).code == ErrorCode::unsupported);
    }

    TEST_CASE("a cube of 1,000 grid points with duplicates has 8 vertices, 6 faces, 12 edges") {
        std::vector<glm::vec3> p;
        for (int i = 0; i < 1000; ++i) p.emplace_back(i % 10, i / 10 % 10, i / 100);
        p.insert(p.end(), p.begin(), p.begin() + 500);
        const Hull cube = Hull::build(p).value();
        CHECK(cube.vertices().size() == 8);
        CHECK(cube.face_count() == 6);
        CHECK(cube.edges().size() == 12);
        CHECK(cube.max_overshoot() == 0.0);
        CHECK(cube.mass().volume == doctest::Approx(729.0));
        CHECK(cube.mass().center.x == doctest::Approx(4.5));
        CHECK(cube.mass().inertia[0][0] == doctest::Approx(729.0 * 81.0 / 6.0));
        CHECK(cube.mass().inertia[0][1] == doctest::Approx(0.0));
        check_hull(cube, p);
    }

    TEST_CASE("a cube turned at random, rounded to float, keeps six faces") {
        RandomShapes random(3);
        for (int trial = 0; trial < 50; ++trial) {
            const glm::dmat3 r = random.rotation();
            std::vector<glm::vec3> p;
            for (int i = 0; i < 8; ++i) p.emplace_back(r * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
            const Hull cube = Hull::build(p).value();
            CHECK(cube.vertices().size() == 8);
            CHECK(cube.face_count() == 6);
            check_hull(cube, p);
        }
    }

    TEST_CASE("random, thin and nearly flat points: no point outside, no corner lost") {
        RandomShapes random(4);
        for (int trial = 0; trial < 60; ++trial) {
            std::vector<glm::vec3> p = random.points(8 + random.index(120), std::pow(10.0, random.number(-6, 6)));
            if (trial % 3 == 0)
                for (glm::vec3& q : p)
                    q.z = random.index(2) != 0 ? q.x : std::nextafter(q.x, 2e6f);  // off a plane by one ulp
            const auto hull = Hull::build(p);
            REQUIRE(hull.has_value());
            check_hull(*hull, p);
            // Each vertex is a corner: without it the hull does not hold it. Each is one of the points.
            for (const glm::vec3& v : hull->vertices()) CHECK(std::count(p.begin(), p.end(), v) >= 1);
        }
    }

    TEST_CASE("100,000 points on a sphere become 256 vertices that hold them all, and little more") {
        RandomShapes random(5);
        std::vector<glm::vec3> p;
        for (int i = 0; i < 100'000; ++i) p.emplace_back(random.direction());
        const Hull hull = Hull::build(p).value();
        CHECK(hull.vertices().size() <= 256);
        CHECK(hull.vertices().size() >= 200);
        check_hull(hull, std::span(p).first(5000));
        CHECK(hull.max_overshoot() > 0.0);
        CHECK(hull.max_overshoot() < 0.05);
        for (const glm::vec3& v : hull.vertices())
            CHECK(glm::length(glm::dvec3(v)) < 1.0 + hull.max_overshoot() + 1e-6);
        const Hull coarse = Hull::build(p, {.max_vertices = 16}).value();
        CHECK(coarse.vertices().size() <= 16);
        check_hull(coarse, std::span(p).first(5000));
    }

    TEST_CASE("mass of solids of revolution agrees with hulls of many points") {
        const auto near = [](const MassProperties& a, const MassProperties& b) {
            CHECK(a.volume == doctest::Approx(b.volume).epsilon(0.03));
            CHECK(glm::distance(a.center, b.center) < 0.02);
            for (int k = 0; k < 3; ++k) CHECK(a.inertia[k][k] == doctest::Approx(b.inertia[k][k]).epsilon(0.05));
        };
        std::vector<glm::vec3> cylinder, cone{{0, 1, 0}}, capsule;
        for (int i = 0; i < 120; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / 120;
            const glm::dvec3 rim(0.5 * std::cos(angle), 0.0, 0.5 * std::sin(angle));
            cylinder.emplace_back(rim + glm::dvec3(0, 1, 0));
            cylinder.emplace_back(rim - glm::dvec3(0, 1, 0));
            cone.emplace_back(rim - glm::dvec3(0, 1, 0));
        }
        for (int i = 0; i < 24; ++i)
            for (int j = 0; j < 5; ++j)
                for (const double end : {1.0, -1.0}) {
                    const double round = 2.0 * std::numbers::pi * i / 24, up = std::numbers::pi / 2 * j / 5;
                    capsule.emplace_back(0.5 * std::cos(round) * std::cos(up), end * (1.0 + 0.5 * std::sin(up)),
                                         0.5 * std::sin(round) * std::cos(up));
                }
        near(mass_properties(Shape::cylinder(1, 0.5f).value()).value(), Hull::build(cylinder).value().mass());
        near(mass_properties(Shape::cone(1, 0.5f).value()).value(), Hull::build(cone).value().mass());
        near(mass_properties(Shape::capsule(1, 0.5f).value()).value(), Hull::build(capsule).value().mass());
        CHECK(mass_properties(Shape::sphere(2).value()).value().inertia[1][1] ==
              doctest::Approx(0.4 * 4.0 * 32.0 / 3.0 * std::numbers::pi));
    }

    TEST_CASE(
        "no corner of a hull that was replaced is farther out than `max_overshoot`, where a step of float is large") {
        RandomShapes random(6);
        for (int round = 0; round < 40; ++round) {
            const glm::dvec3 middle = (round % 2 != 0 ? 1e6 : 1e3) * random.direction();
            std::vector<glm::vec3> points;
            for (int i = 0; i < 100; ++i) points.emplace_back(middle + 2.0 * random.direction());
            const Hull all = Hull::build(points).value(), few = Hull::build(points, {.max_vertices = 20}).value();
            CHECK(few.max_overshoot() > 0.0);
            const Shape shape = Shape::hull(all);
            for (const glm::vec3& v : few.vertices())
                CHECK(closest_point({shape, at({})}, glm::dvec3(v)).lower <= few.max_overshoot());
        }
    }
}
