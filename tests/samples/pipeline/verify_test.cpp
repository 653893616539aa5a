// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <cmath>
#include <random>

#include "pipeline/camera_path.hpp"
#include "pipeline/verify.hpp"

using namespace crofton;
using namespace crofton::pipeline;

namespace {

// A row of cubes along −z, each 1.5 apart and so overlapping its neighbours, with the camera at the origin.
struct Row {
    scene::Scene scene;
    std::vector<scene::InstanceId> all;

    Row() {
        const auto mesh = scene.add_mesh(testing::cube_mesh());
        for (int i = 0; i < 20; ++i) {
            const auto node = scene.add_node(scene::kNone, {glm::dmat3(1.0), {0.0, 0.0, 10.0 - 1.5 * i}});
            all.push_back(*scene.add_instance(*node, *mesh));
        }
        scene.update();
    }
};

}  // namespace

TEST_SUITE("pipeline/verify") {
    TEST_CASE("a right frame has no mismatch, and every kind of wrong frame has one") {
        Row row;
        const PipelineOptions options;
        auto pipeline = Pipeline::create(row.scene, row.all, options, serial_executor());
        REQUIRE(pipeline.has_value());
        auto frame = pipeline->run(Camera{}).value();
        CHECK(frame.colliding_pairs == 19);
        CHECK(frame.visible > 5);
        CHECK(frame.visible < 20);

        const auto mismatches = [&](const FrameStatistics& tampered) {
            Verification verification;
            verify_frame(row.scene, *pipeline, options, tampered, true, verification);
            return verification;
        };
        CHECK(mismatches(frame).mismatches() == 0);

        FrameStatistics lost_pair = frame;
        lost_pair.colliding_ids.pop_back();
        CHECK(mismatches(lost_pair).wrong_pairs > 0);
        FrameStatistics invented_pair = frame;
        invented_pair.colliding_ids.back() = {0, 19};
        CHECK(mismatches(invented_pair).wrong_pairs > 0);
        FrameStatistics miscounted = frame;
        ++miscounted.triangles_passed;
        CHECK(mismatches(miscounted).wrong_counts > 0);
        FrameStatistics misdrawn = frame;
        misdrawn.gpu =
            render::GpuCounters{frame.triangles_submitted, frame.triangles_submitted, frame.triangles_clipped + 1, 0};
        CHECK(mismatches(misdrawn).wrong_counts == 1);
        // Another camera than the one the pipeline answered for: verdicts and counts cannot fit.
        FrameStatistics elsewhere = frame;
        elsewhere.camera.forward = {0.0, 0.0, 1.0};
        CHECK(mismatches(elsewhere).culled_but_visible > 0);
        CHECK(mismatches(elsewhere).wrong_verdicts > 0);
        CHECK_FALSE(mismatches(elsewhere).messages.empty());
    }

    TEST_CASE("a hidden object is no mismatch: scaled to nothing, or out of the range of coordinates") {
        for (const CullMode mode : {CullMode::tree, CullMode::flat, CullMode::none})
            for (const BoundsKind kind : {BoundsKind::obb_perimeter, BoundsKind::aabb, BoundsKind::sphere}) {
                CAPTURE(std::string(to_string(mode)));
                CAPTURE(std::string(to_string(kind)));
                Row row;
                const auto far = row.scene.add_node(scene::kNone, {glm::dmat3(1e15), {0.0, 0.0, -9.0}});
                const auto farther = row.scene.add_node(*far, {glm::dmat3(1e15), glm::dvec3(0.0)});
                const auto farthest = row.scene.add_node(*farther, {glm::dmat3(1e15), glm::dvec3(0.0)});
                const auto nothing = row.scene.add_node(scene::kNone, {glm::dmat3(0.0), {0.0, 0.0, -9.0}});
                const auto beyond = row.scene.add_instance(*farthest, 0), point = row.scene.add_instance(*nothing, 0);
                row.scene.update();
                const Aabb focus = focus_of(row.scene);
                CHECK(focus.max.x == 1.0);
                const PipelineOptions options{.bounds = kind, .cull = mode};
                auto pipeline = Pipeline::create(row.scene, {}, options, serial_executor()).value();
                auto frame = pipeline.run(Camera{});
                REQUIRE(frame.has_value());
                CHECK(pipeline.verdicts()[*beyond] == cull::Verdict::outside);
                CHECK(pipeline.verdicts()[*point] == cull::Verdict::outside);
                Verification verification;
                verify_frame(row.scene, pipeline, options, *frame, true, verification);
                CHECK(verification.mismatches() == 0);
                // Back again.
                REQUIRE(row.scene.set_local(*farthest, {glm::dmat3(1e-30), glm::dvec3(0.0)}).has_value());
                row.scene.update();
                frame = pipeline.run(Camera{});
                REQUIRE(frame.has_value());
                CHECK(pipeline.verdicts()[*beyond] != cull::Verdict::outside);
                Verification again;
                verify_frame(row.scene, pipeline, options, *frame, true, again);
                CHECK(again.mismatches() == 0);
            }
    }

    // Terms of a million cancel, so that what is rounded is far larger than what is left.
    TEST_CASE("spheres and boxes hold the exact points of meshes that lie far from their own origin") {
        std::mt19937_64 random(5);
        const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0; };
        const auto vector = [&] { return glm::dvec3(number(), number(), number()); };
        for (int trial = 0; trial < 200; ++trial) {
            TriangleMesh mesh;
            const glm::dvec3 base = 1e6 * vector();
            for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(base + vector());
            mesh.indices = {0, 1, 2};
            const glm::dmat3 linear = trial % 2 == 0 ? glm::dmat3(number()) : glm::dmat3(vector(), vector(), vector());
            scene::Scene scene;
            const auto node = scene.add_node(scene::kNone, {linear, vector() - linear * base});
            REQUIRE(scene.add_instance(*node, *scene.add_mesh(mesh)).has_value());
            scene.update();
            const Transform& world = scene.world(0);
            const Bounds spheres(scene, BoundsKind::sphere), boxes(scene, BoundsKind::aabb);
            const Sphere& sphere = spheres.spheres()[0];
            const Obb& box = boxes.boxes()[0];
            for (const glm::vec3& p : mesh.positions) {
                long double squared = 0.0L;
                for (int axis = 0; axis < 3; ++axis) {
                    long double q = world.translation[axis];
                    for (int k = 0; k < 3; ++k)
                        q += static_cast<long double>(world.linear[k][axis]) * static_cast<long double>(p[k]);
                    const long double from_sphere = q - sphere.center[axis], from_box = q - box.center[axis];
                    squared += from_sphere * from_sphere;
                    CHECK(std::abs(from_box) <= static_cast<long double>(box.half_extents[axis]));
                }
                CHECK(std::sqrt(squared) <= static_cast<long double>(sphere.radius));
            }
        }
    }
}
