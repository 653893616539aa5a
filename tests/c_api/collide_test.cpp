// SPDX-License-Identifier: MIT
#include <cmath>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/collide") {
    TEST_CASE("null pointers, bad boxes and bad poses are refused") {
        const crofton_box good = box_at(0, 0, 0);
        crofton_box bad = good;
        bad.half_extents[1] = -1.0f;
        int meet = 7;
        CHECK(crofton_boxes_meet(&good, nullptr, &meet) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_boxes_meet(&good, &bad, &meet) != CROFTON_OK);
        CHECK(crofton_last_error_item() == 1);
        CHECK(meet == 7);
        const Collider collider = make_collider();
        const crofton_transform scaled{{2, 0, 0, 0, 2, 0, 0, 0, 2}, {0, 0, 0}};
        CHECK(crofton_colliders_meet(collider.get(), collider.get(), &scaled, &meet) != CROFTON_OK);
        CHECK(crofton_colliders_meet(collider.get(), collider.get(), nullptr, &meet) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_colliders_meet(collider.get(), nullptr, &scaled, &meet) == CROFTON_BAD_HANDLE);
        const Broadphase broadphase = make_broadphase();
        CHECK(crofton_broadphase_update(broadphase.get(), nullptr, nullptr, 2, nullptr) == CROFTON_INVALID_ARGUMENT);
        const crofton_pair* pairs = nullptr;
        std::size_t count = 0;
        CHECK(crofton_broadphase_pairs(broadphase.get(), 9, &pairs, &count) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("boxes that touch meet") {
        const crofton_box a = box_at(0, 0, 0), b = box_at(1, 0, 0);
        crofton_box c = b;
        c.center[0] = std::nextafter(1.0, 2.0);
        int meet = -1;
        REQUIRE(crofton_boxes_meet(&a, &b, &meet) == CROFTON_OK);
        CHECK(meet == 1);
        REQUIRE(crofton_boxes_meet(&a, &c, &meet) == CROFTON_OK);
        CHECK(meet == 0);
    }

    TEST_CASE("pairs begin, stay and end, filters keep layers apart") {
        const Broadphase broadphase = make_broadphase();
        std::vector<crofton_box> boxes{box_at(0, 0, 0), box_at(0.5, 0, 0), box_at(10, 0, 0)};
        const std::vector<crofton_filter> filters{{1, 1}, {2, 2}, {1, 1}};
        const auto count_of = [&](crofton_pairs which) {
            const crofton_pair* pairs = nullptr;
            std::size_t count = 99;
            REQUIRE(crofton_broadphase_pairs(broadphase.get(), which, &pairs, &count) == CROFTON_OK);
            return count;
        };
        REQUIRE(crofton_broadphase_update(broadphase.get(), boxes.data(), filters.data(), 3, nullptr) == CROFTON_OK);
        CHECK(count_of(CROFTON_PAIRS_ALL) == 0);
        REQUIRE(crofton_broadphase_update(broadphase.get(), boxes.data(), nullptr, 3, nullptr) == CROFTON_OK);
        CHECK(count_of(CROFTON_PAIRS_BEGAN) == 1);
        boxes[2] = box_at(0.5, 0.5, 0);
        REQUIRE(crofton_broadphase_update(broadphase.get(), boxes.data(), nullptr, 3, nullptr) == CROFTON_OK);
        CHECK(count_of(CROFTON_PAIRS_ALL) == 3);
        CHECK(count_of(CROFTON_PAIRS_STAYED) == 1);
        CHECK(count_of(CROFTON_PAIRS_BEGAN) == 2);
        boxes[0] = box_at(-9, 0, 0);
        REQUIRE(crofton_broadphase_update(broadphase.get(), boxes.data(), nullptr, 3, nullptr) == CROFTON_OK);
        CHECK(count_of(CROFTON_PAIRS_ENDED) == 2);
        auto statistics = sized<crofton_broadphase_statistics>();
        REQUIRE(crofton_broadphase_get_statistics(broadphase.get(), &statistics) == CROFTON_OK);
        CHECK(statistics.box_pairs == 1);
    }

    TEST_CASE("meshes meet, and their distance is that of their nearest points") {
        const Collider a = make_collider(), b = make_collider();
        int meet = -1;
        crofton_transform pose = translation(0.25, 0.25, 0.0);
        REQUIRE(crofton_colliders_meet(a.get(), b.get(), &pose, &meet) == CROFTON_OK);
        CHECK(meet == 1);
        crofton_pair pairs[2];
        std::size_t count = 0;
        REQUIRE(crofton_colliders_triangle_pairs(a.get(), b.get(), &pose, pairs, 2, &count) == CROFTON_OK);
        CHECK(count > 2);
        REQUIRE(crofton_colliders_triangle_pairs(a.get(), b.get(), &pose, nullptr, 0, &count) == CROFTON_OK);
        CHECK(count > 2);
        pose = translation(3.0, 0.0, 0.0);
        REQUIRE(crofton_colliders_meet(a.get(), b.get(), &pose, &meet) == CROFTON_OK);
        CHECK(meet == 0);
        double distance = -1.0, on_a[3] = {}, on_b[3] = {};
        REQUIRE(crofton_colliders_distance(a.get(), b.get(), &pose, &distance, on_a, on_b) == CROFTON_OK);
        CHECK(distance == doctest::Approx(2.0));
        CHECK(on_a[0] == doctest::Approx(1.0));
        CHECK(on_b[0] == doctest::Approx(3.0));
        REQUIRE(crofton_colliders_distance(a.get(), b.get(), &pose, &distance, nullptr, nullptr) == CROFTON_OK);
    }
}
