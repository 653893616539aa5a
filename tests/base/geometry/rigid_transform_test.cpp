// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/geometry/shapes.hpp>
#include <glm/geometric.hpp>

using namespace crofton;

namespace {

// All numbers are exact: quarter turns, and small integers.
const RigidTransform kOuter{{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, {10, 20, 30}};
const RigidTransform kInner{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {1, 2, 3}};
constexpr glm::dvec3 kPoint(4, 5, 6);

}  // namespace

TEST_SUITE("geometry/rigid_transform") {
    TEST_CASE("a pose turns a point, then moves it") {
        CHECK(transform(kOuter, kPoint) == glm::dvec3(5, 24, 36));
        CHECK(transform(kInner, kPoint) == glm::dvec3(5, -4, 8));
    }

    TEST_CASE("the inner of two poses applies first") {
        CHECK(transform(kOuter * kInner, kPoint) == transform(kOuter, transform(kInner, kPoint)));
        CHECK(transform(kInner * kOuter, kPoint) == transform(kInner, transform(kOuter, kPoint)));
    }

    TEST_CASE("the inverse leads back, and the relative pose from the other's frame to one's own") {
        CHECK(transform(inverse(kOuter), transform(kOuter, kPoint)) == kPoint);
        CHECK(transform(kOuter, transform(relative(kOuter, kInner), kPoint)) == transform(kInner, kPoint));
    }
}
