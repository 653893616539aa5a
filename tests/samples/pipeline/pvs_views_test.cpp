// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/executor.hpp>
#include <error_of.hpp>
#include <utility>

#include "pipeline/pvs_scene.hpp"
#include "pipeline/pvs_views.hpp"

using namespace crofton;

namespace {

// Object 0 is a floor of 200 × 200 m under an open sky, of two triangles. Object 1 is a triangle 1,000 m below, which
// no level view has in its frustum. Eyes are 2.8 m high.
struct Plain {
    assets::SceneSource source;
    pipeline::PvsScene scene;
    // Between the cells and all that lies below.
    occlude::FoundOccluder sheet;

    // With walls as high as 5 m along x, so far from each other; 0: none.
    explicit Plain(float wall_distance = 0.0f) {
        TriangleMesh floor, below;
        floor.positions = {{-100, 0, -100}, {-100, 0, 100}, {100, 0, 100}, {100, 0, -100}};
        floor.indices = {0, 1, 2, 0, 2, 3};
        if (wall_distance > 0.0f)
            for (float z = -100.0f; z <= 100.0f; z += wall_distance) {
                const auto first = static_cast<std::uint32_t>(floor.positions.size());
                for (const float x : {-100.0f, 100.0f})
                    for (const float y : {0.0f, 5.0f}) floor.positions.push_back({x, y, z});
                for (const std::uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u}) floor.indices.push_back(first + corner);
            }
        below.positions = {{0, -1000, 0}, {1, -1000, 0}, {0, -1000, 1}};
        below.indices = {0, 1, 2};
        for (TriangleMesh* mesh : {&floor, &below}) {
            const auto node = source.scene.add_node(scene::kNone, {});
            REQUIRE(source.scene.add_instance(*node, *source.scene.add_mesh(std::move(*mesh))).has_value());
        }
        source.scene.update();
        scene = pipeline::make_pvs_scene(source, false).value();
        sheet.box.half_extents = glm::vec3(500.0f, 0.2f, 500.0f);
        sheet.piece_bounds = {{-500.0, -0.2, -500.0}, {500.0, 0.2, 500.0}};
    }

    // Sets of cells above the floor. Swapped: each object is taken for the other, so that nothing saw the floor.
    pvs::Pvs sets(bool swapped, bool with_sheet) const {
        pvs::BakeGeometry geometry = scene.geometry;
        if (swapped) {
            for (std::uint32_t& object : geometry.object_of) object = 1 - object;
            std::swap(geometry.boxes[0], geometry.boxes[1]);
        }
        const auto cells = pvs::Cells::grid({{-100, 1, -100}, {100, 20, 100}}, {3, 1, 3}).value();
        auto bake = pvs::Bake::create(geometry, cells, {.epsilon = 1e-2}).value();
        REQUIRE(bake.run().has_value());
        const pvs::PlacedOccluder placed{&sheet, {glm::dmat3(1.0), {0.0, 0.5, 0.0}}};
        return pvs::Pvs::finish(bake, std::span(&placed, with_sheet ? 1 : 0), {.near_radius = 0.0}).value();
    }

    Result<pipeline::PvsViewFigures> look(const pvs::Pvs& sets, const pipeline::PvsViewOptions& options = {.views = 50},
                                          Executor& executor = serial_executor()) const {
        return pipeline::look_at_views(source.scene, scene.geometry, sets, options, executor);
    }
};

}  // namespace

TEST_SUITE("pipeline/pvs_views") {
    TEST_CASE("if lines have seen the floor no pixel is wrong, and only its two triangles are drawn") {
        const Plain plain;
        const auto seen = plain.look(plain.sets(false, false));
        REQUIRE_MESSAGE(seen.has_value(), error_of(seen).message);
        CHECK(seen->views == 50);
        CHECK(seen->in_no_cell == 0);
        // A view from beside the edge may look away from the floor.
        CHECK(seen->owner_triangles > 1.9);
        CHECK(seen->owner_triangles <= 2.0);
        CHECK(seen->frustum_triangles == seen->owner_triangles);
        for (const pipeline::PvsModeFigures& mode : {seen->conservative, seen->statistical}) {
            CHECK(mode.wrong_mean == 0.0);
            CHECK(mode.wrong_worst == 0.0);
            CHECK(mode.triangles == seen->owner_triangles);
        }
    }

    TEST_CASE("no near plane cuts a wall: where all are nearer than it reaches there is no view") {
        // The near plane is 0.1 m from the eye, and its corners 0.155 m.
        const Plain corridors(0.3f);
        const auto refused = corridors.look(corridors.sets(false, false));
        REQUIRE_FALSE(refused.has_value());
        CHECK(refused.error().code == ErrorCode::empty);
        CHECK(corridors.look(corridors.sets(false, false), {.views = 20, .near_radius = 0.05}).has_value());
        const Plain wider(0.4f);
        CHECK(wider.look(wider.sets(false, false), {.views = 20}).has_value());
    }

    TEST_CASE("a floor that nothing saw is nearly half of each level picture, and wrong in statistical mode alone") {
        const Plain plain;
        const auto looked = plain.look(plain.sets(true, false));
        REQUIRE_MESSAGE(looked.has_value(), error_of(looked).message);
        // Below the horizon, but for what is seen beyond the floor's edge.
        CHECK(looked->statistical.wrong_mean > 0.4);
        CHECK(looked->statistical.wrong_worst <= 0.5);
        CHECK(looked->statistical.wrong_worst > looked->statistical.wrong_mean);
        CHECK(looked->statistical.triangles == 0.0);
        CHECK(looked->conservative.wrong_worst == 0.0);
        CHECK(looked->conservative.triangles == looked->owner_triangles);
        CHECK(looked->owner_triangles > 1.9);
    }

    TEST_CASE("an object hidden by a false proof is wrong in conservative mode too") {
        const Plain plain;
        const auto looked = plain.look(plain.sets(true, true));
        REQUIRE_MESSAGE(looked.has_value(), error_of(looked).message);
        CHECK(looked->conservative.wrong_mean > 0.4);
        CHECK(looked->conservative.wrong_mean == looked->statistical.wrong_mean);
        CHECK(looked->conservative.triangles == 0.0);
    }

    TEST_CASE("eyes in cells that no line has passed get everything") {
        const Plain plain;
        const auto cells = pvs::Cells::grid({{-100, 1, -100}, {100, 20, 100}}, {3, 1, 3}).value();
        const auto bake = pvs::Bake::create(plain.scene.geometry, cells, {.epsilon = 1e-2}).value();
        const auto looked = plain.look(pvs::Pvs::finish(bake).value());
        CHECK(looked->in_no_cell == 50);
        CHECK(looked->statistical.wrong_worst == 0.0);
        CHECK(looked->statistical.triangles == looked->owner_triangles);
    }

    TEST_CASE("a wall hides at run time what a set holds, and no pixel of what is seen") {
        // Two boxes on the plain, 40 m high: one stands in front of the other for many eyes, and each is an occluder.
        Plain plain;
        for (const float x : {-30.0f, 30.0f}) {
            TriangleMesh box;
            for (int c = 0; c < 8; ++c)
                box.positions.push_back({x + (c & 1 ? 5.0f : -5.0f), c & 2 ? 40.0f : 0.0f, c & 4 ? 60.0f : -60.0f});
            box.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
            const auto node = plain.source.scene.add_node(scene::kNone, {});
            REQUIRE(plain.source.scene.add_instance(*node, *plain.source.scene.add_mesh(std::move(box))).has_value());
        }
        plain.source.scene.update();
        plain.scene = pipeline::make_pvs_scene(plain.source, true).value();
        REQUIRE(plain.scene.occluders.size() >= 2);
        const auto cells = pvs::Cells::grid({{-100, 1, -100}, {100, 20, 100}}, {3, 1, 3}).value();
        auto bake = pvs::Bake::create(plain.scene.geometry, cells, {.epsilon = 1e-3}).value();
        REQUIRE(bake.run().has_value());
        const pvs::Pvs sets = pvs::Pvs::finish(bake).value();
        const auto without = plain.look(sets, {.views = 60}),
                   with = plain.look(sets, {.views = 60, .occluders = plain.scene.found});
        REQUIRE_MESSAGE(with.has_value(), error_of(with).message);
        CHECK_FALSE(without->has_occlusion);
        CHECK(with->has_occlusion);
        CHECK(with->conservative.triangles == without->conservative.triangles);
        for (const pipeline::PvsModeFigures& way : {with->occlusion, with->conservative_and_occlusion}) {
            CHECK(way.wrong_worst == 0.0);
            CHECK(way.triangles >= with->owner_triangles);
            CHECK(way.triangles < with->conservative.triangles - 0.5);
        }
        CHECK(with->statistical_and_occlusion.wrong_worst == with->statistical.wrong_worst);
        CHECK(with->statistical_and_occlusion.triangles <= with->statistical.triangles);
        // Occluders that reach beyond their boxes hide these: then pixels are wrong.
        auto lies = *plain.scene.found;
        for (auto& kind : lies.kinds)
            for (auto& occluder : kind.found.occluders) {
                glm::vec3 middle(0.0f);
                for (const glm::vec3& corner : occluder.surface.positions)
                    middle += corner / static_cast<float>(occluder.surface.positions.size());
                for (glm::vec3& corner : occluder.surface.positions) corner = middle + 2.0f * (corner - middle);
                occluder.box.half_extents *= 2.0f;
            }
        const auto wrong =
            plain.look(sets, {.views = 60, .occluders = std::make_shared<const pipeline::SceneOccluders>(lies)});
        REQUIRE_MESSAGE(wrong.has_value(), error_of(wrong).message);
        CHECK(wrong->occlusion.wrong_worst > 0.0);
        CHECK(wrong->conservative_and_occlusion.wrong_worst > 0.0);
    }

    TEST_CASE("the same figures for any number of threads, others for another seed") {
        const Plain plain;
        const pvs::Pvs sets = plain.sets(true, false);
        ThreadPool pool(3);
        const auto one = plain.look(sets), three = plain.look(sets, {.views = 50}, pool),
                   other = plain.look(sets, {.views = 50, .seed = 2});
        CHECK(one->statistical.wrong_mean == three->statistical.wrong_mean);
        CHECK(one->statistical.wrong_worst == three->statistical.wrong_worst);
        CHECK(one->statistical.wrong_mean != other->statistical.wrong_mean);
    }

    TEST_CASE("no view, views of no size, and cells where nobody stands are refused") {
        const Plain plain;
        const pvs::Pvs sets = plain.sets(false, false);
        CHECK(error_of(plain.look(sets, {.views = 0})).code == ErrorCode::invalid_argument);
        CHECK(error_of(plain.look(sets, {.views = 1, .width = 0})).code == ErrorCode::invalid_argument);
        const auto cells = pvs::Cells::grid({{-100, 50, -100}, {100, 60, 100}}, {1, 1, 1}).value();
        const auto bake = pvs::Bake::create(plain.scene.geometry, cells, {.epsilon = 1e-2}).value();
        CHECK(error_of(plain.look(pvs::Pvs::finish(bake).value())).code == ErrorCode::empty);
    }
}
