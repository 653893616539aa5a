// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/list_layout.hpp>
#include <limits>
#include <oracle/exact_bounds.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

using namespace crofton;
using cull::BoxSet;
using cull::Verdict;

TEST_SUITE("cull/bound_set") {
    TEST_CASE(
        "boxes that are not finite are straddling for every view, and their neighbours are as if they were absent") {
        oracle::Crowd crowd = oracle::random_crowd(200, 0.0, 1);
        crowd.boxes[3].center.x = std::nan("");
        crowd.boxes[17].half_extents.y = std::numeric_limits<float>::infinity();
        crowd.boxes[199].axes[0].x = std::nanf("");
        BoxSet set;
        set.assign(crowd.boxes);
        cull::VerdictBits bits;
        oracle::NearMisses random(2);
        for (int trial = 0; trial < 20; ++trial) {
            const cull::View view{*frustum_of(random.camera())};
            cull::find_visible(set, crowd.boxes, view, bits);
            for (std::size_t i = 0; i < crowd.boxes.size(); ++i)
                CHECK(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i]));
            CHECK(bits.verdict(17) == Verdict::straddling);
        }
    }

    TEST_CASE("an empty set, a view without planes and normals that are not unit are all answered") {
        BoxSet set;
        cull::VerdictBits bits;
        cull::find_visible(set, {}, {*frustum_of(Camera{})}, bits);
        CHECK(bits.visible.empty());
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 1);
        set.assign(crowd.boxes);
        cull::find_visible(set, crowd.boxes, cull::View{}, bits);
        for (std::size_t i = 0; i < 100; ++i) CHECK(bits.verdict(i) == Verdict::inside);
        cull::View scaled{*frustum_of(Camera{})};
        scaled.frustum.planes[1].normal *= 1.9;
        cull::find_visible(set, crowd.boxes, scaled, bits);
        for (std::size_t i = 0; i < 100; ++i) CHECK(bits.verdict(i) == cull::classify(scaled.frustum, crowd.boxes[i]));
    }

    TEST_CASE("no record of a chunk lies farther from its origin than the chunk says") {
        oracle::NearMisses random(4);
        const auto reach_of = [](const auto& record) {
            return std::abs(double(record.center[0])) + std::abs(double(record.center[1])) +
                   std::abs(double(record.center[2]));
        };
        cull::AabbSet aligned;
        cull::SphereSet round;
        for (int trial = 0; trial < 2000; ++trial) {
            std::vector<Aabb> boxes;
            std::vector<Sphere> spheres;
            for (int i = 0; i < 3; ++i) {
                const glm::dvec3 center = random.number(0.5, 60.0) * random.direction();
                boxes.push_back({center - 0.25, center + 0.25});
                spheres.push_back({center, 0.25});
            }
            aligned.assign(boxes);
            round.assign(spheres);
            for (std::size_t i = 0; i < 3; ++i) {
                REQUIRE(reach_of(aligned.records()[i]) <= double(aligned.chunks()[0].l1_radius));
                REQUIRE(reach_of(round.records()[i]) <= double(round.chunks()[0].l1_radius));
            }
        }
    }

    TEST_CASE("all verdicts are classify's, at every offset and in every mode, after updates too") {
        for (const double offset : {0.0, 1e4, 1e5, 1e6, 1e7})
            for (const std::size_t count : {1u, 63u, 9000u}) {
                oracle::Crowd crowd = oracle::random_crowd(count, offset, count);
                BoxSet set;
                set.assign(crowd.boxes);
                cull::VerdictBits bits;
                oracle::NearMisses random(3, offset);
                for (int trial = 0; trial < 8; ++trial) {
                    Camera camera = random.camera();
                    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera)};
                    std::vector<std::uint32_t> moved;
                    for (std::uint32_t i = 0; i < count; i += 3) {
                        crowd.boxes[i] = oracle::random_box(random, camera.position, 40.0);
                        moved.push_back(i);
                    }
                    // Some barely touch.
                    for (std::uint32_t i = 0; i < count; i += 15) crowd.boxes[i] = random.box(view.frustum, 1e-9, 1e-3);
                    set.update(moved, crowd.boxes);
                    const cull::CullMode mode = trial % 2 ? cull::CullMode::exact : cull::CullMode::conservative;
                    cull::find_visible(set, crowd.boxes, view, bits, mode);
                    std::size_t visible = 0;
                    for (std::size_t i = 0; i < count; ++i) {
                        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i], mode));
                        visible += bits.verdict(i) != Verdict::outside;
                    }
                    std::vector<cull::ItemId> ids(visible + 16);
                    REQUIRE(cull::list_bits(bits.visible, ids) == visible);
                    for (std::size_t n = 0; n < visible; ++n) REQUIRE(bits.verdict(ids[n]) != Verdict::outside);
                }
            }
    }

    TEST_CASE(
        "axis-aligned boxes and spheres get classify's verdicts, at every offset and in every mode, after updates "
        "too") {
        for (const double offset : {0.0, 1e5, 1e7})
            for (const std::size_t count : {1u, 65u, 5000u}) {
                oracle::NearMisses random(6, offset);
                const glm::dvec3 middle = offset * glm::dvec3(1.0, -0.7, 0.3);
                const auto random_aabb = [&](const glm::dvec3& near) {
                    return aabb_of(oracle::random_box(random, near, 40.0));
                };
                const auto random_sphere = [&](const glm::dvec3& near) {
                    const Obb box = oracle::random_box(random, near, 40.0);
                    return Sphere{box.center, double{box.half_extents.x}};
                };
                std::vector<Aabb> boxes;
                std::vector<Sphere> spheres;
                for (std::size_t i = 0; i < count; ++i) {
                    boxes.push_back(random_aabb(middle));
                    spheres.push_back(random_sphere(middle));
                }
                cull::AabbSet box_set;
                cull::SphereSet sphere_set;
                box_set.assign(boxes);
                sphere_set.assign(spheres);
                cull::VerdictBits bits;
                for (int trial = 0; trial < 6; ++trial) {
                    Camera camera = random.camera();
                    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera)};
                    std::vector<std::uint32_t> moved;
                    for (std::uint32_t i = 0; i < count; i += 3) {
                        boxes[i] = i % 15 ? random_aabb(camera.position) : oracle::near_aabb(random, view.frustum);
                        spheres[i] =
                            i % 15 ? random_sphere(camera.position) : oracle::near_sphere(random, view.frustum);
                        moved.push_back(i);
                    }
                    if (count > 60) {
                        boxes[30] = Aabb{};
                        boxes[33].max.x = std::numeric_limits<double>::infinity();
                        boxes[36] = {{-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}};
                        boxes[39].min.y = std::nan("");
                        spheres[30].radius = -1.0;
                        spheres[33].center.z = std::nan("");
                        spheres[36].radius = 1e30;
                        spheres[39].center.x = -std::numeric_limits<double>::infinity();
                        spheres[42].radius = std::numeric_limits<double>::denorm_min();
                    }
                    box_set.update(moved, boxes);
                    sphere_set.update(moved, spheres);
                    const cull::CullMode mode = trial % 2 ? cull::CullMode::exact : cull::CullMode::conservative;
                    cull::find_visible(box_set, boxes, view, bits, mode);
                    for (std::size_t i = 0; i < count; ++i)
                        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, boxes[i], mode));
                    cull::find_visible(sphere_set, spheres, view, bits, mode);
                    for (std::size_t i = 0; i < count; ++i)
                        REQUIRE(bits.verdict(i) == cull::classify(view.frustum, spheres[i], mode));
                }
            }
    }

    TEST_CASE(
        "zero, denormal and enormous boxes, and views far away or with enormous offsets, get classify's verdicts") {
        oracle::NearMisses random(7);
        oracle::Crowd crowd = oracle::random_crowd(4200, 0.0, 3);
        for (std::size_t i = 0; i < 300; ++i) {
            Obb& box = crowd.boxes[11 * i];
            if (i % 6 == 0) box.half_extents = glm::vec3(0.0f);
            if (i % 6 == 1) box.half_extents = glm::vec3(std::numeric_limits<float>::denorm_min());
            if (i % 6 == 2) box.half_extents = glm::vec3(9e29f);
            if (i % 6 == 3) box.center *= 1e28;
            if (i % 6 == 4) box.axes = glm::mat3(0.0f);
            if (i % 6 == 5) box.half_extents.x = std::numeric_limits<float>::quiet_NaN();
        }
        BoxSet set;
        set.assign(crowd.boxes);
        cull::VerdictBits bits;
        for (unsigned trial = 0; trial < 12; ++trial) {
            cull::View view{*frustum_of(random.camera())};
            if (trial % 4 == 1) view.frustum.origin *= 1e29;
            if (trial % 4 == 2) view.frustum.planes[trial % 6].offset = trial % 8 == 2 ? 1e49 : -1e49;
            if (trial % 4 == 3) view.frustum.planes[trial % 6].offset = trial % 8 == 3 ? 1e31 : -1e31;
            for (const cull::CullMode mode : {cull::CullMode::conservative, cull::CullMode::exact}) {
                cull::find_visible(set, crowd.boxes, view, bits, mode);
                for (std::size_t i = 0; i < crowd.boxes.size(); ++i)
                    REQUIRE(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i], mode));
            }
        }
    }

    TEST_CASE("a chunk whose boxes have all moved far is laid out again, one with a box moving to and fro is not") {
        oracle::Crowd crowd = oracle::random_crowd(4096, 0.0, 8);
        BoxSet set;
        set.assign(crowd.boxes);
        CHECK(set.chunks()[0].out_of_frame == 0);
        const double quantum = set.chunks()[0].quantum;
        std::vector<std::uint32_t> one{5}, all;
        crowd.boxes[5].center.x += 1e6;
        set.update(one, crowd.boxes);
        CHECK(set.chunks()[0].out_of_frame == 1);
        CHECK(set.chunks()[0].quantum == quantum);
        crowd.boxes[5].center.x -= 1e6;
        set.update(one, crowd.boxes);
        CHECK(set.chunks()[0].out_of_frame == 0);
        for (std::uint32_t i = 0; i < 4096; ++i) {
            crowd.boxes[i].center.x += 1e6;
            all.push_back(i);
        }
        set.update(all, crowd.boxes);
        CHECK(set.chunks()[0].out_of_frame == 0);
        cull::VerdictBits bits;
        oracle::NearMisses random(9);
        for (int trial = 0; trial < 5; ++trial) {
            Camera camera = random.camera();
            camera.position.x += 1e6;
            camera.far_distance = 60.0;
            const cull::View view{*frustum_of(camera)};
            cull::find_visible(set, crowd.boxes, view, bits);
            for (std::size_t i = 0; i < 4096; ++i)
                REQUIRE(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i]));
        }
    }

    TEST_CASE("one box that moves off alone, along any axis and within its chunk's frame, is where it went") {
        for (int axis = 0; axis < 3; ++axis)
            for (const double way : {-90.0, 90.0}) {
                std::vector<Obb> boxes(100);  // in a row along another axis
                for (std::size_t i = 0; i < boxes.size(); ++i) {
                    boxes[i].center[(axis + 1) % 3] = 2.0 * static_cast<double>(i) - 99.0;
                    boxes[i].half_extents = glm::vec3(0.5f);
                }
                BoxSet set;
                set.assign(boxes);
                const std::uint32_t moved = 50;
                boxes[moved].center[axis] = way;
                set.update(std::span(&moved, 1), boxes);
                Frustum half_space;
                half_space.plane_count = 1;
                for (const double side : {-1.0, 1.0}) {  // where it is, and where the others are
                    half_space.planes[0].normal[axis] = side * way / 90.0;
                    half_space.planes[0].offset = side * -80.0;
                    cull::VerdictBits bits;
                    cull::find_visible(set, boxes, {half_space}, bits);
                    for (std::size_t i = 0; i < boxes.size(); ++i)
                        CHECK(bits.verdict(i) == ((i == moved) == (side > 0.0) ? Verdict::inside : Verdict::outside));
                }
            }
    }

    TEST_CASE("a list in the order of space is decided by whole chunks, with the same verdicts") {
        oracle::Crowd crowd = oracle::random_crowd(40000, 0.0, 10);
        std::sort(crowd.boxes.begin(), crowd.boxes.end(),
                  [](const Obb& a, const Obb& b) { return a.center.x < b.center.x; });
        for (Obb& box : crowd.boxes) box.half_extents = glm::min(box.half_extents, glm::vec3(1.0f));
        BoxSet set;
        set.assign(crowd.boxes);
        Camera camera;
        camera.position = {-200.0, 0.0, 0.0};
        camera.forward = {1.0, 0.0, 0.0};
        camera.near_distance = 150.0;
        camera.far_distance = 200.0;
        const cull::View view{*frustum_of(camera)};
        cull::VerdictBits bits;
        cull::find_visible(set, crowd.boxes, view, bits);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < crowd.boxes.size(); ++i) {
            REQUIRE(bits.verdict(i) == cull::classify(view.frustum, crowd.boxes[i]));
            inside += bits.verdict(i) == Verdict::inside;
        }
        CHECK(inside > 5000);
    }

    TEST_CASE("boxes nearer to the view's planes than a list's integers resolve get classify's verdicts") {
        for (const double offset : {0.0, 1e6}) {
            oracle::NearMisses random(16, offset);
            for (int trial = 0; trial < 12; ++trial) {
                const Frustum frustum = *frustum_of(random.camera());
                const auto corners = *frustum_corners(frustum);
                std::vector<Sphere> points;
                for (int n = 0; n < 4000; ++n) points.push_back({random.surface_point(frustum, corners), 0.0});
                cull::SphereSet set;
                set.assign(points);
                const double quantum = set.chunks()[0].quantum;
                for (Sphere& point : points) point.center += random.number(0.0, 0.3) * quantum * random.direction();
                set.assign(points);
                cull::VerdictBits bits;
                cull::find_visible(set, points, {frustum}, bits);
                for (std::size_t i = 0; i < points.size(); ++i)
                    REQUIRE(bits.verdict(i) == cull::classify(frustum, points[i]));
            }
        }
    }

    TEST_CASE("32 views in one pass see what each sees alone, each within its layers") {
        for (const std::size_t count : {1u, 70u, 9000u}) {
            const oracle::Crowd crowd = oracle::random_crowd(count, 1e6, 12);
            BoxSet set;
            set.assign(crowd.boxes);
            oracle::NearMisses random(13, 1e6);
            std::vector<cull::View> views;
            for (unsigned v = 0; v < 32; ++v) {
                Camera camera = random.camera();
                camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                views.push_back({*frustum_of(camera), v % 3 ? ~0u : 1u << (v % 4)});
            }
            views[7].frustum.planes[0].offset = std::nan("");
            views[8].frustum.planes[2].normal *= 1.5;
            views[9].frustum.plane_count = 0;
            cull::VerdictBits bits;
            std::vector<std::uint32_t> masks(count, 77u);
            for (const bool layered : {false, true})
                for (const std::size_t used : {0u, 5u, 32u}) {
                    const auto layers =
                        layered ? std::span<const std::uint32_t>(crowd.layers) : std::span<const std::uint32_t>();
                    (void)cull::find_visible(set, crowd.boxes, layers, std::span<const cull::View>(views).first(used),
                                             masks);
                    std::vector<std::uint32_t> expected(count, 0u);
                    for (std::size_t v = 0; v < used; ++v) {
                        cull::find_visible(set, crowd.boxes, views[v], bits);
                        for (std::size_t i = 0; i < count; ++i)
                            if (bits.verdict(i) != Verdict::outside &&
                                (!layered || crowd.layers[i] & views[v].layer_mask))
                                expected[i] |= 1u << v;
                    }
                    CHECK(masks == expected);
                }
        }
    }

    TEST_CASE("statistics count what the exact stage found outside") {
        if (!cull::kCountStatistics) return;
        const oracle::Crowd crowd = oracle::random_crowd(20000, 0.0, 14);
        BoxSet set;
        set.assign(crowd.boxes);
        oracle::NearMisses random(15);
        cull::VerdictBits bits;
        std::size_t false_positives = 0;
        for (int trial = 0; trial < 10; ++trial) {
            const cull::View view{*frustum_of(random.camera())};
            cull::find_visible(set, crowd.boxes, view, bits);
            std::size_t expected = 0, straddling = 0;
            for (std::size_t i = 0; i < crowd.boxes.size(); ++i) {
                expected +=
                    bits.verdict(i) == Verdict::outside &&
                    cull::classify(view.frustum, crowd.boxes[i], cull::CullMode::conservative) != Verdict::outside;
                straddling += bits.verdict(i) == Verdict::straddling;
            }
            CHECK(bits.statistics.false_positives == expected);
            CHECK(bits.statistics.straddling == straddling);
            CHECK(bits.statistics.boxes_tested == 20000);
            false_positives += expected;
        }
        CHECK(false_positives > 10);
        const std::vector<cull::View> views{{*frustum_of(random.camera())}, {*frustum_of(random.camera())}};
        std::vector<std::uint32_t> masks(crowd.boxes.size());
        std::vector<cull::Statistics> statistics(2);
        ThreadPool two(2);
        (void)cull::find_visible(set, crowd.boxes, {}, views, masks, cull::CullMode::exact, two, statistics);
        for (std::size_t v = 0; v < 2; ++v) {
            cull::find_visible(set, crowd.boxes, views[v], bits);
            CHECK(statistics[v].false_positives == bits.statistics.false_positives);
            CHECK(statistics[v].straddling == bits.statistics.straddling);
            CHECK(statistics[v].boxes_tested == bits.statistics.boxes_tested);
        }
    }

    TEST_CASE("lists of spheres and boxes have classify's verdicts at every size from 1e-30 to 1e29") {
        oracle::NearMisses random(41, 0.0);
        cull::VerdictBits bits;
        std::size_t outside = 0, inside = 0, straddling = 0;
        const auto check = [&]<class Bound>(const std::vector<Bound>& bounds, const cull::View& view) {
            cull::BoundSet<Bound> set;
            set.assign(bounds);
            std::vector<std::uint32_t> masks(bounds.size());
            const std::vector<cull::View> views(2, view);
            for (const cull::CullMode mode : {cull::CullMode::exact, cull::CullMode::conservative}) {
                cull::find_visible(set, bounds, view, bits, mode);
                REQUIRE(cull::find_visible(set, bounds, {}, views, masks, mode).has_value());
                for (std::size_t i = 0; i < bounds.size(); ++i) {
                    const cull::Verdict verdict = cull::classify(view.frustum, bounds[i], mode);
                    CHECK(bits.verdict(i) == verdict);
                    CHECK(masks[i] == (verdict == cull::Verdict::outside ? 0u : 3u));
                    (verdict == cull::Verdict::outside  ? outside
                     : verdict == cull::Verdict::inside ? inside
                                                        : straddling) += 1;
                }
            }
        };
        for (int exponent = -30; exponent < 30; ++exponent)
            for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
                const double s = std::pow(10.0, exponent);
                CAPTURE(exponent);
                Camera camera;
                camera.projection = projection;
                camera.position = {0.0, 0.0, 10.0 * s};
                camera.height = 2.0 * s;
                camera.fov_y = 0.2;
                camera.aspect = 1.0;
                camera.near_distance = 5.0 * s;
                camera.far_distance = 20.0 * s;
                const auto frustum = frustum_of(camera);
                REQUIRE(frustum.has_value());
                std::vector<Sphere> spheres;
                std::vector<Aabb> aligned;
                std::vector<Obb> boxes;
                for (int i = 0; i < 120; ++i) {
                    // Around an edge of the view: touched, nearly touched, clear of it, also far out.
                    const double x = random.number(0.5, 2.5), y = i % 3 ? x : random.number(-1.0, 1.0);
                    const glm::dvec3 center(x * s, y * s, (i % 5 ? random.number(-2.0, 2.0) : 0.0) * s);
                    spheres.push_back({center, s * (i % 2 ? std::fabs(x - 1.0) * random.number(0.9, 1.5) : 0.3)});
                    aligned.push_back({center - 0.4 * s, center + 0.4 * s});
                    Obb box;
                    box.center = center;
                    box.half_extents = glm::vec3(static_cast<float>(0.4 * s));
                    if (exponent <= 17) boxes.push_back(box);
                }
                check(spheres, {*frustum});
                check(aligned, {*frustum});
                check(boxes, {*frustum});
            }
        CHECK(outside > 5000);
        CHECK(straddling > 5000);
        CHECK(inside > 100);
    }
}
