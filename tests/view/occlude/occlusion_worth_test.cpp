// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/geometry/box.hpp>
#include <crofton/occlude/occluder.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "shape/collide/random_boxes.hpp"

using namespace crofton;
using namespace crofton::occlude;
using namespace crofton::testing;

namespace {

Obb unit_box() {
    Obb box;
    box.half_extents = glm::vec3(1);
    return box;
}

std::vector<glm::dvec3> corners_of(const Obb& box) {
    const auto corner = corners(box);
    return {corner.begin(), corner.end()};
}

// Whether p = eye + s (k − eye) for a point k of the axis-aligned box and some s in [1, most].
bool is_in_shadow(const glm::dvec3& p, const glm::dvec3& eye, const Obb& box, double most) {
    double low = 1.0 / most, high = 1.0;  // of 1 / s
    for (int k = 0; k < 3; ++k) {
        const double d = p[k] - eye[k], center = box.center[k] - eye[k], half = double(box.half_extents[k]);
        if (d == 0.0) {
            if (std::abs(center) > half) return false;
            continue;
        }
        const double a = (center - half) / d, b = (center + half) / d;
        low = std::max(low, std::min(a, b));
        high = std::min(high, std::max(a, b));
    }
    return low <= high;
}

}  // namespace

TEST_SUITE("occlude/occlusion_worth") {
    TEST_CASE("bad scenes and points are named") {
        const auto points = corners_of(unit_box());
        SeenScene scene;
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::invalid_argument);  // no eyes
        scene.eyes = {glm::dvec3(-1), glm::dvec3(std::numeric_limits<double>::infinity())};
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::invalid_argument);
        scene.eyes = {glm::dvec3(-1), glm::dvec3(1)};
        CHECK(error_of(occlusion_worth({}, scene)).code == ErrorCode::empty);
        scene.samples = 0;
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::out_of_range);
        scene.samples = 8;
        scene.range = 0.0;
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::out_of_range);
        scene.range = std::numeric_limits<double>::infinity();
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::out_of_range);
        scene.range = 10.0;
        scene.object.mean_curvature = std::numeric_limits<double>::infinity();
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::out_of_range);
        scene.object.mean_curvature = std::numeric_limits<double>::quiet_NaN();
        CHECK(error_of(occlusion_worth(points, scene)).code == ErrorCode::out_of_range);
    }

    TEST_CASE("the shadow of points from one eye is the pyramid behind a square, cut at the range") {
        const std::vector<glm::dvec3> square{{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}};
        SeenScene scene;
        scene.eyes = {glm::dvec3(0), glm::dvec3(0)};
        scene.range = 5.0 * std::sqrt(6.0);  // five times as far as the corners
        const auto worth = occlusion_worth(square, scene);
        REQUIRE(worth.has_value());
        CHECK(*worth == doctest::Approx(4.0 * 2.0 / 3.0 * (125.0 - 1.0)));
        scene.range = 2.0;  // nothing lies behind
        CHECK(*occlusion_worth(square, scene) == 0.0);
        scene.range = 20.0;
        scene.eyes = {glm::dvec3(5, 5, -2), glm::dvec3(5, 5, -2)};  // in its plane
        CHECK(*occlusion_worth(square, scene) == doctest::Approx(0.0));
        const std::vector<glm::dvec3> eye{{5, 5, -2}};  // which has no direction from itself
        CHECK(*occlusion_worth(eye, scene) == 0.0);
    }

    TEST_CASE("an eye inside the body sees nothing hidden") {
        SeenScene scene;
        scene.eyes = {glm::dvec3(-0.9), glm::dvec3(0.9)};
        CHECK(*occlusion_worth(corners_of(unit_box()), scene) == 0.0);
        scene.eyes = {glm::dvec3(1.1), glm::dvec3(1.2)};
        CHECK(*occlusion_worth(corners_of(unit_box()), scene) > 0.0);
    }

    TEST_CASE("agrees with random eyes and random boxes behind, to a few per cent") {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> unit;
        for (const double size : {0.02, 0.1, 0.25}) {
            Obb wall;
            wall.center = {0, 0, -8};
            wall.half_extents = glm::vec3(4, 3, 1);
            SeenScene scene;
            scene.eyes = {glm::dvec3(-3, -1, -1), glm::dvec3(3, 1, 2)};
            scene.range = 40.0;
            scene.object = measure::intrinsic_volumes_of_box(2 * size, 3 * size, 4 * size);
            scene.samples = 256;
            const auto worth = occlusion_worth(corners_of(wall), scene);
            REQUIRE(worth.has_value());
            const glm::dvec3 low(-40, -40, -45), high(40, 40, 5);
            const double volume = (high.x - low.x) * (high.y - low.y) * (high.z - low.z);
            int hidden = 0;
            constexpr int kTrials = 400'000;
            for (int i = 0; i < kTrials; ++i) {
                const glm::dvec3 at(unit(random), unit(random), unit(random));
                const glm::dvec3 eye = scene.eyes.min + at * (scene.eyes.max - scene.eyes.min);
                double farthest = 0.0;
                for (const glm::dvec3& p : corners(wall)) farthest = std::max(farthest, glm::distance(p, eye));
                Obb object;
                object.center = low + glm::dvec3(unit(random), unit(random), unit(random)) * (high - low);
                object.axes = glm::mat3(glm::mat3_cast(random_rotation(random)));
                object.half_extents = glm::vec3(glm::dvec3(1.0, 1.5, 2.0) * size);
                const auto corner = corners(object);
                hidden += std::all_of(corner.begin(), corner.end(), [&](const glm::dvec3& p) {
                    return is_in_shadow(p, eye, wall, scene.range / farthest);
                });
            }
            const double share = double(hidden) / kTrials, sampled = share * volume;
            const double sigma = volume * std::sqrt(share * (1.0 - share) / kTrials);
            CAPTURE(size);
            CAPTURE(sampled);
            CAPTURE(*worth);
            // Left out: terms of second order, about twice the square of size over the shadow's width.
            CHECK(std::abs(*worth - sampled) < 4.0 * sigma + 0.01 * sampled + 2.0 * size * size * sampled);
        }
    }

    TEST_CASE("a wall across the street is worth more than the same wall edge on, or far away") {
        SeenScene scene;
        scene.eyes = {glm::dvec3(-1), glm::dvec3(1)};
        scene.object = measure::intrinsic_volumes_of_box(1, 1, 1);
        Obb across, edge_on, far_away;
        across.center = edge_on.center = {0, 0, -20};
        far_away.center = {0, 0, -60};
        across.half_extents = far_away.half_extents = glm::vec3(8, 6, 0.2);
        edge_on.half_extents = glm::vec3(0.2, 6, 8);
        const double best = *occlusion_worth(corners_of(across), scene);
        CHECK(best > 2.0 * *occlusion_worth(corners_of(edge_on), scene));
        CHECK(best > 2.0 * *occlusion_worth(corners_of(far_away), scene));
    }
}
