// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <box_mesh.hpp>

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
        auto frame = pipeline->run(Camera{});
        REQUIRE(frame.has_value());
        CHECK(frame->colliding_pairs == 19);
        CHECK(frame->visible > 5);
        CHECK(frame->visible < 20);

        const auto mismatches = [&](const FrameStatistics& tampered) {
            Verification verification;
            verify_frame(row.scene, *pipeline, options, tampered, true, verification);
            return verification;
        };
        CHECK(mismatches(*frame).mismatches() == 0);

        FrameStatistics lost_pair = *frame;
        lost_pair.colliding_ids.pop_back();
        CHECK(mismatches(lost_pair).wrong_pairs > 0);
        FrameStatistics invented_pair = *frame;
        invented_pair.colliding_ids.back() = {0, 19};
        CHECK(mismatches(invented_pair).wrong_pairs > 0);
        FrameStatistics miscounted = *frame;
        ++miscounted.triangles_passed;
        CHECK(mismatches(miscounted).wrong_counts > 0);
        FrameStatistics misdrawn = *frame;
        misdrawn.gpu = render::GpuCounters{frame->triangles_submitted, frame->triangles_submitted,
                                           frame->triangles_clipped + 1, 0};
        CHECK(mismatches(misdrawn).wrong_counts == 1);
        // Another camera than the one the pipeline answered for: verdicts and counts cannot fit.
        FrameStatistics elsewhere = *frame;
        elsewhere.camera.forward = {0.0, 0.0, 1.0};
        CHECK(mismatches(elsewhere).culled_but_visible > 0);
        CHECK(mismatches(elsewhere).wrong_verdicts > 0);
        CHECK_FALSE(mismatches(elsewhere).messages.empty());
    }
}
