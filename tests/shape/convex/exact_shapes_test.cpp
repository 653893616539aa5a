// SPDX-License-Identifier: MIT
// The oracle of `crofton verify collide` and of the tests on triangles, which have no inside.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <verify/exact_shapes.hpp>

using namespace crofton;

namespace {

const RigidTransform kHere;

convex::Shape triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return *convex::Shape::triangle(a, b, c);
}
bool meet(const convex::Shape& a, const convex::Shape& b, const glm::dvec3& point) {
    return oracle::meet_in<oracle::Tracked>({a, kHere}, {b, kHere}, {}, {point});
}

}  // namespace

TEST_SUITE("convex/exact_shapes") {
    TEST_CASE("a point of both triangles' planes is no proof that they meet") {
        const auto low = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const auto beside = triangle({3, 0, -1}, {3, 1, -1}, {3, 0, 1});
        const glm::dvec3 common(3, 5, 0);  // on the line where the planes meet
        CHECK_FALSE(meet(low, beside, common));
        const auto through = triangle({0.25, 0.25, -1}, {0.25, 0.25, 1}, {3, 0.25, 0});
        CHECK(meet(low, through, glm::dvec3(0.25, 0.25, 0)));
    }

    TEST_CASE("triangles of one plane are parted within it, and meet at a corner") {
        const auto low = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const auto meets = [&](float x, float y) {
            const glm::vec3 corner(x, y, 0);
            const auto other = triangle(corner, corner + glm::vec3(1, 0, 0), corner + glm::vec3(1, 1, 0));
            const bool there = cli::meet_exactly({low, kHere}, {other, kHere}, glm::dvec3(1, 0, 0));
            CHECK(cli::meet_exactly({other, kHere}, {low, kHere}, glm::dvec3(1, 0, 0)) == there);
            return there;
        };
        CHECK_FALSE(meets(2, 0));
        CHECK_FALSE(meets(0.5f, 0.5f + 0x1p-20f));
        CHECK(meets(0.5f, 0.5f));
        CHECK(meets(1, 0));
        CHECK_FALSE(meets(-0.5f, 2.0f));
        CHECK_FALSE(meets(-0.5f, -1.75f));
        CHECK(meets(-0.5f, -0.5f));
    }
}
