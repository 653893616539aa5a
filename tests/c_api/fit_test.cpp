// SPDX-License-Identifier: MIT
#include <limits>
#include <numbers>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/fit") {
    TEST_CASE("no points, bad points and bad options are refused") {
        crofton_box box = box_at(1, 2, 3);
        CHECK(crofton_fit_points(nullptr, 0, 0, nullptr, &box) == CROFTON_EMPTY);
        CHECK(crofton_fit_points(nullptr, 4, 0, nullptr, &box) == CROFTON_INVALID_ARGUMENT);
        const float points[] = {0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0};
        CHECK(crofton_fit_points(points, 2, 0, nullptr, &box) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 1);
        crofton_fit_options options{};
        CHECK(crofton_fit_points(points, 1, 0, &options, &box) == CROFTON_WRONG_SIZE);
        options.size = sizeof options;  // all weights zero
        CHECK(crofton_fit_points(points, 1, 0, &options, &box) == CROFTON_INVALID_ARGUMENT);
        options.criterion.area_weight = 1.0;
        options.quality = 3;
        CHECK(crofton_fit_points(points, 1, 0, &options, &box) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_fit_points(points, 1, 0, nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(box.center[0] == 1.0);
        crofton_criterion criterion{};
        CHECK(crofton_criterion_for_rays(-1.0, &criterion) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_criterion_for_frustum(nullptr, &criterion) == CROFTON_INVALID_ARGUMENT);
        crofton_camera camera = crofton_default_camera();
        camera.projection = 7;
        CHECK(crofton_criterion_for_frustum(&camera, &criterion) == CROFTON_INVALID_ARGUMENT);
        CHECK(criterion.volume_weight == 0.0);
        CHECK(crofton_fit_boxes(nullptr, 0, nullptr, &box) != CROFTON_OK);
        crofton_box boxes[2] = {box_at(0, 0, 0), box_at(4, 0, 0)};
        boxes[1].half_extents[0] = -1.0f;
        CHECK(crofton_fit_boxes(boxes, 2, nullptr, &box) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        CHECK(mentions(crofton_last_error(), "crofton_fit_boxes"));
    }

    TEST_CASE("the corners of a box give it back, from floats and doubles") {
        std::vector<float> floats;
        std::vector<double> doubles;
        for (int i = 0; i < 8; ++i)
            for (const int k : {0, 1, 2}) {
                const int value = ((i >> k & 1) != 0 ? 1 : -1) * (k + 1);
                floats.push_back(static_cast<float>(value));
                doubles.push_back(value);
            }
        crofton_fit_options options = crofton_default_fit_options();
        CHECK(options.criterion.mean_curvature_weight == doctest::Approx(1.0 / std::numbers::pi));
        options.quality = CROFTON_FIT_TIGHT;
        for (const bool as_floats : {false, true}) {
            crofton_box box{};
            REQUIRE((as_floats ? crofton_fit_points(floats.data(), 8, 0, &options, &box)
                               : crofton_fit_points(doubles.data(), 8, 1, &options, &box)) == CROFTON_OK);
            CHECK(box.half_extents[0] + box.half_extents[1] + box.half_extents[2] == doctest::Approx(6.0));
        }
    }

    TEST_CASE("criteria are those of the measures") {
        crofton_criterion criterion{};
        REQUIRE(crofton_criterion_for_rays(8.0, &criterion) == CROFTON_OK);
        CHECK(criterion.area_weight == doctest::Approx(2.0));  // length / 4
        crofton_camera camera = crofton_default_camera();
        REQUIRE(crofton_criterion_for_frustum(&camera, &criterion) == CROFTON_OK);
        CHECK(criterion.volume_weight == 1.0);
        CHECK(criterion.mean_curvature_weight > criterion.area_weight);
    }

    TEST_CASE("a box around boxes holds them") {
        const crofton_box boxes[] = {box_at(0, 0, 0), box_at(4, 0, 0)};
        crofton_box merged{};
        REQUIRE(crofton_fit_boxes(boxes, 2, nullptr, &merged) == CROFTON_OK);
        CHECK(merged.center[0] == doctest::Approx(2.0));
        CHECK(merged.half_extents[0] + merged.half_extents[1] + merged.half_extents[2] == doctest::Approx(3.5));
    }
}
