// SPDX-License-Identifier: MIT
// A spot light that just reaches a froxel, or just does not: the answer in doubles is right or unknown.
#include <doctest/doctest.h>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>

#include "lights/spot_filter.hpp"

using namespace crofton;
using cull::Answer;

namespace {

// A spot `gap` from reaching the lower face of a box, with the face's normal inside its cone. The first point that it
// reaches is that of its cap along the normal, in the middle third of the face.
struct SpotBelowBox {
    cull::KernelLight spot{};
    cull::FroxelCell cell{};
};

SpotBelowBox spot_below_box(sampling::Random& random, double gap) {
    SpotBelowBox made;
    const double half_angle = random.uniform(0.05, 1.5), tilt = random.uniform(0.0, 0.95) * half_angle;
    const double turn = random.uniform(0.0, 6.283185307179586), radius = random.uniform(0.5, 20.0);
    made.spot.is_spot = true;
    made.spot.radius = radius;
    made.spot.cosine = std::cos(half_angle);
    made.spot.sine = std::sin(half_angle);
    const glm::dvec3 axis(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
    for (int k = 0; k < 3; ++k) made.spot.axis[k] = axis[k];
    for (int axis_of = 0; axis_of < 2; ++axis_of) {
        const double low = random.uniform(-5.0, 5.0), size = random.uniform(0.3, 6.0);
        made.cell.start[axis_of][0] = low;
        made.cell.start[axis_of][1] = low + size;
        made.spot.at[axis_of] = low + size * random.uniform(0.33, 0.67);
    }
    made.cell.low = 30.0;
    made.cell.high = 30.0 + random.uniform(0.1, 8.0);
    made.spot.at[2] = made.cell.low - radius - gap;
    return made;
}

}  // namespace

TEST_SUITE("cull/spot_filter") {
    TEST_CASE("spots that just reach a froxel are never refused, those that just do not are never taken") {
        sampling::Random random(1);
        // What the corners and the cap's point round to; a gap below it has no known sign.
        constexpr double kRounding = 0x1p-46;
        std::size_t refused = 0, taken = 0, apart = 0, meeting = 0;
        for (const double eta : {1e-12, 1e-9, 1e-6})
            for (const double times : {0.25, 0.99, 1.01, 2.0, 16.0, 1024.0})
                for (int trial = 0; trial < 500; ++trial) {
                    const double gap = times * eta;
                    if (gap < 8.0 * kRounding) continue;
                    const SpotBelowBox miss = spot_below_box(random, gap), hit = spot_below_box(random, -gap);
                    const Answer far = cull::filter_spot(miss.spot, miss.cell, eta);
                    const Answer near = cull::filter_spot(hit.spot, hit.cell, eta);
                    CAPTURE(eta);
                    CAPTURE(times);
                    REQUIRE(far != Answer::yes);
                    REQUIRE(near != Answer::no);
                    // Either is certain only beyond eta.
                    if (times < 1.0) {
                        REQUIRE(far == Answer::unknown);
                        REQUIRE(near == Answer::unknown);
                    }
                    if (times < 2.0) continue;
                    ++apart;
                    ++meeting;
                    refused += far == Answer::no;
                    taken += near == Answer::yes;
                }
        CHECK(refused > apart * 9 / 10);
        CHECK(taken > meeting / 4);
    }

    TEST_CASE("half a ball whose flat side is just above a froxel is never taken for one that reaches it") {
        sampling::Random random(2);
        int refused = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            SpotBelowBox made;
            made.spot.is_spot = true;
            made.spot.radius = random.uniform(0.1, 2.0);
            made.spot.cosine = 0.0;
            made.spot.sine = made.spot.axis[2] = 1.0;
            for (int axis = 0; axis < 2; ++axis) {
                made.cell.start[axis][0] = random.uniform(-1.0, 0.5);
                made.cell.start[axis][1] = made.cell.start[axis][0] + random.uniform(0.1, 1.0);
                made.spot.at[axis] = random.uniform(-1.0, 1.0);
            }
            made.cell.high = random.uniform(-1.0, 1.0);
            made.cell.low = made.cell.high - random.uniform(0.0, 1.0);
            // Their differences nearest to the origin lie in a plane, and so do tetrahedra of them.
            const double gap = std::pow(10.0, random.uniform(-8.0, 0.0));
            made.spot.at[2] = made.cell.high + gap;
            const Answer answer = cull::filter_spot(made.spot, made.cell, 0.04 * gap);
            REQUIRE(answer != Answer::yes);
            refused += answer == Answer::no;
        }
        CHECK(refused > 2900);
    }
}
