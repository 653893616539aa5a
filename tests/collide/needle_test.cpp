// SPDX-License-Identifier: MIT
// Bodies a million times as long as they are wide.
#include <doctest/doctest.h>
#include <crofton/collide/narrow_phase.hpp>

using namespace crofton;
using namespace crofton::collide;

namespace {

Obb shifted(Obb box, const glm::dvec3& motion) {
    box.center += motion;
    return box;
}

}  // namespace

TEST_SUITE("collide/needles") {
    // For such a needle `distance` finds a gap of 0.5 where there is none; the separating axes do not.
    TEST_CASE(
        "a needle of 632,832 by 0.75 by 1 that a box overlaps is hit at once, and from outside before it is reached") {
        Obb needle;
        needle.center = {4.25, -1.7462298274040222e-10, 5.125};
        needle.axes = {{0.470588237f, 0.41522491f, -0.778546691f},
                       {-0.286168516f, 0.906480849f, 0.310483485f},
                       {0.834658206f, 0.0766856819f, 0.54540354f}};
        needle.half_extents = {632832.0f, 0.75f, 1.0f};
        Obb box;
        box.center = {2.5153967513469979, 0.67383012239588425, 1.8703839550144039};
        box.half_extents = {2.375f, 1.75f, 2.75f};
        REQUIRE(collide::intersects(needle, box));
        const ConstantMotion away{{0.875, -6.25, -15.75}, {}, {}};
        const ConvexShape a = to_convex_shape(needle), b = to_convex_shape(box);
        const auto impact = time_of_impact(a, {}, b, away, 2.0, 1e-4);
        REQUIRE(impact);
        CHECK(impact->time == 0.0);
        for (int i = 0; i < 200; ++i) {
            const double back = 0.5 + 0.01 * i;
            const Obb start = shifted(box, back * away.velocity);
            const auto met = time_of_impact(a, {}, to_convex_shape(start), {-away.velocity, {}, {}}, 4.0, 1e-4);
            REQUIRE(met);
            CHECK(met->time <= back);
            for (int k = 0; k < 8; ++k)
                CHECK(penetration(needle, shifted(start, -met->time * k / 8.0 * away.velocity)).depth <= 1e-6);
        }
    }
}
