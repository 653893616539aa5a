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
        const ShapeHandle mesh = make_mesh_shape();
        auto relation = sized<crofton_mesh_relation>();
        relation.meet = 7;
        const crofton_transform scaled{{2, 0, 0, 0, 2, 0, 0, 0, 2}, {0, 0, 0}};
        const auto ask = [&](const crofton_shape* other, const crofton_transform* pose, std::uint32_t which) {
            return crofton_meshes_relate(mesh.get(), other, pose, which, &relation);
        };
        const crofton_transform here = translation(0, 0, 0);
        CHECK(ask(mesh.get(), &scaled, CROFTON_MESHES_MEET) != CROFTON_OK);
        CHECK(ask(mesh.get(), nullptr, CROFTON_MESHES_MEET) == CROFTON_INVALID_ARGUMENT);
        CHECK(ask(nullptr, &here, CROFTON_MESHES_MEET) == CROFTON_BAD_HANDLE);
        CHECK(ask(mesh.get(), &here, 16) == CROFTON_INVALID_ARGUMENT);
        crofton_shape* sphere = nullptr;
        REQUIRE(shape_sphere(1, &sphere) == CROFTON_OK);
        const ShapeHandle no_mesh(sphere);
        CHECK(ask(sphere, &here, CROFTON_MESHES_MEET) == CROFTON_UNSUPPORTED);
        CHECK(crofton_last_error_item() == 1);
        CHECK(crofton_meshes_relate(sphere, mesh.get(), &here, CROFTON_MESHES_MEET, &relation) == CROFTON_UNSUPPORTED);
        CHECK(crofton_last_error_item() == 0);
        CHECK(crofton_meshes_relate(mesh.get(), mesh.get(), &here, CROFTON_MESHES_MEET, nullptr) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(relation.meet == 7);
        relation.size += 8;
        CHECK(ask(mesh.get(), &here, CROFTON_MESHES_MEET) == CROFTON_WRONG_SIZE);
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
        const ShapeHandle a = make_mesh_shape(), b = make_mesh_shape();
        crofton_mesh_relation relation{};
        crofton_transform pose = translation(0.25, 0.25, 0.0);
        constexpr std::uint32_t kBoth = CROFTON_MESHES_MEET | CROFTON_MESHES_DISTANCE;
        REQUIRE(relate(a.get(), b.get(), &pose, kBoth, &relation) == CROFTON_OK);
        CHECK((relation.meet == 1 && relation.distance == 0.0));
        crofton_mesh_contact contacts[2];
        std::size_t count = 0;
        REQUIRE(crofton_meshes_contacts(a.get(), b.get(), &pose, contacts, 2, &count) == CROFTON_OK);
        CHECK(count > 2);
        CHECK((contacts[0].triangles.first < 4 && contacts[0].triangles.second < 4));
        REQUIRE(crofton_meshes_contacts(a.get(), b.get(), &pose, nullptr, 0, &count) == CROFTON_OK);
        CHECK(count > 2);
        pose = translation(3.0, 0.0, 0.0);
        REQUIRE(relate(a.get(), b.get(), &pose, kBoth, &relation) == CROFTON_OK);
        CHECK(relation.meet == 0);
        CHECK(relation.distance == doctest::Approx(2.0));
        CHECK(relation.on_a[0] == doctest::Approx(1.0));
        CHECK(relation.on_b[0] == doctest::Approx(3.0));
        CHECK((relation.depth == 0.0 && relation.containment == CROFTON_CONTAINS_NOTHING));
        // What is not asked is 0.
        REQUIRE(relate(a.get(), b.get(), &pose, 0, &relation) == CROFTON_OK);
        CHECK((relation.distance == 0.0 && relation.on_b[0] == 0.0));
    }
}
