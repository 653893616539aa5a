// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/cull/classify.hpp>
#include <limits>
#include <oracle/exact_bounds.hpp>
#include <oracle/exact_frustum.hpp>
#include <oracle/near_misses.hpp>
#include <vector>

using namespace crofton;
using cull::CullMode;
using cull::Verdict;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The cube [−1, 1]³ as a view volume: every number is exact.
Frustum unit_cube() {
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.height = 2.0;
    camera.aspect = 1.0;
    camera.near_distance = -1.0;
    camera.far_distance = 1.0;
    return *frustum_of(camera);
}

Obb cube_at(const glm::dvec3& center, float half) {
    Obb box;
    box.center = center;
    box.half_extents = glm::vec3(half);
    return box;
}

}  // namespace

TEST_SUITE("cull/classify") {
    TEST_CASE("a box that is not finite is straddling, and its neighbours are answered as if it were absent") {
        const Frustum frustum = unit_cube();
        std::vector<Obb> boxes(7, cube_at({0.0, 0.0, 0.0}, 0.5f));
        boxes[1].center.x = std::nan("");
        boxes[2].half_extents.y = std::numeric_limits<float>::infinity();
        boxes[3].axes[1].z = std::nanf("");
        boxes[4].center.y = -kInfinity;
        boxes[5].center.z = 1e31;
        boxes[6].center.z = 5.0;
        std::vector<Verdict> verdicts(boxes.size());
        for (const CullMode mode : {CullMode::conservative, CullMode::exact}) {
            cull::classify(frustum, boxes, verdicts, mode);
            CHECK(verdicts[0] == Verdict::inside);
            for (std::size_t i = 1; i < 6; ++i) CHECK(verdicts[i] == Verdict::straddling);
            CHECK(verdicts[6] == Verdict::outside);
        }
    }

    TEST_CASE("a frustum that is not finite culls nothing") {
        Frustum frustum = unit_cube();
        frustum.planes[2].normal.x = std::nan("");
        CHECK(cull::classify(frustum, cube_at({50.0, 0.0, 0.0}, 1.0f)) == Verdict::straddling);
        frustum = unit_cube();
        frustum.origin.z = kInfinity;
        CHECK(cull::classify(frustum, cube_at({50.0, 0.0, 0.0}, 1.0f)) == Verdict::straddling);
    }

    TEST_CASE("zero, denormal and enormous extents are answered like any other") {
        const Frustum frustum = unit_cube();
        const float denormal = std::numeric_limits<float>::denorm_min();
        CHECK(cull::classify(frustum, cube_at({0.0, 0.0, 0.0}, 0.0f)) == Verdict::inside);
        CHECK(cull::classify(frustum, cube_at({1.0, 1.0, 1.0}, 0.0f)) == Verdict::inside);
        CHECK(cull::classify(frustum, cube_at({1.0, 1.0, 1.0}, denormal)) == Verdict::straddling);
        CHECK(cull::classify(frustum, cube_at({std::nextafter(1.0, 2.0), 0.0, 0.0}, 0.0f)) == Verdict::outside);
        CHECK(cull::classify(frustum, cube_at({std::nextafter(1.0, 2.0), 0.0, 0.0}, denormal)) == Verdict::outside);
        CHECK(cull::classify(frustum, cube_at({0.0, 0.0, 0.0}, 9e29f)) == Verdict::straddling);
        CHECK(cull::classify(frustum, cube_at({1e30, 0.0, 0.0}, 1e29f)) == Verdict::outside);
        Frustum far = frustum;
        far.planes[far.plane_count++] = {{0.0, 0.0, 1.0}, 1e50};
        CHECK(cull::classify(far, cube_at({50.0, 0.0, 0.0}, 1.0f)) == Verdict::outside);
        far.planes[far.plane_count - 1].offset = std::nextafter(1e50, 2e50);
        CHECK(cull::classify(far, cube_at({50.0, 0.0, 0.0}, 1.0f)) == Verdict::straddling);
        Obb needle = cube_at({0.0, 0.0, 0.0}, 0.0f);
        needle.half_extents.x = 9e29f;
        CHECK(cull::classify(frustum, needle) == Verdict::straddling);
        needle.center.y = std::nextafter(1.0, 2.0);
        CHECK(cull::classify(frustum, needle) == Verdict::outside);
    }

    TEST_CASE("a box that touches a plane, an edge or a corner from outside is never culled, one step away it is") {
        const Frustum frustum = unit_cube();
        for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(1, -1, 0), glm::dvec3(-1, 1, 1)}) {
            CHECK(cull::classify(frustum, cube_at(1.5 * axis, 0.5f)) == Verdict::straddling);
            CHECK(cull::classify(frustum, cube_at(std::nextafter(1.5, 2.0) * axis, 0.5f)) == Verdict::outside);
        }
        CHECK(cull::classify(frustum, cube_at({0.5, 0.5, 0.5}, 0.5f)) == Verdict::inside);
        CHECK(cull::classify(frustum, cube_at({std::nextafter(0.5, 1.0), 0.5, 0.5}, 0.5f)) == Verdict::straddling);
    }

    TEST_CASE(
        "a box turned by 45 degrees beside an edge passes every plane, and only the exact mode sees that it is "
        "outside") {
        // Its flat side faces the cube's edge at distance √2·(1.6 − 1) − 0.5 > 0.
        Obb rod = cube_at({1.6, 1.6, 0.0}, 0.5f);
        const float s = std::sqrt(0.5f);
        rod.axes = glm::mat3(s, s, 0.0f, -s, s, 0.0f, 0.0f, 0.0f, 1.0f);
        CHECK(cull::classify(unit_cube(), rod, CullMode::conservative) == Verdict::straddling);
        CHECK(cull::classify(unit_cube(), rod, CullMode::exact) == Verdict::outside);
        rod.center = {1.3, 1.3, 0.0};
        CHECK(cull::classify(unit_cube(), rod, CullMode::exact) == Verdict::straddling);
    }

    TEST_CASE("agrees with the exact oracle on boxes that nearly touch") {
        for (const double offset : {0.0, 1e4, 1e7}) {
            oracle::NearMisses cases(1, offset);
            int outside = 0, false_positives = 0, inside = 0;
            for (int trial = 0; trial < 400; ++trial) {
                const Frustum frustum = *frustum_of(cases.camera());
                const Obb box = cases.box(frustum);
                const Verdict expected = oracle::classify(frustum, box);
                CHECK(cull::classify(frustum, box) == expected);
                const bool rejected = oracle::is_rejected_by_a_plane(frustum, box);
                CHECK((cull::classify(frustum, box, CullMode::conservative) == Verdict::outside) == rejected);
                outside += expected == Verdict::outside;
                false_positives += expected == Verdict::outside && !rejected;
                inside += expected == Verdict::inside;
            }
            CHECK(outside > 40);
            CHECK(false_positives > 10);
            CHECK(inside + outside < 380);
        }
    }

    TEST_CASE("agrees with the exact oracle where all decisions are exact ties") {
        // Small integers on both sides: most boxes touch, and every rounding error would show.
        oracle::NearMisses cases(2);
        const Frustum frustum = unit_cube();
        for (int trial = 0; trial < 500; ++trial) {
            Obb box;
            box.center = glm::dvec3(cases.index(9), cases.index(9), cases.index(9)) * 0.5 - 2.0;
            box.half_extents = glm::vec3(float(cases.index(3)), float(cases.index(3)), float(cases.index(3))) * 0.5f;
            if (trial % 2) box.axes = glm::mat3(0.6f, 0.8f, 0.0f, -0.8f, 0.6f, 0.0f, 0.0f, 0.0f, 1.0f);
            CHECK(cull::classify(frustum, box) == oracle::classify(frustum, box));
        }
    }

    TEST_CASE("agrees with the exact oracle for volumes of up to twelve planes and for open ones") {
        oracle::NearMisses cases(3);
        for (int trial = 0; trial < 120; ++trial) {
            const Frustum base = *frustum_of(cases.camera());
            const Obb box = cases.box(base);
            Frustum open = base;
            open.plane_count = 5 - static_cast<std::uint32_t>(trial % 3);
            CHECK(cull::classify(open, box) == oracle::classify(open, box));
            Frustum cut = base;
            const Frustum other = *frustum_of(cases.camera());
            for (const Plane& plane : other.view()) {
                cut.planes[cut.plane_count++] = plane;
                if (trial % 2) break;
            }
            CHECK(cull::classify(cut, box) == oracle::classify(cut, box));
        }
    }

    TEST_CASE("axis-aligned boxes and spheres that are not valid are straddling, and cull nothing") {
        const Frustum frustum = unit_cube();
        for (const CullMode mode : {CullMode::conservative, CullMode::exact}) {
            CHECK(cull::classify(frustum, Aabb{}, mode) == Verdict::straddling);
            CHECK(cull::classify(frustum, Aabb{{5.0, 0.0, 0.0}, {kInfinity, 1.0, 1.0}}, mode) == Verdict::straddling);
            CHECK(cull::classify(frustum, Aabb{{5.0, 0.0, 0.0}, {6.0, std::nan(""), 1.0}}, mode) ==
                  Verdict::straddling);
            CHECK(cull::classify(frustum, Sphere{{5.0, 0.0, 0.0}, -1.0}, mode) == Verdict::straddling);
            CHECK(cull::classify(frustum, Sphere{{5.0, std::nan(""), 0.0}, 1.0}, mode) == Verdict::straddling);
            CHECK(cull::classify(frustum, Sphere{{5.0, 0.0, 0.0}, std::nan("")}, mode) == Verdict::straddling);
            CHECK(cull::classify(frustum, Sphere{{5.0, 0.0, 0.0}, 1e31}, mode) == Verdict::straddling);
        }
        Frustum broken = frustum;
        broken.planes[1].normal.y = std::nan("");
        CHECK(cull::classify(broken, Sphere{{50.0, 0.0, 0.0}, 1.0}) == Verdict::straddling);
        CHECK(cull::classify(broken, Aabb{{50.0, 0.0, 0.0}, {51.0, 1.0, 1.0}}) == Verdict::straddling);
    }

    TEST_CASE("spheres that touch a plane, an edge or a corner are never culled, one step away they are") {
        const Frustum frustum = unit_cube();
        const double next = std::nextafter(2.0, 1.0);
        CHECK(cull::classify(frustum, Sphere{{3.0, 0.0, 0.0}, 2.0}) == Verdict::straddling);
        CHECK(cull::classify(frustum, Sphere{{3.0, 0.0, 0.0}, next}) == Verdict::outside);
        // 3-4-5 beyond an edge, 1-2-2-3 beyond a corner.
        CHECK(cull::classify(frustum, Sphere{{4.0, 5.0, 0.0}, 5.0}) == Verdict::straddling);
        CHECK(cull::classify(frustum, Sphere{{4.0, 5.0, 0.0}, std::nextafter(5.0, 4.0)}) == Verdict::outside);
        CHECK(cull::classify(frustum, Sphere{{4.0, 5.0, 0.0}, std::nextafter(5.0, 4.0)}, CullMode::conservative) ==
              Verdict::straddling);
        CHECK(cull::classify(frustum, Sphere{{-2.0, 3.0, -3.0}, 3.0}) == Verdict::straddling);
        CHECK(cull::classify(frustum, Sphere{{-2.0, 3.0, -3.0}, std::nextafter(3.0, 2.0)}) == Verdict::outside);
        CHECK(cull::classify(frustum, Sphere{{0.5, 0.0, 0.0}, 0.5}) == Verdict::inside);
        CHECK(cull::classify(frustum, Sphere{{0.5, 0.0, 0.0}, std::nextafter(0.5, 1.0)}) == Verdict::straddling);
        CHECK(cull::classify(frustum, Sphere{{1.0, 1.0, 1.0}, 0.0}) == Verdict::inside);
        CHECK(cull::classify(frustum, Sphere{{1.0, 1.0, std::nextafter(1.0, 2.0)}, 0.0}) == Verdict::outside);
        CHECK(cull::classify(frustum, Sphere{{1e30, 0.0, 0.0}, 9e29}) == Verdict::outside);
        CHECK(cull::classify(frustum, Sphere{{0.0, 0.0, 0.0}, 1e30}) == Verdict::straddling);
    }

    TEST_CASE("agrees with the exact oracles on axis-aligned boxes and spheres that nearly touch") {
        for (const double offset : {0.0, 1e4, 1e7}) {
            oracle::NearMisses cases(5, offset);
            int false_positives = 0, outside = 0;
            for (int trial = 0; trial < 250; ++trial) {
                Frustum frustum = *frustum_of(cases.camera());
                const Aabb box = oracle::near_aabb(cases, frustum);
                const Sphere sphere = oracle::near_sphere(cases, frustum);
                if (trial % 5 == 0) frustum.plane_count = 5;
                const auto agrees = [&](const auto& bound) {
                    const Verdict expected = oracle::classify(frustum, bound);
                    const bool rejected = oracle::is_rejected_by_a_plane(frustum, bound);
                    CHECK(cull::classify(frustum, bound) == expected);
                    CHECK((cull::classify(frustum, bound, CullMode::conservative) == Verdict::outside) == rejected);
                    outside += expected == Verdict::outside;
                    false_positives += expected == Verdict::outside && !rejected;
                };
                agrees(box);
                agrees(sphere);
            }
            CHECK(outside > 50);
            CHECK(false_positives > 10);
        }
    }
}
