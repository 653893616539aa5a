// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>

#include "handles.hpp"

using namespace crofton::capi_test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

crofton_ray ray(double x, double y, double z, double dx, double dy, double dz, double max_t = kInfinity) {
    return {{x, y, z}, {dx, dy, dz}, max_t};
}

}  // namespace

TEST_SUITE("capi/rays") {
    TEST_CASE("rays that are none are refused, named, and write nothing") {
        const ShapeHandle mesh = make_mesh_shape();
        const crofton_transform here = translation(0, 0, 0);
        const crofton_placed placed{mesh.get(), &here};
        const double nan = std::nan("");
        const crofton_ray good = ray(0.1, 0.1, 5, 0, 0, -1);
        const crofton_ray bad[] = {ray(nan, 0, 0, 0, 0, 1), ray(0, 0, 0, kInfinity, 0, 1), ray(0, 0, 0, 0, 0, 0),
                                   ray(0, 0, 0, 0, 0, 1, -1.0), ray(0, 0, 0, 0, 0, 1, nan)};
        const crofton_status expected[] = {CROFTON_NON_FINITE, CROFTON_NON_FINITE, CROFTON_DEGENERATE,
                                           CROFTON_INVALID_ARGUMENT, CROFTON_INVALID_ARGUMENT};
        for (int i = 0; i < 5; ++i) {
            auto found = sized<crofton_shape_ray_hit>();
            found.t = -7.0;
            CHECK(crofton_shape_raycast(&placed, &bad[i], &found) == expected[i]);
            CHECK(found.t == -7.0);
            int hit = 7;
            CHECK(crofton_shape_raycast_any(&placed, &bad[i], &hit) == expected[i]);
            CHECK(hit == 7);
            const crofton_box box = box_at(0, 0, 0);
            double t = -7.0;
            CHECK(crofton_box_raycast(&box, &bad[i], &t) == expected[i]);
            CHECK(t == -7.0);
        }
        int hit = 7;
        CHECK(crofton_shape_raycast_any(nullptr, &good, &hit) == CROFTON_BAD_HANDLE);
        CHECK(crofton_shape_raycast_any(&placed, nullptr, &hit) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_shape_raycast_any(&placed, &good, nullptr) == CROFTON_INVALID_ARGUMENT);
        CHECK(hit == 7);
    }

    TEST_CASE("a ray enters a box at its face, starts inside it at 0, or misses") {
        const crofton_box box = box_at(0, 0, 0);
        const auto entry = [&](const crofton_ray& r) {
            double t = -1.0;
            REQUIRE(crofton_box_raycast(&box, &r, &t) == CROFTON_OK);
            return t;
        };
        CHECK(entry(ray(0, 0, 5, 0, 0, -2)) == doctest::Approx(2.25));
        CHECK(entry(ray(0, 0, 0.25, 0, 0, -2)) == 0.0);
        CHECK(entry(ray(0, 0, 5, 0, 0, -2, 2.0)) == kInfinity);
        CHECK(entry(ray(0, 0, 5, 0, 0, 1)) == kInfinity);
    }

    TEST_CASE("the nearest triangle of a mesh") {
        const ShapeHandle mesh = make_mesh_shape();
        const crofton_transform here = translation(0, 0, 0);
        const crofton_placed placed{mesh.get(), &here};
        // Its triangle 0 is the right one at z = 0, triangle 3 the slanted one, x + y + z = 1.
        const crofton_ray rays[] = {ray(0.25, 0.25, 5, 0, 0, -1), ray(0.25, 0.25, -5, 0, 0, 1),
                                    ray(0.25, 0.25, 5, 0, 0, -1, 4.0), ray(2, 2, 5, 0, 0, -1)};
        // The second pose turns a full circle by a matrix that is not the identity to the bit.
        crofton_transform turned = here;
        turned.linear[1] = 1e-12;
        turned.linear[3] = -1e-12;
        const crofton_placed other{mesh.get(), &turned};
        for (const crofton_placed& at : {placed, other})
            for (int i = 0; i < 4; ++i) {
                CAPTURE(i);
                auto hit = sized<crofton_shape_ray_hit>();
                REQUIRE(crofton_shape_raycast(&at, &rays[i], &hit) == CROFTON_OK);
                int any = -1;
                REQUIRE(crofton_shape_raycast_any(&at, &rays[i], &any) == CROFTON_OK);
                CHECK(any == (i < 2 ? 1 : 0));
                if (i >= 2) {
                    CHECK(hit.t == kInfinity);
                    continue;
                }
                CHECK(hit.t == doctest::Approx(i == 0 ? 4.5 : 5.0));
                CHECK(hit.part.triangle == (i == 0 ? 3u : 0u));
            }
        // For a one-sided surface and for other shapes, any hit is one of crofton_shape_raycast.
        const Tetrahedron tetrahedron;
        const crofton_mesh source = tetrahedron.mesh();
        crofton_shape* made = nullptr;
        REQUIRE(shape_mesh(&source, 1, &made) == CROFTON_OK);
        const ShapeHandle one_sided(made);
        REQUIRE(shape_sphere(0.5f, &made) == CROFTON_OK);
        const ShapeHandle sphere(made);
        for (const crofton_shape* shape : {one_sided.get(), sphere.get()})
            for (const crofton_ray& r : {ray(0.25, 0.25, 5, 0, 0, -1), ray(0.25, 0.25, 0.25, 0, 0, 1),
                                         ray(0.1, 0.1, 0.1, 0, 0, 1, 0.05), ray(3, 0, 0, 0, 1, 0)}) {
                const crofton_placed at{shape, &here};
                auto hit = sized<crofton_shape_ray_hit>();
                REQUIRE(crofton_shape_raycast(&at, &r, &hit) == CROFTON_OK);
                int any = -1;
                REQUIRE(crofton_shape_raycast_any(&at, &r, &any) == CROFTON_OK);
                CHECK((any == 1) == std::isfinite(hit.t));
            }
    }

    TEST_CASE("whether a ray hits a mesh is the same by both calls, however long its direction and far its origin") {
        const ShapeHandle mesh = make_mesh_shape();
        const crofton_transform here = translation(0, 0, 0);
        const crofton_placed placed{mesh.get(), &here};
        const auto check = [&](const crofton_ray& r, bool expected) {
            auto hit = sized<crofton_shape_ray_hit>();
            REQUIRE(crofton_shape_raycast(&placed, &r, &hit) == CROFTON_OK);
            CHECK(std::isfinite(hit.t) == expected);
            int any = -1;
            REQUIRE(crofton_shape_raycast_any(&placed, &r, &any) == CROFTON_OK);
            CHECK((any == 1) == expected);
        };
        for (int exponent = -530; exponent <= 1020; exponent += 10) {
            CAPTURE(exponent);
            const double length = std::scalbn(1.0, exponent);
            for (const double max_t : {kInfinity, 8.0 / length, 3.0 / length}) {
                check(ray(0.25, 0.2, 5, 0.01 * length, 0.02 * length, -length, max_t), max_t * length > 4.0);
                check(ray(0.25, 0.2, 5, 0.5 * length, 0, -length, max_t), false);
            }
        }
        for (int exponent = 10; exponent <= 1020; exponent += 10) {
            CAPTURE(exponent);
            const double far = std::scalbn(1.0, exponent);
            check(ray(0.25, 0.2, far, 0, 0, -1), true);
            check(ray(0.25, 0.2, far, 0, 0, 1), false);
            check(ray(0.25, -far, 0.1, 1, 0.01, 0.003, 100), false);
            check(ray(-far, 0.1, 0.1, 1, 0.01, 0.003, 100), false);
        }
    }

    TEST_CASE("trees refuse what is no ray and no shape, and answer for the others") {
        const std::vector<crofton_box> boxes{box_at(0, 0, 0), box_at(3, 0, 0), box_at(6, 0, 0), box_at(6, 5, 0)};
        const std::vector<std::uint32_t> layers{1, 2, 1, 1};
        crofton_tree* handle = nullptr;
        REQUIRE(crofton_tree_create(boxes.data(), layers.data(), boxes.size(), nullptr, &handle) == CROFTON_OK);
        const Tree tree(handle);
        std::uint32_t items[2] = {77, 77};
        std::size_t found = 77;
        const double nan = std::nan(""), center[] = {3, 0, 0}, nowhere[] = {0, nan, 0};
        CHECK(tree_within_sphere(tree.get(), nowhere, 1.0, ~0u, items, 2, &found) == CROFTON_NON_FINITE);
        CHECK(tree_within_sphere(tree.get(), center, -1.0, ~0u, items, 2, &found) == CROFTON_INVALID_ARGUMENT);
        CHECK(tree_within_sphere(tree.get(), nullptr, 1.0, ~0u, items, 2, &found) == CROFTON_INVALID_ARGUMENT);
        CHECK(tree_within_sphere(tree.get(), center, 1.0, ~0u, nullptr, 2, &found) == CROFTON_INVALID_ARGUMENT);
        CHECK(tree_within_box(nullptr, boxes.data(), ~0u, items, 2, &found) == CROFTON_BAD_HANDLE);
        crofton_box bad = boxes[0];
        bad.half_extents[0] = -1.0f;
        CHECK(tree_within_box(tree.get(), &bad, ~0u, items, 2, &found) != CROFTON_OK);
        const crofton_ray rays[] = {ray(-5, 0, 0, 1, 0, 0), ray(9, 0, 0, -1, 0, 0), ray(0, 9, 0, 1, 0, 0),
                                    ray(0, 0, 0, nan, 0, 0)};
        crofton_ray_hit hits[3];
        CHECK(crofton_tree_raycast(tree.get(), rays + 3, 1, ~0u, hits) == CROFTON_NON_FINITE);
        CHECK(items[0] == 77);
        CHECK(found == 77);

        REQUIRE(tree_within_sphere(tree.get(), center, 2.5, ~0u, items, 2, &found) == CROFTON_OK);
        CHECK(found == 3);  // two of them only touch
        CHECK(items[0] == 0);
        CHECK(items[1] == 1);
        REQUIRE(tree_within_sphere(tree.get(), center, 2.499999, ~0u, nullptr, 0, &found) == CROFTON_OK);
        CHECK(found == 1);
        const crofton_box large = box_at(3, 0, 0, 2.5f);
        REQUIRE(tree_within_box(tree.get(), &large, 1u, items, 2, &found) == CROFTON_OK);
        CHECK(found == 2);
        CHECK(items[1] == 2);
        REQUIRE(crofton_tree_raycast(tree.get(), rays, 3, ~0u, hits) == CROFTON_OK);
        CHECK(hits[0].index == 0);
        CHECK(hits[0].t == doctest::Approx(4.5));
        CHECK(hits[1].index == 2);
        CHECK(hits[2].index == CROFTON_NONE);
        REQUIRE(crofton_tree_raycast(tree.get(), rays, 1, 2u, hits) == CROFTON_OK);
        CHECK(hits[0].index == 1);
    }
}
