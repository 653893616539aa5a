// SPDX-License-Identifier: MIT
#include <crofton/geometry/camera.hpp>
#include <limits>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/geometry") {
    TEST_CASE("structs of another size are refused and left alone") {
        crofton_camera camera{};
        camera.size = sizeof camera + 8;
        camera.fov_y = -1.0;
        auto untouched = sized<crofton_frustum>();
        CHECK(crofton_frustum_from_camera(&camera, &untouched) == CROFTON_WRONG_SIZE);
        CHECK(untouched.plane_count == 0);
        camera = crofton_default_camera();
        crofton_frustum frustum{};
        CHECK(crofton_frustum_from_camera(&camera, &frustum) == CROFTON_WRONG_SIZE);
        CHECK(crofton_frustum_from_camera(&camera, nullptr) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("bad cameras, matrices and boxes are named") {
        crofton_camera camera = crofton_default_camera();
        auto frustum = sized<crofton_frustum>();
        camera.fov_y = std::numeric_limits<double>::quiet_NaN();
        CHECK(crofton_frustum_from_camera(&camera, &frustum) != CROFTON_OK);
        camera.fov_y = 1.0;
        camera.projection = 2;
        CHECK(crofton_frustum_from_camera(&camera, &frustum) == CROFTON_INVALID_ARGUMENT);
        const double zero[16] = {};
        CHECK(crofton_frustum_from_matrix(zero, CROFTON_DEPTH_ZERO_TO_ONE, nullptr, &frustum) != CROFTON_OK);
        CHECK(crofton_frustum_from_matrix(nullptr, CROFTON_DEPTH_ZERO_TO_ONE, nullptr, &frustum) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_frustum_from_matrix(zero, 3, nullptr, &frustum) == CROFTON_INVALID_ARGUMENT);
        std::vector<crofton_box> boxes(3, box_at(0, 0, 0));
        boxes[2].center[1] = std::numeric_limits<double>::infinity();
        CHECK(crofton_boxes_validate(boxes.data(), 2) == CROFTON_OK);
        CHECK(crofton_boxes_validate(boxes.data(), 3) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 2);
        CHECK(crofton_boxes_validate(nullptr, 1) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_boxes_validate(nullptr, 0) == CROFTON_OK);
    }

    TEST_CASE("the default camera and its frustum are those of C++") {
        const View view = default_view();
        const auto frustum = crofton::frustum_of(crofton::Camera{});
        REQUIRE(frustum);
        REQUIRE(view.frustum.plane_count == frustum->plane_count);
        for (std::uint32_t i = 0; i < frustum->plane_count; ++i) {
            CHECK(view.frustum.planes[i].offset == frustum->planes[i].offset);
            for (int k = 0; k < 3; ++k) CHECK(view.frustum.planes[i].normal[k] == frustum->planes[i].normal[k]);
        }
    }

    TEST_CASE("a box is moved and turned") {
        // A quarter turn about z, then (10, 0, 0).
        const crofton_transform transform{{0, 1, 0, -1, 0, 0, 0, 0, 1}, {10, 0, 0}};
        crofton_box box = box_at(1, 2, 3), turned{};
        box.half_extents[0] = 2.0f;
        REQUIRE(crofton_box_transform(&transform, &box, &turned) == CROFTON_OK);
        CHECK(turned.center[0] == doctest::Approx(8.0));
        CHECK(turned.center[1] == doctest::Approx(1.0));
        CHECK(turned.center[2] == doctest::Approx(3.0));
        const crofton_transform flat{{0, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        REQUIRE(crofton_box_transform(&flat, &box, &turned) == CROFTON_OK);
        CHECK(*std::min_element(turned.half_extents, turned.half_extents + 3) < 1e-5f);
        const crofton_transform huge{{1e16, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        CHECK(crofton_box_transform(&huge, &box, &turned) != CROFTON_OK);
        CHECK(crofton_box_transform(&transform, nullptr, &turned) == CROFTON_INVALID_ARGUMENT);
    }
}
