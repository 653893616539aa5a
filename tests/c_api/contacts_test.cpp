// SPDX-License-Identifier: MIT
#include <cmath>

#include "handles.hpp"

using namespace crofton::capi_test;

TEST_SUITE("capi/contacts") {
    TEST_CASE("bad boxes, structs, handles and poses are refused, and nothing is written") {
        const crofton_box good = box_at(0, 0, 0);
        crofton_box bad = good;
        bad.center[2] = std::nan("");
        auto manifold = sized<crofton_manifold>();
        manifold.point_count = 77;
        CHECK(crofton_boxes_manifold(&good, &bad, &manifold) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 1);
        CHECK(crofton_boxes_manifold(nullptr, &good, &manifold) == CROFTON_INVALID_ARGUMENT);
        manifold.size = 8;
        CHECK(crofton_boxes_manifold(&good, &good, &manifold) == CROFTON_WRONG_SIZE);
        CHECK(manifold.point_count == 77);
        double distance = -7.0;
        CHECK(crofton_boxes_distance(&bad, &good, &distance, nullptr, nullptr) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 0);
        CHECK(crofton_boxes_distance(&good, &good, nullptr, nullptr, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(distance == -7.0);

        const ShapeHandle mesh = make_mesh_shape();
        crofton_transform pose = translation(0, 0, 0);
        size_t count = 77;
        CHECK(crofton_meshes_contacts(mesh.get(), nullptr, &pose, nullptr, 0, &count) == CROFTON_BAD_HANDLE);
        CHECK(crofton_meshes_contacts(mesh.get(), mesh.get(), &pose, nullptr, 3, &count) == CROFTON_INVALID_ARGUMENT);
        pose.translation[0] = std::nan("");
        CHECK(crofton_meshes_contacts(mesh.get(), mesh.get(), &pose, nullptr, 0, &count) == CROFTON_NON_FINITE);
        auto relation = sized<crofton_mesh_relation>();
        relation.containment = 77;
        for (const std::uint32_t which : {CROFTON_MESHES_DEPTH, CROFTON_MESHES_CONTAINMENT})
            CHECK(crofton_meshes_relate(mesh.get(), mesh.get(), &pose, which, &relation) == CROFTON_NON_FINITE);
        CHECK(count == 77);
        CHECK(relation.containment == 77);
    }

    TEST_CASE("a box on a box: four points, the depth, the way out") {
        const crofton_box lower = box_at(0, 0, 0), upper = box_at(0.25, 0, 0.875);
        auto manifold = sized<crofton_manifold>();
        REQUIRE(crofton_boxes_manifold(&lower, &upper, &manifold) == CROFTON_OK);
        CHECK(manifold.point_count == 4);
        CHECK(manifold.depth == doctest::Approx(0.125));
        CHECK(manifold.normal[2] == doctest::Approx(1.0));
        for (uint32_t i = 0; i < manifold.point_count; ++i) {
            CHECK(manifold.points[i].depth == doctest::Approx(0.125));
            CHECK(manifold.points[i].position[0] >= -0.25 - 1e-9);
        }
        const crofton_box apart = box_at(0, 0, 3);
        REQUIRE(crofton_boxes_manifold(&lower, &apart, &manifold) == CROFTON_OK);
        CHECK(manifold.point_count == 0);
        double distance = -1.0, on_a[3], on_b[3];
        REQUIRE(crofton_boxes_distance(&lower, &apart, &distance, on_a, on_b) == CROFTON_OK);
        CHECK(distance == doctest::Approx(2.0));
        CHECK(on_a[2] == doctest::Approx(0.5));
        CHECK(on_b[2] == doctest::Approx(2.5));
        REQUIRE(crofton_boxes_distance(&lower, &upper, &distance, nullptr, nullptr) == CROFTON_OK);
        CHECK(distance == 0.0);
    }

    TEST_CASE("meshes: where they touch, how deep, and one inside the other") {
        const ShapeHandle outer = make_mesh_shape(), inner = make_mesh_shape(0.125f);
        crofton_transform pose = translation(0.5, 0.125, 0.125);
        size_t count = 0;
        crofton_mesh_contact contacts[32];
        REQUIRE(crofton_meshes_contacts(outer.get(), outer.get(), &pose, contacts, 32, &count) == CROFTON_OK);
        REQUIRE(count > 0);
        REQUIRE(count <= 32);
        for (size_t i = 0; i < count; ++i) {
            CHECK(contacts[i].begin[0] >= 0.5 - 1e-9);  // the corner of the moved one is at x = 0.5
            CHECK(contacts[i].begin[0] + contacts[i].begin[1] + contacts[i].begin[2] <= 1.0 + 1e-9);
        }
        crofton_mesh_relation relation{};
        REQUIRE(relate(outer.get(), outer.get(), &pose, CROFTON_MESHES_DEPTH, &relation) == CROFTON_OK);
        const double depth = relation.depth, *const direction = relation.direction;
        CHECK(depth > 0.0);
        CHECK(std::hypot(direction[0], direction[1], direction[2]) == doctest::Approx(1.0));
        for (int k = 0; k < 3; ++k) pose.translation[k] += 1.000001 * depth * direction[k];
        REQUIRE(relate(outer.get(), outer.get(), &pose, CROFTON_MESHES_MEET, &relation) == CROFTON_OK);
        CHECK(relation.meet == 0);

        const auto containment = [&](const ShapeHandle& a, const ShapeHandle& b, const crofton_transform& at) {
            REQUIRE(relate(a.get(), b.get(), &at, CROFTON_MESHES_CONTAINMENT, &relation) == CROFTON_OK);
            return relation.containment;
        };
        CHECK(containment(outer, inner, translation(0.125, 0.125, 0.125)) == CROFTON_B_INSIDE_A);
        CHECK(containment(inner, outer, translation(-0.125, -0.125, -0.125)) == CROFTON_A_INSIDE_B);
        CHECK(containment(outer, inner, translation(5, 0, 0)) == CROFTON_CONTAINS_NOTHING);
    }
}
