// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/geometry/camera.hpp>
#include <oracle/edges.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/near_misses.hpp>

using namespace crofton;

namespace {

Frustum unit_cube() {
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.height = 2.0;
    camera.aspect = 1.0;
    camera.near_distance = -1.0;
    camera.far_distance = 1.0;
    return *frustum_of(camera);
}

}  // namespace

TEST_SUITE("geometry/frustum_triangle") {
    TEST_CASE("triangles shrunk to a segment or a point meet the frustum where that does") {
        const Frustum cube = unit_cube();
        const double beyond = std::nextafter(1.0, 2.0);
        CHECK(intersects(cube, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}));
        CHECK(!intersects(cube, {beyond, 1, 1}, {beyond, 1, 1}, {beyond, 1, 1}));
        CHECK(intersects(cube, {-9, 0.5, 0}, {9, 0.5, 0}, {9, 0.5, 0}));
        CHECK(intersects(cube, {2, 0, 1}, {0, 2, 1}, {0, 2, 1}));
        CHECK(!intersects(cube, {2, std::nextafter(0.0, 1.0), 1}, {beyond, 1, 1}, {0, beyond * 2, 1}));
    }

    TEST_CASE("a triangle far larger than the frustum that encloses it in its plane is a hit") {
        CHECK(intersects(unit_cube(), {-1e9, -1e9, 0.5}, {1e9, -1e9, 0.5}, {0, 2e9, 0.5}));
        CHECK(intersects(unit_cube(), {-1e29, -1e29, 1.0}, {1e29, -1e29, 1.0}, {0, 2e29, 1.0}));
        CHECK(!intersects(unit_cube(), {-1e9, -1e9, 1.0000001}, {1e9, -1e9, 1.0000001}, {0, 2e9, 1.0000001}));
    }

    TEST_CASE("touching a corner of the frustum counts, passing it by does not, though no plane rejects") {
        CHECK(intersects(unit_cube(), {2, 0, 0}, {0, 2, 0}, {3, 3, 0}));
        CHECK(!intersects(unit_cube(), {2.001, 0, 0}, {0, 2.001, 0}, {3, 3, 0}));
    }

    TEST_CASE("agrees with exact elimination on triangles that nearly touch") {
        for (const double offset : {0.0, 1e7}) {
            oracle::NearMisses cases(5, offset);
            int hits = 0;
            for (int trial = 0; trial < 3000; ++trial) {
                const Frustum frustum = *frustum_of(cases.camera());
                const auto corners = *frustum_corners(frustum);
                const glm::dvec3 target = cases.surface_point(frustum, corners);
                // Corners around a point of the surface, weights zero or positive there, then nudged.
                const glm::dvec3 u = cases.number(0.1, 9.0) * cases.direction(),
                                 v = cases.number(0.1, 9.0) * cases.direction();
                const double s = cases.index(2) ? cases.number(0, 1) : 0.0,
                             t = cases.index(2) ? (1 - s) * cases.number(0, 1) : 0.0;
                const double nudge = std::exp(cases.number(-36.0, -2.0));
                const glm::dvec3 a = target - s * u - t * v + nudge * cases.direction();
                const bool expected = oracle::meets(frustum, a, a + u, a + v);
                CHECK(intersects(frustum, a, a + u, a + v) == expected);
                hits += expected;
            }
            CHECK(hits > 500);
            CHECK(hits < 2900);
        }
    }

    TEST_CASE("three planes that leave nothing of a triangle, though rounding says the contrary") {
        // Found by a search for the worst roundings.
        Frustum frustum;
        frustum.origin = {-0x1.f0f10f822b96fp-9, 0x1.50db57c7090b1p-8, 0x1.3f21e676730ccp-12};
        frustum.planes[0] = {{-0x1.897a68e8c5237p+0, -0x1.01ce266ff85aep-3, 0x1.14a380c9eb4e9p+0},
                             0x1.6cf6e22b81113p-8};
        frustum.planes[1] = {{0x1.141208d98fd34p-3, 0x1.da061e4dc8405p-1, 0x1.72a9f1b2b6734p-4}, 0x1.ef60bed6429afp-9};
        frustum.planes[2] = {{0x1.9d9f4700ada94p+0, -0x1.248608812d3a3p-1, -0x1.abf2c3827bec1p+0},
                             -0x1.bf9829345166bp-6};
        frustum.plane_count = 3;
        const glm::dvec3 a(-0x1.9e0948c7c19f4p+0, 0x1.0993f6e1a148cp-3, 0x1.6207e8b28a539p+0);
        const glm::dvec3 b(0x1.aaafe50f2a551p-3, 0x1.18ff418c9e10fp+0, -0x1.4a19400dffd5bp-3);
        const glm::dvec3 c(0x1.88e2110735b53p+0, -0x1.afc2eb9d64a1cp-1, -0x1.8729154d98166p+0);
        CHECK(!oracle::meets(frustum, a, b, c));
        CHECK(!intersects(frustum, a, b, c));
        frustum.planes[2].offset += 0x1p-40;
        CHECK(oracle::meets(frustum, a, b, c));
        CHECK(intersects(frustum, a, b, c));
    }

    TEST_CASE("a product that underflows next to coordinates of 1e200 decides nothing") {
        Frustum f;
        f.plane_count = 3;
        f.planes[0].normal = {0, -1, 0};
        f.planes[1].normal = {-1, 0, 0};
        f.planes[2].normal = {0.60599723665819105, -0.27299092327408053, -0.74715681417798863};
        f.planes[2].offset = -2e-165;
        const glm::dvec3 a(2e200, -2.2206440958587493e-166, -2e-155),
            b(-0.20404383707379381, 2e-165, 0.83912725461959847), c(-1e-165, 0, 1.513632781101606e-166);
        CHECK_FALSE(intersects(f, a, b, c));
    }

    TEST_CASE("agrees with exact elimination to the last bit where a triangle begins to miss the frustum") {
        for (const double offset : {0.0, 1e6}) {
            oracle::NearMisses cases(6, offset);
            int compared = 0;
            for (int trial = 0; trial < 150; ++trial) {
                const Frustum frustum = *frustum_of(cases.camera());
                const auto corners = *frustum_corners(frustum);
                glm::dvec3 middle(0.0);
                for (const glm::dvec3& corner : corners) middle += 0.125 * corner;
                const glm::dvec3 target = cases.surface_point(frustum, corners);
                const glm::dvec3 u = cases.number(0.1, 9.0) * cases.direction(),
                                 v = cases.number(0.1, 9.0) * cases.direction();
                const glm::dvec3 way = target - (frustum.origin + middle);
                const auto corner_at = [&](double s) { return frustum.origin + middle + s * way; };
                const auto meets = [&](double s) {
                    return intersects(frustum, corner_at(s), corner_at(s) + u, corner_at(s) + v);
                };
                if (!meets(0.0) || meets(30.0)) continue;
                const double edge = oracle::edge_between(0.0, 30.0, meets).first;
                const glm::dvec3 size = glm::abs(corner_at(edge));
                const double step = oracle::rounding_step(std::max({size.x, size.y, size.z})) / glm::length(way);
                for (int k = -5; k <= 5; ++k) {
                    const double s = edge + 0.3 * k * step;
                    CHECK(meets(s) == oracle::meets(frustum, corner_at(s), corner_at(s) + u, corner_at(s) + v));
                    ++compared;
                }
            }
            CHECK(compared > 500);
        }
    }
}
