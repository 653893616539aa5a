// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <counting_memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

using namespace crofton;

namespace {

// Oracle: does the way from `point` along `way` (0 to 1) meet the box? The part of it between each two faces is an
// interval. Points that only nearly meet it are told apart by `margin`.
bool way_meets(const Obb& box, const glm::dvec3& point, const glm::dvec3& way, double margin) {
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 axis(box.axes[k]);
        const double at = glm::dot(axis, point - box.center), slope = glm::dot(axis, way);
        const double half = double(box.half_extents[k]) - margin;
        if (std::abs(slope) < 1e-12) {
            if (std::abs(at) > half) return false;
            continue;
        }
        const double a = (-half - at) / slope, b = (half - at) / slope;
        low = std::max(low, std::min(a, b));
        high = std::min(high, std::max(a, b));
    }
    return low <= high;
}

glm::dvec3 random_point_in(oracle::NearMisses& random, const Obb& box) {
    glm::dvec3 result = box.center;
    for (int k = 0; k < 3; ++k)
        result += random.number(-1.0, 1.0) * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
    return result;
}

bool sees(const Frustum& view, const glm::dvec3& point) {
    for (const Plane& plane : view.view())
        if (glm::dot(plane.normal, point - view.origin) + plane.offset < 0.0) return false;
    return true;
}

struct ShadowScene {
    Frustum view;
    std::vector<Obb> receivers, casters;
    std::vector<glm::dvec3> seen;  // points of receivers within the view

    ShadowScene(oracle::NearMisses& random, double offset) {
        Camera camera = random.camera();
        const glm::dvec3 start = offset * glm::dvec3(1.0, -0.7, 0.3);
        camera.position += start;
        view = *frustum_of(camera);
        if (random.index(4) == 0) view.plane_count = 5;
        for (int i = 0; i < 20; ++i) {
            Obb receiver = oracle::random_box(random, camera.position + 10.0 * camera.forward, 10.0);
            if (i == 0) receiver.half_extents = {30.0f, 0.1f, 30.0f};
            if (cull::classify(view, receiver) == cull::Verdict::outside) continue;
            receivers.push_back(receiver);
            for (int n = 0; n < 1000; ++n)
                if (const glm::dvec3 point = random_point_in(random, receiver); sees(view, point))
                    seen.push_back(point);
        }
        for (int i = 0; i < 300; ++i)
            casters.push_back(oracle::random_box(random, camera.position + 5.0 * camera.forward, 20.0));
    }
};

}  // namespace

TEST_SUITE("cull/shadow_casters") {
    TEST_CASE("lights, views and receivers that cannot be are refused, and then no caster is wanted") {
        const Frustum view = *frustum_of(Camera{});
        const Obb box{.center = {0.0, 0.0, -5.0}, .half_extents = glm::vec3(1.0f)};
        std::vector<Obb> receivers{box, box};
        cull::CasterFilter set;
        CHECK(!set.wants(box));
        REQUIRE(set.set_sun(view, receivers, {0.0, 1.0, 0.0}).has_value());
        CHECK(set.wants(box));
        CHECK(!set.set_sun(view, receivers, glm::dvec3(0.0)).has_value());
        CHECK(!set.wants(box));
        CHECK(!set.set_sun(view, receivers, {0.0, std::nan(""), 0.0}).has_value());
        CHECK(!set.set_sun(view, receivers, {0.0, 1.0, 0.0}, -1.0).has_value());
        CHECK(!set.set_sun(view, receivers, {0.0, 1.0, 0.0}, 1.0, 0).has_value());
        CHECK(!set.set_point(view, receivers, {{0.0, 0.0, 0.0}, -1.0}).has_value());
        CHECK(!set.set_point(view, receivers, {{std::nan(""), 0.0, 0.0}, 1.0}).has_value());
        CHECK(!set.set_spot(view, receivers, {.axis = glm::vec3(0.0f)}).has_value());
        CHECK(!set.set_spot(view, receivers, {.axis = {0.0f, HUGE_VALF, 0.0f}}).has_value());
        CHECK(!set.set_spot(view, receivers, {.axis = {std::nanf(""), 1.0f, 0.0f}}).has_value());
        CHECK(!set.set_spot(view, receivers, {.cos_half_angle = 2.0f}).has_value());
        Frustum unknown = view;
        unknown.planes[0].offset = std::nan("");
        CHECK(!set.set_sun(unknown, receivers, {0.0, 1.0, 0.0}).has_value());
        receivers[1].center.x = std::nan("");
        CHECK(error_of(set.set_sun(view, receivers, {0.0, 1.0, 0.0})).item == 1);
        CHECK(!set.wants(box));
        CHECK(set.wants(receivers[1]));
        REQUIRE(set.set_sun(view, {}, {0.0, 1.0, 0.0}).has_value());
        CHECK(!set.wants(box));
    }

    TEST_CASE("casters above visible receivers are wanted, those next to, below and out of reach are not") {
        // A floor at y = −1; the view looks along −z.
        const Frustum view =
            *frustum_of(Camera{.fov_y = 1.0, .aspect = 1.0, .near_distance = 1.0, .far_distance = 20.0});
        const std::vector<Obb> floor{{.center = {0.0, -1.1, 0.0}, .half_extents = {100.0f, 0.1f, 100.0f}}};
        const auto at = [](double x, double y, double z) {
            return Obb{.center = {x, y, z}, .half_extents = glm::vec3(0.5f)};
        };
        cull::CasterFilter set;
        REQUIRE(set.set_sun(view, floor, {0.0, 1.0, 0.0}).has_value());
        CHECK(set.wants(at(0.0, 50.0, -10.0)));
        CHECK(set.wants(at(0.0, -1.0, -10.0)));
        CHECK(!set.wants(at(0.0, -3.0, -10.0)));  // below the floor
        CHECK(!set.wants(at(0.0, 50.0, 3.0)));    // above floor behind the camera
        CHECK(!set.wants(at(8.0, 50.0, -10.0)));  // beside: 5.5 is seen there
        CHECK(!set.wants(at(-4.0, 50.0, -3.0)));  // beside the view's side, within its rectangle
        CHECK(!set.wants(at(0.0, 50.0, -21.0)));  // beyond far
        REQUIRE(set.set_sun(view, floor, {0.0, 1.0, 0.0}, 10.0).has_value());
        CHECK(!set.wants(at(0.0, 50.0, -10.0)));
        CHECK(set.wants(at(0.0, 5.0, -10.0)));
        const Sphere lamp{{0.0, 5.0, -10.0}, 8.0};
        REQUIRE(set.set_point(view, floor, lamp).has_value());
        CHECK(set.wants(at(0.0, 2.0, -10.0)));
        CHECK(set.wants(lamp.center.x == 0.0 ? at(0.0, 5.0, -10.0) : at(0.0, 0.0, 0.0)));  // around the lamp
        CHECK(!set.wants(at(0.0, 8.0, -10.0)));                                            // above the lamp
        CHECK(!set.wants(at(6.0, 4.5, -10.0)));                                            // its shadow falls beside
        REQUIRE(set.set_spot(view, floor, {lamp.center, {0.0f, -1.0f, 0.0f}, 0.9f, 8.0f}).has_value());
        CHECK(set.wants(at(0.0, 2.0, -10.0)));
        CHECK(!set.wants(at(4.0, 2.0, -10.0)));  // out of the cone
    }

    TEST_CASE("no caster is refused that a point in view has on its way to the light, few others are kept") {
        std::size_t casting = 0, kept = 0, volume = 0;
        for (std::uint64_t trial = 0; trial < 60; ++trial) {
            oracle::NearMisses random(trial);
            const double offset = trial % 5 == 4 ? 1e6 : 0.0;
            ShadowScene scene(random, offset);
            cull::CasterFilter set;
            const int kind = int(trial % 3);
            if (scene.seen.empty()) continue;
            const glm::dvec3 toward = random.direction();
            const glm::dvec3 place = scene.view.origin + random.number(0.0, 20.0) * random.direction();
            const glm::dvec3 aim = scene.seen[random.index(std::uint32_t(scene.seen.size()))] - place;
            const cull::SpotLight lamp{place, glm::vec3(aim), float(random.number(0.0, 0.9)),
                                       float(random.number(0.5, 3.0) * glm::length(aim))};
            const double length = random.index(2) ? 1e9 : random.number(1.0, 40.0);
            const Sphere sphere{lamp.apex, double(lamp.range)};
            REQUIRE((kind == 0   ? set.set_sun(scene.view, scene.receivers, toward, length)
                     : kind == 1 ? set.set_point(scene.view, scene.receivers, sphere)
                                 : set.set_spot(scene.view, scene.receivers, lamp))
                        .has_value());
            // None where the light sees into the view from everywhere.
            const Result<Frustum> from_light = kind == 0 ? cull::shadow_volume(scene.view, toward)
                                                         : cull::shadow_volume_of_point(scene.view, lamp.apex);
            const double margin = 1e-12 * (1.0 + offset);
            // Half of them beside the way from a point to the light.
            for (std::size_t i = 0; i < scene.casters.size(); i += 2) {
                const glm::dvec3 point = scene.seen[random.index(std::uint32_t(scene.seen.size()))];
                const glm::dvec3 way = kind == 0 ? 20.0 * toward : lamp.apex - point;
                Obb& caster = scene.casters[i];
                const double size = random.number(0.0, 2.0) * glm::length(glm::dvec3(caster.half_extents));
                caster.center = point + random.number(0.0, 1.0) * way + size * random.direction();
            }
            for (const Obb& caster : scene.casters) {
                bool casts = false;
                for (const glm::dvec3& point : scene.seen) {
                    if (kind == 0) {
                        casts = way_meets(caster, point, std::min(length, 1e3) * toward, margin);
                    } else {
                        const glm::dvec3 way = lamp.apex - point;
                        if (glm::length(way) > sphere.radius) continue;
                        if (kind == 2 && glm::dot(-way, glm::dvec3(lamp.axis)) < double(lamp.cos_half_angle) *
                                                                                     glm::length(way) *
                                                                                     glm::length(glm::dvec3(lamp.axis)))
                            continue;
                        casts = way_meets(caster, point, way, margin);
                    }
                    if (casts) break;
                }
                const bool wants = set.wants(caster);
                CAPTURE(trial);
                REQUIRE((wants || !casts));
                casting += casts;
                kept += wants;
                volume += !from_light || cull::classify(*from_light, caster) != cull::Verdict::outside;
            }
        }
        CAPTURE(casting);
        CAPTURE(kept);
        CAPTURE(volume);
        CHECK(casting > 500);
        CHECK(double(kept) < 1.3 * double(casting));
        CHECK(double(volume) > 1.7 * double(casting));
    }

    TEST_CASE("a beam that ends at the light is wanted, whichever way it points") {
        const Frustum view = *frustum_of(Camera{});
        const std::vector<Obb> receivers{{.center = {1.5, 0.0, -5.0}, .half_extents = glm::vec3(0.5f)}};
        const glm::dvec3 light(0.0, 4.0, -5.0);
        cull::CasterFilter of_point, of_spot;
        REQUIRE(of_point.set_point(view, receivers, {light, 20.0}).has_value());
        REQUIRE(of_spot.set_spot(view, receivers, {.apex = light, .axis = {0.0f, -1.0f, 0.0f}, .range = 20.0f}));
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                Obb beam{.center = light};
                beam.half_extents[axis] = 2.0f;
                beam.center[axis] += 2.0 * side;
                CHECK(of_point.wants(beam));
                CHECK(of_spot.wants(beam));
                beam.center[axis] += 4.0 * side;  // now it begins where the first one ends
                CHECK(!of_point.wants(beam));
            }
    }

    TEST_CASE("a direction towards the sun may have any length") {
        oracle::NearMisses random(7);
        const ShadowScene scene(random, 0.0);
        const glm::dvec3 toward(0.375, 1.0, 0.25);
        cull::CasterFilter set;
        Vector<std::uint32_t> expected, casters;
        REQUIRE(set.set_sun(scene.view, scene.receivers, toward).has_value());
        set.find_casters(scene.casters, expected);
        CHECK(expected.size() > 0);
        const Camera cascade = *cull::cascade_camera(Camera{}, 1.0, 2.0, toward, 1.0);
        for (const int exponent : {160, 1020, -160, -540, -1060}) {
            CAPTURE(exponent);
            const glm::dvec3 scaled = std::ldexp(1.0, exponent) * toward;
            REQUIRE(set.set_sun(scene.view, scene.receivers, scaled).has_value());
            set.find_casters(scene.casters, casters);
            CHECK(casters == expected);
            const auto camera = cull::cascade_camera(Camera{}, 1.0, 2.0, scaled, 1.0);
            REQUIRE(camera.has_value());
            CHECK(camera->forward == cascade.forward);
            CHECK(camera->position == cascade.position);
        }
    }

    TEST_CASE("setting receivers again allocates nothing") {
        oracle::NearMisses random(2);
        const ShadowScene scene(random, 0.0);
        const testing::CountingMemory counting;
        cull::CasterFilter set;
        Vector<std::uint32_t> casters;
        std::size_t warm = 0;
        for (int frame = 0; frame < 4; ++frame) {
            REQUIRE(set.set_point(scene.view, scene.receivers, {scene.view.origin, 50.0}).has_value());
            set.find_casters(scene.casters, casters);
            REQUIRE(set.set_sun(scene.view, scene.receivers, {0.3, 1.0, 0.2}).has_value());
            set.find_casters(scene.casters, casters);
            if (frame == 1) warm = counting.allocations();
        }
        CHECK(counting.allocations() == warm);
    }
}

TEST_SUITE("cull/cascades") {
    TEST_CASE("splits are those of the practical scheme, and bad numbers are refused") {
        std::array<double, 5> splits{};
        REQUIRE(cull::split_depths(1.0, 16.0, 1.0, splits).has_value());
        for (std::size_t i = 0; i < 5; ++i) CHECK(splits[i] == doctest::Approx(double(1 << i)));
        REQUIRE(cull::split_depths(1.0, 17.0, 0.0, splits).has_value());
        for (std::size_t i = 0; i < 5; ++i) CHECK(splits[i] == doctest::Approx(1.0 + 4.0 * double(i)));
        REQUIRE(cull::split_depths(1.0, 16.0, 0.5, splits).has_value());
        CHECK(splits[2] == doctest::Approx(0.5 * (4.0 + 8.5)));
        CHECK(splits[0] == 1.0);
        CHECK(splits[4] == 16.0);
        CHECK(!cull::split_depths(0.0, 16.0, 0.5, splits).has_value());
        CHECK(!cull::split_depths(1.0, 1.0, 0.5, splits).has_value());
        CHECK(!cull::split_depths(1.0, std::nan(""), 0.5, splits).has_value());
        CHECK(!cull::split_depths(1e-300, 1e300, 0.5, splits).has_value());  // the ratio is beyond any double
        CHECK(cull::split_depths(1e-150, 1e150, 1.0, splits).has_value());
        for (std::size_t i = 0; i < 5; ++i) CHECK(std::isfinite(splits[i]));
        CHECK(!cull::split_depths(1.0, 16.0, 1.5, splits).has_value());
        CHECK(!cull::split_depths(1.0, 16.0, 0.5, std::span(splits).first(1)).has_value());
    }

    TEST_CASE("a cascade's camera contains its part of the view and is no wider than needed") {
        oracle::NearMisses random(6);
        for (int trial = 0; trial < 300; ++trial) {
            const Camera camera = random.camera();
            const double near = camera.near_distance + 0.3, far = camera.far_distance - 0.3, length = 10.0;
            const glm::dvec3 toward = random.direction();
            const Camera light = *cull::cascade_camera(camera, near, far, toward, length);
            const Frustum around = *frustum_of(light);
            Camera part = camera;
            part.near_distance = near;
            part.far_distance = far;
            const Frustum seen = *frustum_of(part);
            const auto points = *frustum_corners(seen);
            double least[6];
            std::fill_n(least, 6, 1e300);
            for (const glm::dvec3& corner : points)
                for (std::size_t i = 0; i < 6; ++i)
                    least[i] =
                        std::min(least[i], glm::dot(around.planes[i].normal, seen.origin + corner - around.origin) +
                                               around.planes[i].offset);
            // Every side touches what is seen, but for the near one, which is the casters' distance away.
            for (std::size_t i = 0; i < 6; ++i) {
                CHECK(least[i] >= 0.0);
                CHECK(least[i] <= (i == 4 ? length : 0.0) + 1e-5);
            }
            // No rectangle turned otherwise is smaller.
            for (int turn = 0; turn < 90; ++turn) {
                const double angle = 0.0174532925 * turn;
                const glm::dmat3 rotation = world_to_view_rotation(light);
                glm::dvec2 low(1e300), high(-1e300);
                for (const glm::dvec3& corner : points) {
                    const glm::dvec3 p = rotation * corner;
                    const glm::dvec2 at(std::cos(angle) * p.x + std::sin(angle) * p.y,
                                        std::cos(angle) * p.y - std::sin(angle) * p.x);
                    low = glm::min(low, at);
                    high = glm::max(high, at);
                }
                CHECK((high.x - low.x) * (high.y - low.y) >= light.height * light.height * light.aspect * (1.0 - 1e-5));
            }
        }
        CHECK(!cull::cascade_camera(Camera{}, 5.0, 2.0, {0.0, 1.0, 0.0}, 1.0).has_value());
        CHECK(!cull::cascade_camera(Camera{}, 1.0, 2.0, glm::dvec3(0.0), 1.0).has_value());
        CHECK(!cull::cascade_camera(Camera{}, 1.0, 2.0, {0.0, 1.0, 0.0}, -1.0).has_value());
    }
}
