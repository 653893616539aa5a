// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/measure/measure.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

using namespace crofton::measure;
using std::numbers::pi;

namespace {

IntrinsicVolumes volumes_of(const glm::dvec3& sides) {
    return intrinsic_volumes_of_box(sides.x, sides.y, sides.z);
}

// How many places of a turned box lie in an upright one: for each rotation a box again, of what its widths leave.
struct Containing {
    double object = 0.0, bound = 0.0;
};
Containing mean_containing(const glm::dvec3& query, const glm::dvec3& object, const glm::dvec3& bound) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const auto volume = [&](const glm::dmat3& turn, const glm::dvec3& sides) {
        double result = 1.0;
        for (int j = 0; j < 3; ++j) {
            double width = 0.0;
            for (int k = 0; k < 3; ++k) width += std::fabs(turn[k][j]) * sides[k];
            result *= std::max(0.0, query[j] - width);
        }
        return result;
    };
    constexpr int kTurns = 20000;
    Containing sum;
    for (int i = 0; i < kTurns; ++i) {
        const glm::dquat q(normal(random), normal(random), normal(random), normal(random));
        const glm::dmat3 turn = glm::mat3_cast(glm::normalize(q));
        sum.object += volume(turn, object) / kTurns;
        sum.bound += volume(turn, bound) / kTurns;
    }
    return sum;
}

}  // namespace

TEST_SUITE("measure/improper_tests") {
    TEST_CASE("the inner measure is never less than what is counted, nor more than what contains the object") {
        const glm::dvec3 query(10.0, 8.0, 6.0), object(1.0, 0.6, 0.4), bound(1.3, 0.9, 0.5);
        for (const double size : {0.01, 0.1, 1.0, 3.0, 6.0, 8.0, 12.0}) {
            CAPTURE(size);
            const Containing mean = mean_containing(query, size * object, size * bound);
            const double inside =
                improper_inside(volumes_of(query), volumes_of(size * bound), volumes_of(size * object));
            // Three standard deviations of the mean over rotations are less than 1 %.
            CHECK(inside >= 0.99 * (mean.object - mean.bound));
            CHECK(inside <= volumes_of(query).volume);
            if (size <= 0.1) CHECK(inside <= 1.05 * (mean.object - mean.bound));
        }
        // Bounds as large as the query: no place contains them, and few contain the object.
        const double alike = improper_inside(volumes_of(query), volumes_of(query), volumes_of(0.9 * query));
        CHECK(alike <= 0.0011 * volumes_of(query).volume);
        CHECK(improper_inside(volumes_of(query), volumes_of(2.0 * query), volumes_of(query)) == 0.0);
        const double planar =
            improper_inside(planar_measures_of_disc(10.0), planar_measures_of_disc(10.0), planar_measures_of_disc(9.0));
        CHECK(planar == doctest::Approx(pi));  // the exact value: of a disc's places in a disc
    }

    TEST_CASE("the outer measure of spheres and discs is the difference of two larger ones") {
        const auto sphere = intrinsic_volumes_of_sphere;
        const auto disc = planar_measures_of_disc;
        CHECK(improper_outside(sphere(4.0), sphere(2.0), sphere(1.0)) ==
              doctest::Approx(4.0 / 3.0 * pi * (216.0 - 125.0)));
        CHECK(improper_outside(disc(4.0), disc(2.0), disc(1.0)) == doctest::Approx(pi * (36.0 - 25.0)));
    }

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

    TEST_CASE("a sphere that contains concentric spheres: the inner measure's first order is the exact one's") {
        // Radius R contains radius r for translations in a sphere of radius R - r.
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
