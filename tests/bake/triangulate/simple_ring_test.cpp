// SPDX-License-Identifier: MIT
// A part of ear clipping: whether a ring touches itself nowhere.
#include <doctest/doctest.h>
#include <array>
#include <ear/simple_ring.hpp>
#include <glm/vec2.hpp>
#include <span>

using namespace crofton;
using namespace crofton::triangulate;

TEST_SUITE("triangulate/simple_ring") {
    TEST_CASE("memory behind the last point is not read, also if boxes are beyond floats") {
        // The fourth point is behind the ring's last; with it, edges would cross.
        const std::array<glm::dvec2, 5> points = {{{-1e50, -1e50}, {1e50, -1e50}, {1e50, 1e50}, {0, -2e50}, {1e50, 0}}};
        SimpleRing ring;
        CHECK(ring.turn_of(std::span(points).first(3)) == 1);
    }
}
