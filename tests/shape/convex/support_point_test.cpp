// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <limits>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

TEST_SUITE("convex/support_point") {
    TEST_CASE("support points do not depend on how long the direction is") {
        const Shape shapes[] = {Shape::sphere(0.5f).value(),
                                Shape::capsule(1, 0.25f).value(),
                                Shape::cylinder(1, 2).value(),
                                Shape::cone(1, 2).value(),
                                Shape::box({1, 2, 3}).value(),
                                Shape::rounded(Shape::box({1, 2, 3}).value(), 0.5f).value(),
                                Shape::rounded(Shape::cylinder(1, 2).value(), 0.5f).value(),
                                Shape::triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).value()};
        for (const Shape& shape : shapes)
            for (const double power : {0x1p-1000, 0x1p-600, 0x1p-400, 0x1p300, 0x1p500, 0x1p600, 0x1p1020})
                for (const glm::dvec3& d : {glm::dvec3(3, 4, 0), {-4, 0, 3}, {1, -2, 2}, {0, -1, 0}, {2, 3, -6}}) {
                    const double error = glm::distance(support_point(shape, power * d), support_point(shape, d));
                    CHECK(error <= 1e-15 * 8);
                }
        CHECK(glm::distance(support_point(shapes[0], {1e-200, 0, 0}), {0.5, 0, 0}) <= 1e-15);
        CHECK(glm::distance(support_point(shapes[0], {0, 1e200, 0}), {0, 0.5, 0}) <= 1e-15);
        CHECK(glm::distance(support_point(shapes[1], {0, 3 * 5e-324, 0}), {0, 1.25, 0}) <= 1e-15);
    }

    TEST_CASE("a direction of length 0 gives a point of the shape") {
        CHECK(glm::length(support_point(Shape::sphere(0.5f).value(), {})) <= 0.5);
        CHECK(glm::distance(support_point(Shape::capsule(1, 0.25f).value(), {}), {0, 1, 0}) <= 2.25);
    }
}
