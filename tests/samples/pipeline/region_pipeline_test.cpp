// SPDX-License-Identifier: MIT
// Flights over a folder of regions, and what a bake of one depends on.
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <chrono>
#include <region_folder.hpp>
#include <thread>

#include "commands/region_state.hpp"
#include "pipeline/region_pipeline.hpp"
#include "pipeline/verify.hpp"

using namespace crofton;

namespace {

constexpr std::uint32_t kCells = 16;
constexpr double kCell = 20.0;

float half_of(std::uint32_t cell) {
    return 0.5f + 0.01f * static_cast<float>(cell);
}

// Cubes in cells along x: in each cell four of a size of its own, and one as in all others.
assets::SceneSource row_of_cells() {
    assets::SceneSource source;
    const auto common = source.scene.add_mesh(testing::cube_mesh(0.25f)).value();
    for (std::uint32_t cell = 0; cell < kCells; ++cell) {
        const auto own = source.scene.add_mesh(testing::cube_mesh(half_of(cell))).value();
        for (int i = 0; i < 5; ++i) {
            const glm::dvec3 at(kCell * cell + 3.0 * i, 0.0, 0.0);
            const auto node = source.scene.add_node(scene::kNone, {glm::dmat3(1.0), at}).value();
            REQUIRE(source.scene.add_instance(node, i == 0 ? common : own));
        }
    }
    source.scene.update();
    return source;
}

struct Regions : testing::RegionFolder {
    explicit Regions(const scene::Scene& scene) : RegionFolder(scene, kCells, 1) {}
};

std::size_t held_meshes(const pipeline::Drawables& drawables) {
    std::size_t count = 0;
    for (scene::MeshId mesh = 0; mesh < drawables.mesh_count(); ++mesh) count += !drawables.mesh(mesh).indices.empty();
    return count;
}

}  // namespace

TEST_SUITE("pipeline/region_pipeline") {
    TEST_CASE("a flight holds the meshes of regions that are near, and every object keeps its own") {
        const assets::SceneSource source = row_of_cells();
        const Regions folder(source.scene);
        pipeline::RegionPipelineOptions options;
        options.stream.distance = kCell;
        options.stream.meshes = true;
        options.picture = depth::PictureView{};
        auto flight = pipeline::RegionPipeline::open(folder.path, options).value();
        Camera camera;
        camera.forward = {1.0, -0.1, 0.0};
        std::size_t seen = 0, most_slots = 0;
        std::uint64_t revision = 0;
        for (const bool back : {false, true})
            for (std::uint32_t step = 0; step < kCells; ++step) {
                camera.position = {kCell * (back ? kCells - 1 - step : step), 2.0, 0.0};
                const auto frame = flight.run(camera, serial_executor()).value();
                const auto drawables = flight.drawables();
                for (const scene::InstanceId id : frame.visible_ids) {
                    const glm::dvec3 at = drawables->world_of(id).translation;
                    const auto cell = static_cast<std::uint32_t>((at.x + 1.0) / kCell);
                    const bool is_common = std::abs(at.x - kCell * cell) < 1.0;
                    const scene::MeshId mesh = drawables->mesh_of(id);
                    REQUIRE(drawables->mesh(mesh).positions.size() == 8);
                    CHECK(std::abs(drawables->mesh(mesh).positions[0].x) == (is_common ? 0.25f : half_of(cell)));
                    CHECK(flight.clusters()->meshes[mesh]->largest().x == (is_common ? 0.25f : half_of(cell)));
                }
                seen += frame.visible_ids.size();
                most_slots = std::max(most_slots, drawables->mesh_count());
            }
        CHECK(seen > 5 * kCells);
        CHECK(most_slots < kCells);
        // What has gone is freed by the thread that loads. Three regions at most are near, and the mesh of all.
        for (int wait = 0; held_meshes(*flight.drawables()) > 4 && wait < 1000; ++wait) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            REQUIRE(flight.run(camera, serial_executor()));
        }
        CHECK(held_meshes(*flight.drawables()) <= 4);
        CHECK(held_meshes(*flight.drawables()) >= 2);
        revision = flight.mesh_revision();
        REQUIRE(flight.run(camera, serial_executor()));
        CHECK(flight.mesh_revision() == revision);
    }

    TEST_CASE("frames over regions agree with clipping every triangle of every object, and a wrong frame does not") {
        assets::SceneSource source = row_of_cells();
        for (const scene::InstanceId hidden : {7u, 23u}) REQUIRE(source.scene.set_instance_layers(hidden, 0));
        source.scene.update();
        const Regions folder(source.scene);
        pipeline::RegionPipelineOptions options;
        options.stream.distance = 2.0 * kCell;
        auto flight = pipeline::RegionPipeline::open(folder.path, options).value();
        const auto verified = [&](const pipeline::FrameStatistics& frame) {
            pipeline::Verification verification;
            pipeline::verify_frame(flight, frame, true, verification);
            return verification;
        };
        Camera camera;
        std::uint64_t seen = 0;
        for (std::uint32_t step = 0; step < 2 * kCells; ++step) {
            camera.position = {0.5 * kCell * step, 1.0, 0.0};
            camera.forward = {step % 3 == 0 ? -1.0 : 1.0, -0.05, 0.2 * (step % 5) - 0.4};
            const auto frame = flight.run(camera, serial_executor()).value();
            const pipeline::Verification right = verified(frame);
            CHECK_MESSAGE(right.mismatches() == 0, right.messages.size());
            CHECK(right.frames == 1);
            seen += frame.visible;
        }
        CHECK(seen > 100);
        camera.position = {0.5 * kCell, 1.0, 0.0};
        camera.forward = {1.0, 0.0, 0.0};
        const auto frame = flight.run(camera, serial_executor()).value();
        REQUIRE(frame.visible > 2);
        pipeline::FrameStatistics wrong = frame;
        ++wrong.visible;
        CHECK(verified(wrong).wrong_counts == 1);
        wrong = frame;
        ++wrong.triangles_passed;
        CHECK(verified(wrong).wrong_counts == 1);
        // Another camera: what it sees was culled, and so was a region that is not attached.
        wrong = frame;
        wrong.camera.position.x += 10.0;
        CHECK(verified(wrong).wrong_verdicts > 0);
        wrong = frame;
        wrong.camera.far_distance = 1000.0;
        const pipeline::Verification far = verified(wrong);
        CHECK(far.culled_but_visible > 0);
        CHECK(std::any_of(far.messages.begin(), far.messages.end(),
                          [](const std::string& m) { return m.find("was not attached") != std::string::npos; }));
    }

    TEST_CASE("a bake is resumed only if nothing differs on which the bytes of its files depend") {
        const assets::SceneSource source = row_of_cells();
        const auto key_of = [](const assets::SceneSource& scene, const bake::BakeOptions& options) {
            return cli::region_key(scene, 4, 2, options, serial_executor());
        };
        bake::BakedOccluders found;
        found.kinds.push_back(occlude::find_occluders(source.scene.mesh(1)).value().occluders);
        REQUIRE(found.kinds[0].size() == 1);
        found.nodes = {{1, 0}, {2, 0}};
        bake::BakedOccluders fewer = found, smaller = found, others = found, without = found;
        fewer.nodes.pop_back();
        smaller.kinds[0][0].surface.positions[0] *= 0.5f;
        others.kinds[0][0].eyes_within = {glm::dvec3(-50.0), glm::dvec3(50.0)};
        without.kinds[0].clear();
        bake::BakedOccluders same = found;
        std::vector<std::uint64_t> keys{key_of(source, {}), cli::region_key(source, 2, 4, {}, serial_executor()),
                                        key_of(source, {.tree = boxtree::Orientation::oriented}),
                                        key_of(source, {.clusters = false})};
        for (const bake::BakedOccluders* occluders : {&found, &fewer, &smaller, &others, &without})
            keys.push_back(key_of(source, {.occluders = occluders}));
        CHECK(key_of(source, {.occluders = &same}) == key_of(source, {.occluders = &found}));
        CHECK(key_of(row_of_cells(), {}) == keys[0]);
        assets::SceneSource looks = row_of_cells(), layers = row_of_cells();
        looks.flat = {1};
        REQUIRE(layers.scene.set_instance_layers(3, 2));
        layers.scene.update();
        keys.push_back(key_of(looks, {}));
        keys.push_back(key_of(layers, {}));
        for (std::size_t i = 0; i < keys.size(); ++i)
            for (std::size_t k = 0; k < i; ++k) CHECK_MESSAGE(keys[i] != keys[k], i, " as ", k);
    }
}
