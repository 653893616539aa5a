// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/measure/criterion.hpp>
#include <crofton/measure/intrinsic_volumes.hpp>
#include <numbers>

using namespace crofton::measure;
using std::numbers::pi;

TEST_SUITE("measure/improper_tests") {
    TEST_CASE("a bound that is the object misleads nobody, and rays contain nothing") {
        const IntrinsicVolumes box = intrinsic_volumes_of_box(1.0, 2.0, 3.0);
        CHECK(improper_outside(intrinsic_volumes_of_sphere(4.0), box, box) == 0.0);
        CHECK(improper_inside(intrinsic_volumes_of_sphere(4.0), box, box) == 0.0);
        CHECK(improper_inside(intrinsic_volumes_of_segment(100.0), box, IntrinsicVolumes{}) == 0.0);
        CHECK(improper_inside(planar_measures_of_segment(100.0), planar_measures_of_disc(1.0), PlanarMeasures{}) ==
              0.0);
    }

    TEST_CASE("rays of length l around an object: V - V0 + (F - F0) l/4") {
        const IntrinsicVolumes bound = intrinsic_volumes_of_box(2.0, 2.0, 2.0),
                               object = intrinsic_volumes_of_sphere(1.0);
        CHECK(improper_outside(intrinsic_volumes_of_segment(8.0), bound, object) ==
              doctest::Approx(8.0 - 4.0 / 3.0 * pi + 2.0 * (24.0 - 4.0 * pi)));
        CHECK(for_rays(8.0)(bound) - for_rays(8.0)(object) ==
              doctest::Approx(improper_outside(intrinsic_volumes_of_segment(8.0), bound, object)));
    }

    TEST_CASE("a ball that contains concentric balls: the inner measure's first order is the exact one's") {
        // Radius R contains radius r for translations in a ball of radius R - r.
        const double big = 1e4, r = 2.0, r0 = 1.0;
        const double exact =
            4.0 / 3.0 * pi * ((big - r0) * (big - r0) * (big - r0) - (big - r) * (big - r) * (big - r));
        CHECK(improper_inside(intrinsic_volumes_of_sphere(big), intrinsic_volumes_of_sphere(r),
                              intrinsic_volumes_of_sphere(r0)) == doctest::Approx(exact).epsilon(1e-3));
        const double planar = pi * ((big - r0) * (big - r0) - (big - r) * (big - r));
        CHECK(improper_inside(planar_measures_of_disc(big), planar_measures_of_disc(r), planar_measures_of_disc(r0)) ==
              doctest::Approx(planar).epsilon(1e-3));
    }
}
