// SPDX-License-Identifier: MIT
// Boxes whose axes are as far from orthonormal as they may be, touching to rounding: the share of the float filters'
// error bounds that is for the axes. And axes that are no numbers.
#include <doctest/doctest.h>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <limits>
#include <vector>

#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

// Every product of two axes is off by ±0.98e-4.
glm::mat3 skewed(std::mt19937_64& random, const glm::dmat3& rotation) {
    glm::dmat3 skew(1.0);
    const auto off = [&] { return random() % 2 ? 0.98e-4 : -0.98e-4; };
    for (int k = 0; k < 3; ++k) skew[k][k] += 0.5 * off();
    for (int i = 0; i < 3; ++i)
        for (int j = i + 1; j < 3; ++j) (random() % 2 ? skew[i][j] : skew[j][i]) += off();
    return glm::mat3(rotation * skew);
}

// A pair that touches, needles and plates among them, moved apart or together by 1e-12 of its size.
std::pair<Obb, Obb> touching_pair(std::mt19937_64& random) {
    Obb a = random_box(random), b = random_box(random);
    const glm::dmat3 frame = glm::mat3_cast(random_rotation(random));
    glm::dmat3 other = glm::mat3_cast(random_rotation(random));
    if (random() % 2) {
        const double angle = std::pow(10.0, -double(random() % 7));
        other = glm::dmat3(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(random_vector(random))))) * frame;
    }
    a.axes = skewed(random, frame);
    b.axes = skewed(random, other);
    for (int k = 0; k < 3; ++k) {
        if (random() % 2) a.half_extents[k] *= random() % 3 ? 0.01f : 0.0f;
        if (random() % 2) b.half_extents[k] *= random() % 3 ? 0.01f : 0.0f;
    }
    a.center = glm::dvec3(0.0);
    const glm::dvec3 direction = glm::normalize(random_vector(random));
    b.center = touching_distance(a, b, direction) * (random() % 2 ? 1.0 + 1e-12 : 1.0 - 1e-12) * direction;
    return {a, b};
}

}  // namespace

TEST_SUITE("collide/skewed boxes") {
    TEST_CASE("200,000 touching pairs of skewed boxes: float filters answer as double and exact arithmetic do") {
        std::mt19937_64 random(61);
        std::vector<Obb> a, b;
        std::vector<std::uint8_t> expected;
        while (a.size() < 200000) {
            const auto [first, second] = touching_pair(random);
            // Separated by 0 along every axis that counts, or far away along a direction that hardly leads apart.
            if (!(glm::length(second.center) < 1e3) || !validate(first) || !validate(second)) continue;
            a.push_back(first);
            b.push_back(second);
            // With an axis to begin with, floats are not asked.
            expected.push_back(separating_axis(first, second, 0) == kNotSeparated);
        }
        std::size_t wrong = 0, hits = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            wrong += intersects(a[i], b[i]) != (expected[i] != 0);
            wrong += (separating_axis(a[i], b[i]) == kNotSeparated) != (expected[i] != 0);
            hits += expected[i];
        }
        CHECK(wrong == 0);
        CHECK(hits > 50000);
        CHECK(hits < 150000);
        std::vector<std::uint8_t> from_batch(a.size());
        (void)intersects(a, b, from_batch);
        CHECK(from_batch == expected);
    }

    TEST_CASE("needles whose thin axes lean on the long one meet specks at their tips, where the filter is off most") {
        std::vector<Obb> a, b;
        for (int axis = 0; axis < 3; ++axis)
            for (const float lean : {-0.98e-4f, 0.98e-4f})
                for (const double tip : {-0.999, 0.999})
                    for (const float turn : {-1.0f, 1.0f}) {
                        const int second = (axis + 1) % 3, third = (axis + 2) % 3;
                        Obb needle{}, speck{};
                        needle.axes = glm::mat3(0.0f);
                        needle.axes[0][axis] = 1.0f;
                        needle.axes[1][second] = needle.axes[2][third] = 1.0f;
                        needle.axes[1][axis] = needle.axes[2][axis] = lean;
                        needle.half_extents = {1.0f, 0.0f, 0.0f};
                        // Along the cross product of both first axes the needle is as wide as its thin axes lean.
                        speck.axes = glm::mat3(0.0f);
                        const float diagonal = std::sqrt(0.5f);
                        speck.axes[0][second] = -turn * diagonal;
                        speck.axes[0][third] = diagonal;
                        speck.axes[1][axis] = 1.0f;
                        speck.axes[2][second] = diagonal;
                        speck.axes[2][third] = turn * diagonal;
                        speck.half_extents = glm::vec3(1e-7f);
                        speck.center[axis] = tip;
                        REQUIRE(validate(needle));
                        REQUIRE(separating_axis(needle, speck, 0) == kNotSeparated);
                        a.insert(a.end(), {needle, speck});
                        b.insert(b.end(), {speck, needle});
                    }
        std::vector<std::uint8_t> hits(a.size());
        (void)intersects(a, b, hits);
        CHECK(hits == std::vector<std::uint8_t>(a.size(), 1));
    }

    TEST_CASE("one axis component that is not finite, whichever it is, and a pair that would overlap does not meet") {
        std::mt19937_64 random(62);
        std::vector<Obb> a, b;
        std::vector<std::uint8_t> expected;
        const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             -std::numeric_limits<float>::infinity()};
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                for (const float number : bad)
                    for (const bool upright : {false, true})
                        for (const bool first : {false, true}) {
                            Obb box = random_box(random), other = random_box(random);
                            if (upright) box.axes = other.axes = glm::mat3(1.0f);
                            other.center = box.center;
                            a.push_back(box);
                            b.push_back(other);
                            (first ? a : b).back().axes[k][j] = number;
                            // A sound neighbour in every second lane.
                            a.push_back(box);
                            b.push_back(other);
                            expected.insert(expected.end(), {0, 1});
                        }
        std::vector<std::uint8_t> hits(a.size());
        (void)intersects(a, b, hits);
        CHECK(hits == expected);
    }

    TEST_CASE(
        "walls without width, one on the other, touch from end to end though rounding moves a corner off the wall") {
        // The walls lie in the plane of their first and third axes, and are as long and as high as said. In the
        // manifold a corner's place across the wall, 0, comes out as 1.07 to 1.1 units of 2^-53 of the pair's size.
        // Found by a search around axes whose products with the corners are just above powers of two.
        struct Walls {
            glm::mat3 axes;
            float length;
            float half_height[2];
            double along;
        };
        const Walls all[] = {
            {{0x1.fe6e6cp-2f, 0x1.fddd1p-2f, -0x1.6b5a9cp-1f, 0x1.00e078p-1f, 0x1.00f9e2p-1f, 0x1.68b942p-1f,
              0x1.69fa7ep-1f, -0x1.6a1baap-1f, 0x1.890e7p-12f},
             0x1.0399eap+0f,
             {0x1.a8b7ap-11f, 0x1.cae90cp-8f},
             0x1.05dp+0},
            {{0x1.002fcp-1f, 0x1.000bp-1f, -0x1.69e0ep-1f, 0x1.0079bcp-1f, 0x1.fe974ep-2f, 0x1.6a3316p-1f,
              0x1.699216p-1f, -0x1.6a819ap-1f, -0x1.0979d8p-10f},
             0x1.015e34p+0f,
             {0x1.f0f67p-10f, 0x1.83c264p-8f},
             0x1.038p+0},
            {{0x1.005186p-1f, 0x1.fd5ea2p-2f, -0x1.6ac1dep-1f, 0x1.ff127p-2f, 0x1.017882p-1f, 0x1.6952a4p-1f,
              0x1.6a28bcp-1f, -0x1.69f0f4p-1f, 0x1.c8aef4p-9f},
             0x1.01d294p+0f,
             {0x1.d57e04p-9f, 0x1.1540fep-8f},
             0x1.044p+0},
            {{0x1.fd32a6p-2f, 0x1.012a98p-1f, -0x1.6a3bb2p-1f, 0x1.012346p-1f, 0x1.fe3d7ap-2f, 0x1.69da7ap-1f,
              0x1.6a3b8ap-1f, -0x1.69d876p-1f, -0x1.25772ep-8f},
             0x1.01573p+0f,
             {0x1.ad5ce8p-9f, 0x1.29518cp-8f},
             0x1.03p+0},
            {{0x1.010fd8p-1f, 0x1.fda31p-2f, -0x1.6a2764p-1f, 0x1.0054eep-1f, 0x1.ff9dccp-2f, 0x1.69f082p-1f,
              0x1.691074p-1f, -0x1.6b053cp-1f, 0x1.b873c6p-10f},
             0x1.03b624p+0f,
             {0x1.76e1f4p-9f, 0x1.448f06p-8f},
             0x1.062p+0},
        };
        for (const Walls& walls : all) {
            const glm::dmat3 axes(walls.axes);
            Obb low{}, high{};
            low.axes = high.axes = walls.axes;
            low.half_extents = {0.02f, 0.0f, walls.half_height[0]};
            high.half_extents = {walls.length, 0.0f, walls.half_height[1]};
            // Exact: few bits of either.
            high.center =
                walls.along * axes[0] + (double(walls.half_height[0]) + double(walls.half_height[1])) * axes[2];
            REQUIRE(intersects(low, high));
            const Manifold manifold = contact_manifold(low, high);
            REQUIRE(manifold.count == 2);
            for (const double end : {double(low.half_extents.x), walls.along - double(walls.length)}) {
                const glm::dvec3 there = end * axes[0] + double(walls.half_height[0]) * axes[2];
                const double nearest = std::min(glm::length(manifold.points[0].position - there),
                                                glm::length(manifold.points[1].position - there));
                CHECK(nearest < 1e-12);
            }
        }
    }
}
