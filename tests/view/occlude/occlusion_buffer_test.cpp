// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/occlude/occlusion.hpp>
#include <error_of.hpp>
#include <oracle/occlusion_scenes.hpp>
#include <oracle/witness_rays.hpp>

using namespace crofton;
using namespace crofton::test;

namespace {

occlude::OcclusionBuffer drawn(const OcclusionScene& scene, const occlude::OccluderSet& set) {
    auto buffer = *occlude::OcclusionBuffer::create(scene.size);
    buffer.draw(set, *occlude::occlusion_view_of(scene.camera));
    return buffer;
}

struct PictureCheck {
    std::size_t covered = 0, rays = 0, wrong = 0;
};

// Rays at the corners of covered squares and within must meet an occluder's front, no farther than the depth says.
PictureCheck check_picture(Random& random, const OcclusionScene& scene) {
    const occlude::OccluderSet set = set_of(scene.occluders);
    const auto buffer = drawn(scene, set);
    PictureCheck result;
    constexpr double kInset = 1e-7;
    for (std::uint32_t y = 0; y < scene.size.height; ++y)
        for (std::uint32_t x = 0; x < scene.size.width; ++x) {
            const float nearness = buffer.nearness(x, y);
            if (nearness < -1e38f) continue;
            ++result.covered;
            for (int i = 0; i < 3; ++i) {
                const double u = i == 2 ? random.uniform() : pick(random, 2) ? kInset : 1.0 - kInset;
                const double v = i == 2 ? random.uniform() : pick(random, 2) ? kInset : 1.0 - kInset;
                const double distance = distance_of(scene.camera, nearness);
                const oracle::WitnessRay ray = ray_through(scene, x + u, y + v, distance);
                ++result.rays;
                result.wrong += oracle::is_free(ray, scene.occluders);
            }
        }
    return result;
}

struct WitnessCheck {
    std::size_t hidden = 0, free = 0, culled = 0;
};

WitnessCheck check_objects(Random& random, const OcclusionScene& scene) {
    const occlude::OccluderSet set = set_of(scene.occluders);
    const auto buffer = drawn(scene, set);
    std::vector<std::uint64_t> bits((scene.objects.size() + 63) / 64);
    buffer.find_hidden(scene.objects, bits);
    const Frustum frustum = buffer.view().frustum;
    WitnessCheck result;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const bool hidden = bits[i / 64] >> (i % 64) & 1;
        result.hidden += hidden;
        for (int n = 0; n < 12; ++n) {
            const glm::dvec3 point = point_of(random, scene.objects[i]);
            if (!is_in_view(frustum, point) || !oracle::is_free(ray_to(scene.camera, point), scene.occluders)) continue;
            ++result.free;
            result.culled += hidden;
        }
    }
    return result;
}

}  // namespace

TEST_SUITE("occlude/occlusion_buffer") {
    TEST_CASE("sizes beyond the limits are refused") {
        for (const occlude::BufferSize size : {occlude::BufferSize{0, 100}, {7, 8}, {8, 7}, {8, 4097}, {~0u, ~0u}})
            CHECK(error_of(occlude::OcclusionBuffer::create(size)).code == ErrorCode::out_of_range);
        CHECK(occlude::OcclusionBuffer::create({8, 8}));
    }

    TEST_CASE("a buffer that has not been drawn hides nothing, nor does one without occluders") {
        auto buffer = *occlude::OcclusionBuffer::create();
        Obb box;
        box.center = {0.0, 0.0, -10.0};
        box.half_extents = {1.0f, 1.0f, 1.0f};
        CHECK(!buffer.hides(box));
        buffer.draw(occlude::OccluderSet(), *occlude::occlusion_view_of(Camera{}));
        CHECK(!buffer.hides(box));
    }

    TEST_CASE("a wall hides the objects behind it, and none in front of, next to or across it") {
        OcclusionScene scene;
        scene.occluders.resize(1);
        scene.occluders[0].center = {0.0, 0.0, -10.0};
        scene.occluders[0].half_extents = {2.0f, 2.0f, 0.5f};
        const occlude::OccluderSet set = set_of(scene.occluders);
        const auto buffer = drawn(scene, set);
        const auto box = [](double x, double z) {
            Obb result;
            result.center = {x, 0.0, z};
            result.half_extents = {0.5f, 0.5f, 0.5f};
            return result;
        };
        CHECK(buffer.hides(box(0.0, -12.0)));
        CHECK(buffer.hides(box(1.5, -20.0)));
        CHECK(!buffer.hides(box(0.0, -8.0)));
        CHECK(!buffer.hides(box(0.0, -9.7)));   // its front is before the wall's
        CHECK(!buffer.hides(box(2.2, -12.0)));  // beyond its shadow's edge by a part
        CHECK(!buffer.hides(box(9.0, -12.0)));
        CHECK(!buffer.hides(box(0.0, 5.0)));  // behind the eye
        CHECK(!buffer.hides(box(0.0, 0.0)));  // around it
        Obb bad = box(0.0, -12.0);
        bad.center.x = NAN;
        CHECK(!buffer.hides(bad));
    }

    TEST_CASE("no ray passes a covered pixel") {
        Random random(1);
        std::size_t covered = 0;
        for (const double offset : {0.0, 1e3, 1e5, 1e7})
            for (int trial = 0; trial < 12; ++trial) {
                CAPTURE(offset);
                CAPTURE(trial);
                const PictureCheck check = check_picture(random, random_scene(random, offset, 0));
                covered += check.covered;
                CHECK(check.wrong == 0);
            }
        CHECK(covered > 100'000);
    }

    TEST_CASE("no object that a witness ray sees is hidden") {
        Random random(2);
        std::size_t hidden = 0, free = 0;
        for (const double offset : {0.0, 1e3, 1e5, 1e7})
            for (int trial = 0; trial < 40; ++trial) {
                CAPTURE(offset);
                CAPTURE(trial);
                OcclusionScene scene = random_scene(random, offset, 300);
                scene.size = trial % 4 == 0   ? occlude::BufferSize{64, 40}
                             : trial % 4 == 1 ? occlude::BufferSize{640, 360}
                             : trial % 4 == 2 ? occlude::BufferSize{333, 201}
                                              : scene.size;
                const WitnessCheck check = check_objects(random, scene);
                hidden += check.hidden;
                free += check.free;
                CHECK(check.culled == 0);
            }
        MESSAGE(hidden << " hidden, " << free << " free rays");
        CHECK(hidden > 5'000);
        CHECK(free > 100'000);
    }
}
