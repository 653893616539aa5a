// SPDX-License-Identifier: MIT
// Views with occlusion in C: the same answers as in C++, and what is refused.
#include <algorithm>
#include <crofton/crofton.hpp>
#include <cstddef>
#include <cstring>
#include <vector>

#include "world_fixture.hpp"

using namespace crofton::capi_test;

namespace {

// A cuboid, as C takes it and as C++ does.
struct Cuboid {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices{0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
    Cuboid(float x, float y, float z) {
        for (unsigned i = 0; i < 8; ++i)
            positions.insert(positions.end(), {i & 1u ? x : -x, i & 2u ? y : -y, i & 4u ? z : -z});
    }
};

// A wall ten metres before the eye, a box behind it and one beside.
struct Walled {
    WorldHandle world = make_world();
    crofton_world_mesh mesh{};
    crofton_object wall{}, behind{}, beside{};
    ViewResultHandle visible = make_visible_objects();
    crofton_camera camera = sized<crofton_camera>();
    crofton_occluding_view view = sized<crofton_occluding_view>();

    Walled() {
        const Cuboid cuboid(5.0f, 5.0f, 0.5f);
        auto data = sized<crofton_mesh_data>();
        data.positions = cuboid.positions.data();
        data.position_count = 8;
        data.indices = cuboid.indices.data();
        data.index_count = 36;
        REQUIRE(crofton_world_add_mesh(world.get(), &data, &mesh) == CROFTON_OK);
        wall = add_wall(0);
        behind = add_bound(world, box_bound(box_at(0, 0, -20)), 9);
        beside = add_bound(world, box_bound(box_at(-14, 0, -20)), 10);
        REQUIRE(crofton_camera_default(&camera) == CROFTON_OK);
        view.camera = &camera;
    }
    crofton_object add_wall(std::uint32_t transparent) const {
        const crofton_transform place = translation(0, 0, -10);
        auto description = sized<crofton_object_description>();
        description.has_mesh = 1;
        description.mesh = mesh;
        description.transform = &place;
        description.transparent = transparent;
        description.user = 7;
        crofton_object object{};
        REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        return object;
    }
    std::vector<std::uint32_t> look(const crofton_occlusion_options* occlusion = nullptr) const {
        update(world);
        REQUIRE(crofton_world_view_occluding(world.get(), &view, occlusion, nullptr, nullptr, visible.get()) ==
                CROFTON_OK);
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_visible_objects_ids(visible.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
        return {ids, ids + count};
    }
    bool hides() const {
        const auto ids = look();
        CHECK(std::find(ids.begin(), ids.end(), beside.index) != ids.end());
        return std::find(ids.begin(), ids.end(), behind.index) == ids.end();
    }
};

}  // namespace

TEST_SUITE("capi/world occlusion") {
    TEST_CASE("occluders are found, read, given back, switched, and named") {
        const Walled s;
        CHECK_FALSE(s.hides());
        std::size_t count = 5;
        REQUIRE(crofton_world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
        CHECK(count == 0);
        auto find = sized<crofton_find_options>();
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, &find) == CROFTON_OK);
        CHECK(s.hides());
        REQUIRE(crofton_world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        auto occluder = sized<crofton_occluder>();
        REQUIRE(crofton_world_get_occluder(s.world.get(), s.mesh, 0, &occluder) == CROFTON_OK);
        CHECK(occluder.kind == CROFTON_OCCLUDER_CONVEX);
        CHECK(occluder.position_count == 8);
        CHECK(occluder.piece_max[0] == 5.0);
        CHECK(crofton_world_get_occluder(s.world.get(), s.mesh, 1, &occluder) == CROFTON_OUT_OF_RANGE);

        crofton_occluder_ref named[2] = {};
        REQUIRE(crofton_world_hidden_by(s.world.get(), s.behind, s.visible.get(), named, 2, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(named[0].object.index == s.wall.index);
        CHECK(named[0].user == 7);
        REQUIRE(crofton_world_hidden_by(s.world.get(), s.beside, s.visible.get(), nullptr, 0, &count) == CROFTON_OK);
        CHECK(count == 0);
        REQUIRE(crofton_world_drawn_occluders(s.world.get(), s.visible.get(), named, 1, &count) == CROFTON_OK);
        CHECK(count == 1);
        CHECK(crofton_world_hidden_by(s.world.get(), s.behind, s.visible.get(), nullptr, 1, &count) ==
              CROFTON_INVALID_ARGUMENT);

        // Its arrays are the world's: what was read is copied before it is given back.
        std::vector<float> positions(occluder.positions, occluder.positions + 24);
        occluder.positions = positions.data();
        occluder.indices = nullptr;
        occluder.index_count = 0;
        REQUIRE(crofton_world_set_occluders(s.world.get(), s.mesh, nullptr, 0) == CROFTON_OK);
        CHECK_FALSE(s.hides());
        REQUIRE(crofton_world_set_occluders(s.world.get(), s.mesh, &occluder, 1) == CROFTON_OK);
        CHECK(s.hides());
        // As a level: the body, and all six faces as a surface.
        find.level_triangles = 48;
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, &find) == CROFTON_OK);
        REQUIRE(crofton_world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
        CHECK(count == 2);
        REQUIRE(crofton_world_get_occluder(s.world.get(), s.mesh, 1, &occluder) == CROFTON_OK);
        CHECK(occluder.kind == CROFTON_OCCLUDER_PATCH);
        CHECK(occluder.index_count == 36);
        CHECK(s.hides());
        // A box alone.
        auto box = sized<crofton_occluder>();
        box.box = box_at(0, 0, 0, 4.0f);
        box.box.half_extents[2] = 0.25f;
        REQUIRE(crofton_world_set_occluders(s.world.get(), s.mesh, &box, 1) == CROFTON_OK);
        CHECK(s.hides());
        REQUIRE(crofton_world_set_occludes(s.world.get(), s.wall, 0) == CROFTON_OK);
        CHECK_FALSE(s.hides());
        (void)s.add_wall(1);
        CHECK_FALSE(s.hides());
        (void)s.add_wall(0);
        CHECK(s.hides());
    }

    TEST_CASE("options, limits, matrices, statistics and the depth buffer") {
        Walled s;
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, nullptr) == CROFTON_OK);
        auto occlusion = sized<crofton_occlusion_options>();
        occlusion.list_occluded = 1;
        occlusion.width = 160;
        occlusion.height = 90;
        CHECK(s.look(&occlusion) == std::vector<std::uint32_t>{s.wall.index, s.beside.index});
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_visible_objects_occluded_ids(s.visible.get(), &ids, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(ids[0] == s.behind.index);
        auto statistics = sized<crofton_occlusion_statistics>();
        REQUIRE(crofton_visible_objects_get_occlusion_statistics(s.visible.get(), &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 1);
        CHECK(statistics.pieces_drawn == 1);
        CHECK(statistics.items_hidden >= 1);
        std::uint32_t width = 0, height = 0;
        REQUIRE(crofton_visible_objects_depth(s.visible.get(), &width, &height, nullptr, 0) == CROFTON_OK);
        CHECK(width == 160);
        CHECK(height == 90);
        std::vector<float> pixels(160 * 90);
        CHECK(crofton_visible_objects_depth(s.visible.get(), &width, &height, pixels.data(), pixels.size() - 1) ==
              CROFTON_OUT_OF_RANGE);
        REQUIRE(crofton_visible_objects_depth(s.visible.get(), &width, &height, pixels.data(), pixels.size()) ==
                CROFTON_OK);
        CHECK(1.0 / double(pixels[45 * 160 + 80]) == doctest::Approx(9.5).epsilon(1e-3));
        CHECK(pixels[0] < -1e38f);

        // The same view by its matrix.
        const glm::dmat4 to_clip = crofton::world_to_clip(crofton::Camera());
        s.view.camera = nullptr;
        s.view.to_clip = &to_clip[0][0];
        CHECK(s.look() == std::vector<std::uint32_t>{s.wall.index, s.beside.index});
        s.view.hidden_layers = ~0u;
        CHECK(s.look().empty());
        s.view.hidden_layers = 0;
        // The wall is too far to be drawn, and hides nothing then.
        std::vector<float> distances{5.0f, 1e9f, 1e9f};
        auto limits = sized<crofton_draw_limits>();
        limits.item_distances = distances.data();
        limits.item_count = distances.size();
        s.view.limits = &limits;
        CHECK(s.look() == std::vector<std::uint32_t>{s.behind.index, s.beside.index});
        s.view.limits = nullptr;
        occlusion.disabled = 1;
        CHECK(s.look(&occlusion).size() == 3);
        CHECK(crofton_visible_objects_depth(s.visible.get(), &width, &height, nullptr, 0) == CROFTON_EMPTY);
        REQUIRE(crofton_visible_objects_get_occlusion_statistics(s.visible.get(), &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 0);

        // Many views: the second looks away.
        crofton_camera away = s.camera;
        away.forward[2] = 1.0;
        crofton_occluding_view views[2] = {s.view, s.view};
        views[1].to_clip = nullptr;
        views[1].camera = &away;
        const VisibleInViewsHandle in_views = make_visible_in_views();
        REQUIRE(crofton_world_views_occluding(s.world.get(), views, 2, nullptr, nullptr, nullptr, in_views.get()) ==
                CROFTON_OK);
        // What is asked beside the views is read with the first of them, which may be the only one.
        auto disabled = sized<crofton_occlusion_options>();
        disabled.disabled = 1;
        const VisibleInViewsHandle without = make_visible_in_views();
        REQUIRE(crofton_world_views_occluding(s.world.get(), views, 1, &disabled, nullptr, nullptr, without.get()) ==
                CROFTON_OK);
        CHECK(crofton_visible_in_views_depth(without.get(), 0, &width, &height, nullptr, 0) == CROFTON_OUT_OF_RANGE);
        crofton_object_ref refs[3] = {};
        std::uint32_t masks[3] = {};
        REQUIRE(crofton_visible_in_views_list(in_views.get(), s.world.get(), 0, refs, masks, 3) == CROFTON_OK);
        CHECK(masks[0] == 1);
        CHECK(masks[1] == 1);
        CHECK(masks[2] == 0);
        REQUIRE(crofton_visible_in_views_get_occlusion_statistics(in_views.get(), 1, &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 0);
        CHECK(crofton_visible_in_views_get_occlusion_statistics(in_views.get(), 2, &statistics) ==
              CROFTON_OUT_OF_RANGE);
        CHECK(crofton_visible_in_views_depth(in_views.get(), 0, &width, &height, nullptr, 0) == CROFTON_OK);
        CHECK(crofton_visible_in_views_depth(in_views.get(), 2, &width, &height, nullptr, 0) == CROFTON_OUT_OF_RANGE);
    }

    TEST_CASE("the first view's limits count for all, and a later view with others is refused") {
        Walled s;
        update(s.world);
        // The wall is too far to be drawn. It hides nothing then.
        std::vector<float> distances{5.0f, 1e9f, 1e9f};
        auto limits = sized<crofton_draw_limits>();
        limits.item_distances = distances.data();
        limits.item_count = distances.size();
        const crofton_draw_limits others = limits;
        crofton_occluding_view views[2] = {s.view, s.view};
        const VisibleInViewsHandle visible = make_visible_in_views();
        const auto look = [&] {
            return crofton_world_views_occluding(s.world.get(), views, 2, nullptr, nullptr, nullptr, visible.get());
        };
        // Listed are those that any view sees.
        const auto seen_by_both = [&] {
            crofton_object_ref refs[3] = {};
            std::uint32_t masks[3] = {};
            REQUIRE(crofton_visible_in_views_list(visible.get(), s.world.get(), 0, refs, masks, 3) == CROFTON_OK);
            std::vector<std::uint32_t> seen;
            for (std::size_t i = 0; i < 3; ++i)
                if (masks[i] == 3) seen.push_back(refs[i].object.index);
            return seen;
        };
        views[0].limits = &limits;
        for (const crofton_draw_limits* later :
             {static_cast<const crofton_draw_limits*>(nullptr), &std::as_const(limits)}) {
            views[1].limits = later;
            REQUIRE(look() == CROFTON_OK);
            CHECK(seen_by_both() == std::vector<std::uint32_t>{s.behind.index, s.beside.index});
        }
        views[1].limits = &others;
        CHECK(look() == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        views[0].limits = nullptr;
        CHECK(look() == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("bad calls are refused by name") {
        Walled s;
        update(s.world);
        crofton_world* const world = s.world.get();
        auto box = sized<crofton_occluder>();
        box.box = box_at(0, 0, 0, 1.0f);
        crofton_occluder two[2] = {box, box};
        two[1].box.half_extents[0] = 0.0f;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_DEGENERATE);
        CHECK(crofton_last_error_item() == 1);
        two[1] = box;
        two[1].box.center[0] = kNotANumber;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_NON_FINITE);
        two[1] = box;
        two[1].kind = 9;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        two[1] = box;
        two[1].position_count = 3;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 1);
        two[1] = box;
        two[1].size = offsetof(crofton_occluder, mean_shadow);
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_WRONG_SIZE);
        two[1] = two[0];
        two[1].has_eyes = 1;
        two[1].eyes_max[1] = kNotANumber;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_NON_FINITE);
        CHECK(crofton_last_error_item() == 1);
        two[1] = two[0];
        two[1].has_piece = 1;
        two[1].piece_min[2] = kNotANumber;
        CHECK(crofton_world_set_occluders(world, s.mesh, two, 2) == CROFTON_NON_FINITE);
        CHECK(crofton_world_set_occluders(world, s.mesh, nullptr, 2) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_set_occluders(world, s.mesh, two, SIZE_MAX / 2) == CROFTON_OUT_OF_RANGE);
        crofton_world_mesh stale = s.mesh;
        ++stale.generation;
        std::size_t count = 0;
        CHECK(crofton_world_occluder_count(world, stale, &count) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_get_occluder(world, stale, 0, &box) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_find_occluders(world, stale, nullptr) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_set_occludes(world, s.behind, 0) == CROFTON_INVALID_ARGUMENT);
        auto find = sized<crofton_find_options>();
        find.grid = 99;
        CHECK(crofton_world_find_occluders(world, s.mesh, &find) == CROFTON_OUT_OF_RANGE);

        const auto view = [&](const crofton_occluding_view& asked, const crofton_occlusion_options* occlusion) {
            return crofton_world_view_occluding(world, &asked, occlusion, nullptr, nullptr, s.visible.get());
        };
        CHECK(view(s.view, nullptr) == CROFTON_OK);
        auto occlusion = sized<crofton_occlusion_options>();
        occlusion.width = 5;
        CHECK(view(s.view, &occlusion) == CROFTON_OUT_OF_RANGE);
        occlusion.size = 4096;
        CHECK(view(s.view, &occlusion) == CROFTON_WRONG_SIZE);
        crofton_occluding_view bad = s.view;
        bad.camera = nullptr;
        CHECK(view(bad, nullptr) == CROFTON_INVALID_ARGUMENT);
        const glm::dmat4 to_clip(0.0);
        bad.to_clip = &to_clip[0][0];
        CHECK(view(bad, nullptr) != CROFTON_OK);
        bad.depth = 7;
        CHECK(view(bad, nullptr) == CROFTON_INVALID_ARGUMENT);
        s.camera.fov_y = -1.0;
        CHECK(view(s.view, nullptr) == CROFTON_OUT_OF_RANGE);
        s.camera.fov_y = 1.0;
        auto limits = sized<crofton_draw_limits>();
        limits.hysteresis = 0.5;
        s.view.limits = &limits;
        CHECK(view(s.view, nullptr) == CROFTON_OUT_OF_RANGE);
        const WorldHandle other = make_world();
        CHECK(crofton_world_hidden_by(other.get(), s.behind, s.visible.get(), nullptr, 0, &count) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_world_views_occluding(world, &s.view, 33, nullptr, nullptr, nullptr,
                                            make_visible_in_views().get()) == CROFTON_OUT_OF_RANGE);
    }

    TEST_CASE("of no views at all, too, the options and the jobs are looked at") {
        const Walled s;
        const VisibleInViewsHandle visible = make_visible_in_views();
        const auto look = [&](const crofton_occlusion_options* occlusion, const crofton_cull_options* options,
                              const crofton_jobs* jobs) {
            return crofton_world_views_occluding(s.world.get(), nullptr, 0, occlusion, options, jobs, visible.get());
        };
        const crofton_occlusion_options no_occlusion{};
        const crofton_cull_options no_options{};
        const crofton_jobs no_jobs{}, no_function{sizeof no_jobs, nullptr, 1, nullptr};
        CHECK(look(nullptr, nullptr, nullptr) == CROFTON_OK);
        CHECK(look(&no_occlusion, nullptr, nullptr) == CROFTON_WRONG_SIZE);
        CHECK(look(nullptr, &no_options, nullptr) == CROFTON_WRONG_SIZE);
        CHECK(look(nullptr, nullptr, &no_jobs) == CROFTON_WRONG_SIZE);
        CHECK(look(nullptr, nullptr, &no_function) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("of several views the one that is wrong is named") {
        Walled s;
        crofton_occluding_view views[3] = {s.view, s.view, s.view};
        views[2].camera = nullptr;
        CHECK(crofton_world_views_occluding(s.world.get(), views, 3, nullptr, nullptr, nullptr,
                                            make_visible_in_views().get()) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 2);
    }
}
