// SPDX-License-Identifier: MIT
// What is wrong or extreme, shape by shape: a named error, or an answer that is right.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <error_of.hpp>
#include <limits>
#include <numbers>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kNoEnd = std::numeric_limits<float>::infinity();
}  // namespace

TEST_SUITE("convex/bad input") {
    TEST_CASE("hulls: too few points, coplanar, collinear, one point many times, NaN, infinite, too far") {
        const auto code = [](const std::vector<glm::vec3>& points) { return error_of(Hull::build(points)).code; };
        CHECK(code({}) == ErrorCode::empty);
        CHECK(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) == ErrorCode::empty);
        std::vector<glm::vec3> plane = {{0, 0, 0.5f}, {1, 0, 0.5f}, {0, 1, 0.5f}, {1, 1, 0.5f}, {3, 5, 0.5f}};
        CHECK(code(plane) == ErrorCode::degenerate);
        plane[3].z = std::nextafter(0.5f, 1.0f);  // the least step out of it makes a hull
        CHECK(Hull::build(plane).has_value());
        CHECK(code({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}) == ErrorCode::degenerate);
        CHECK(code(std::vector<glm::vec3>(100, {1, 2, 3})) == ErrorCode::degenerate);
        std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        REQUIRE(Hull::build(points).has_value());
        for (const float bad : {kNaN, kNoEnd, -kNoEnd, 2e15f}) {
            points[2].y = bad;
            CHECK(error_of(Hull::build(points)).item == 2);
        }
    }

    TEST_CASE("a hundred thousand points, each twice: the hull of the corners") {
        RandomShapes random(1);
        std::vector<glm::vec3> points;
        for (int i = 0; i < 50'000; ++i) points.emplace_back(0.9 * random.number(0.0, 1.0) * random.direction());
        for (int i = 0; i < 8; ++i)
            points.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
        const std::vector<glm::vec3> once = points;
        points.insert(points.end(), once.begin(), once.end());
        const Hull hull = Hull::build(points).value();
        CHECK(hull.vertices().size() == 8);
        CHECK(hull.face_count() == 6);
        CHECK(hull.max_overshoot() == 0.0);
        CHECK(hull.mass().volume == doctest::Approx(8.0));
    }

    TEST_CASE("lengths that are negative, NaN or infinite name themselves, whichever shape") {
        for (const float bad : {-1.0f, kNaN, kNoEnd, 2e15f}) {
            CHECK_FALSE(Shape::sphere(bad).has_value());
            CHECK_FALSE(Shape::capsule(bad, 1).has_value());
            CHECK_FALSE(Shape::capsule(1, bad).has_value());
            CHECK_FALSE(Shape::cylinder(bad, 1).has_value());
            CHECK_FALSE(Shape::cone(1, bad).has_value());
            CHECK(error_of(Shape::box({1, 1, bad})).item == 2);
            CHECK_FALSE(Shape::rounded(Shape::sphere(1).value(), bad).has_value());
        }
        CHECK(error_of(Shape::triangle({0, 0, 0}, {1, kNaN, 0}, {0, 1, 0})).item == 1);
        CHECK_FALSE(Shape::half_space({{0, 0, 0}, 1}).has_value());
        CHECK_FALSE(Shape::rounded(Shape::half_space({{0, 1, 0}, 0}).value(), 1).has_value());
    }

    TEST_CASE("height fields of one row, of no cells, of wrong sizes, of a height that is NaN") {
        const std::vector<float> heights(6, 0.0f);
        CHECK(error_of(HeightField::build({.columns = 6, .rows = 1, .heights = heights})).code ==
              ErrorCode::out_of_range);
        CHECK_FALSE(HeightField::build({.columns = 0, .rows = 0}).has_value());
        CHECK_FALSE(HeightField::build({.columns = 3, .rows = 3, .heights = heights}).has_value());
        std::vector<float> torn = heights;
        torn[4] = kNaN;
        CHECK(error_of(HeightField::build({.columns = 3, .rows = 2, .heights = torn})).item == 4);
        const std::vector<std::uint8_t> holes(2, kHole);
        CHECK_FALSE(HeightField::build({.columns = 3, .rows = 2, .heights = heights, .materials = holes}).has_value());
    }

    TEST_CASE("compounds in compounds: sixteen deep they answer, a thousand deep they are refused at the seventeenth") {
        std::vector<Compound> nested;
        nested.reserve(1000);
        Shape inner = Shape::box({1, 1, 1}).value();
        Error refused{};
        for (int depth = 1; depth <= 1000; ++depth) {
            Result<Compound> made = Compound::build(std::vector<CompoundChild>{{inner, at({1, 0, 0})}});
            if (!made) {
                refused = made.error();
                break;
            }
            nested.push_back(std::move(*made));
            inner = Shape::compound(nested.back());
        }
        CHECK(nested.size() == static_cast<std::size_t>(kMaxCompoundDepth));
        CHECK(refused.code == ErrorCode::out_of_range);
        CHECK(refused.item == 0);
        const Shape sphere = Shape::sphere(0.5f).value();
        CHECK(intersects({inner, at({})}, {sphere, at({17.4, 0, 0})}));
        CHECK_FALSE(intersects({inner, at({})}, {sphere, at({17.6, 0, 0})}));
        CHECK(mass_properties(inner).value().center.x == doctest::Approx(16.0));
    }

    TEST_CASE("spins of many turns: a bar that would be missed by its ends alone is hit at its first touch") {
        // It turns ten times in the second; the wall is within its reach from the start.
        const Shape bar = Shape::box({2, 0.01f, 0.01f}).value(), wall = Shape::box({9, 0.5f, 9}).value();
        const RigidTransform origin = at({}), above = at({0, 1.5, 0});
        const double turns = 10.0 * 2.0 * std::numbers::pi;
        const Impact impact = cast({bar, origin}, {{}, {0, 0, turns}, {}}, {wall, above}, {}).value();
        REQUIRE(impact.result == CastResult::hit);
        // The end's upper corner, at 2.00002 from the axis and atan(0.005) up, reaches y = 1.
        const double angle = std::asin(1.0 / std::hypot(2.0, 0.01)) - std::atan(0.005);
        CHECK(impact.time == doctest::Approx(angle / turns).epsilon(1e-5));
        // With the axis a little farther it never touches, however often it turns.
        const RigidTransform out_of_reach = at({0, 2.6, 0});
        CHECK(cast({bar, origin}, {{}, {0, 0, turns}, {}}, {wall, out_of_reach}, {}).value().result ==
              CastResult::miss);
        CHECK(error_of(cast({bar, origin}, {{}, {0, 0, 2e5}, {}}, {wall, above}, {})).code == ErrorCode::out_of_range);
    }

    TEST_CASE("a cache that names corners which the shapes do not have changes no answer") {
        const Shape box = Shape::box({1, 1, 1}).value(),
                    triangle = Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value();
        for (const double x : {1.5, 0.5, -3.0}) {
            const ShapeAtPose a{box, at({})}, b{triangle, at({x, 0, 0})};
            PairCache lost;
            lost.count = 4;
            std::fill_n(lost.on_a, 4, std::uint16_t{65535});
            std::fill_n(lost.on_b, 4, std::uint16_t{65535});
            PairCache once = lost, twice = lost;
            CHECK(intersects(a, b, &once) == (x == 0.5));
            const double gap = x == 1.5 ? 0.5 : x == 0.5 ? 0.0 : 1.0;
            CHECK(distance(a, b, &twice).distance == doctest::Approx(gap).epsilon(1e-12));
        }
    }

    TEST_CASE("poses that are lost meet nothing, and touch nowhere") {
        const Shape box = Shape::box({1, 1, 1}).value();
        for (const double bad : {std::nan(""), HUGE_VAL}) {
            const RigidTransform lost = at({bad, 0, 0});
            CHECK_FALSE(intersects({box, at({})}, {box, lost}));
            CHECK(contact_manifold({box, at({})}, {box, lost}, {.margin = 1.0}).count == 0);
        }
    }

    TEST_CASE("a pose with one entry that is NaN or infinite meets nothing, wherever the entry is") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const CompoundChild child{box, at({})};
        const Compound compound = Compound::build({&child, 1}).value();
        const Shape shapes[] = {box,
                                Shape::sphere(1).value(),
                                Shape::capsule(1, 0.5f).value(),
                                Shape::cylinder(1, 1).value(),
                                Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value(),
                                Shape::half_space({{0, 1, 0}, 0.5}).value(),
                                Shape::compound(compound)};
        for (const double bad : {std::nan(""), HUGE_VAL})
            for (const Shape& shape : shapes)
                for (int i = 0; i < 12; ++i) {
                    RigidTransform lost = at({0.2, 0.1, 0.0});
                    CHECK(intersects({shape, lost}, {box, at({})}));
                    (i < 9 ? lost.rotation[i / 3][i % 3] : lost.translation[i - 9]) = bad;
                    CHECK_FALSE(intersects({shape, lost}, {box, at({})}));
                    CHECK_FALSE(intersects({box, at({})}, {shape, lost}));
                }
    }
}
