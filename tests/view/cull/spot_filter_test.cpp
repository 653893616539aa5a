// SPDX-License-Identifier: MIT
// A spot light that just reaches a froxel, or just does not: the answer in doubles is right or unknown.
#include <doctest/doctest.h>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <oracle/exact_spot.hpp>

#include "exact/spot.hpp"
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

    TEST_CASE("half a sphere whose flat side is just above a froxel is never taken for one that reaches it") {
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

    TEST_CASE("a light just long enough to pass an edge that runs along its cone, and one just too short") {
        // An edge along (1, 0, 1) is 60 degrees from an axis along (1, 1, 0), exactly: it pierces the cone once.
        sampling::Random random(3);
        const auto whole = [&](double most) { return std::floor(random.uniform(-most, most + 1.0)); };
        int decided = 0, asked = 0;
        for (int trial = 0; asked < 150; ++trial) {
            const int x = int(random.uniform(0.0, 3.0)), y = (x + 1) % 3, z = (x + 2) % 3;
            Frustum cell;
            cell.plane_count = 6;
            for (std::uint32_t i = 0; i < 6; ++i) {
                glm::dvec3 normal(0.0);
                normal[x] = i < 2 ? 0.0 : 1.0;
                normal[y] = i < 2 ? 1.0 : 0.0;
                normal[z] = i < 2 ? 0.0 : i < 4 ? -1.0 : 1.0;
                cell.planes[i] = {i % 2 ? -normal : normal, 0.125 * std::floor(random.uniform(1.0, 17.0))};
            }
            cull::SpotLight spot{.cos_half_angle = 0.5f};
            spot.axis = glm::vec3(0.0f);
            spot.axis[x] = trial & 1 ? 1.0f : -1.0f;
            spot.axis[y] = trial & 2 ? 1.0f : -1.0f;
            for (int k = 0; k < 3; ++k) spot.apex[k] = 0.25 * whole(12.0);
            // Where the edge of a side across y and a side across the others is on the cone: a · p = |a| |p| / 2.
            const Plane &first = cell.planes[trial >> 2 & 1], &second = cell.planes[2 + (trial >> 3 & 3)];
            glm::dvec3 foot = -spot.apex, edge(0.0);
            foot[y] = -first.offset * first.normal[y] - spot.apex[y];
            const double beside = second.offset + glm::dot(second.normal, spot.apex);
            foot[x] = -0.5 * beside * second.normal[x];
            foot[z] = -0.5 * beside * second.normal[z];
            edge[x] = second.normal[z];
            edge[z] = -second.normal[x];
            const glm::dvec3 axis(spot.axis);
            const double b = 2.0 * (glm::dot(axis, edge) * glm::dot(axis, foot)) - glm::dot(edge, foot),
                         c = glm::dot(axis, foot) * glm::dot(axis, foot) - 0.5 * glm::dot(foot, foot);
            if (b == 0.0) continue;
            const glm::dvec3 pierced = foot - c / b * edge;
            bool within = glm::dot(axis, pierced) > 0.0;
            for (const Plane& plane : cell.view())
                within = within && glm::dot(plane.normal, spot.apex + pierced) + plane.offset >= -1e-9;
            if (!within) continue;  // else it may be the first point of the cell that the light reaches
            const double length = glm::length(pierced);
            bool answers[2];
            for (int longer = 0; longer < 2; ++longer) {
                spot.range = float(length * (longer ? 1.0001 : 0.9999));
                answers[longer] = cull::meets(cell, spot);
                CAPTURE(trial);
                REQUIRE(answers[longer] == oracle::meets(cell, spot));
            }
            decided += answers[0] != answers[1];
            ++asked;
        }
        CHECK(decided > 5);
    }
}
