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
    ViewResultHandle visible = make_view_result();
    crofton_camera camera = sized<crofton_camera>();
    crofton_occlusion_options occlusion = crofton_default_occlusion_options();
    crofton_view_request view = crofton_default_view_request();

    Walled() {
        const Cuboid cuboid(5.0f, 5.0f, 0.5f);
        auto data = sized<crofton_mesh_data>();
        data.positions = cuboid.positions.data();
        data.position_count = 8;
        data.indices = cuboid.indices.data();
        data.index_count = 36;
        REQUIRE(crofton_world_add_mesh(world.get(), &data, &mesh) == CROFTON_OK);
        wall = add_wall(1);
        behind = add_bound(world, box_bound(box_at(0, 0, -20)), 9);
        beside = add_bound(world, box_bound(box_at(-14, 0, -20)), 10);
        camera = crofton_default_camera();
        view.camera = &camera;
        view.occlusion = &occlusion;
    }
    Walled(const Walled&) = delete;
    Walled& operator=(const Walled&) = delete;
    crofton_object add_wall(std::uint32_t occludes) const {
        const crofton_transform place = translation(0, 0, -10);
        auto description = sized<crofton_object_description>();
        description.has_mesh = 1;
        description.mesh = mesh;
        description.transform = &place;
        description.occludes = occludes;
        description.user = 7;
        crofton_object object{};
        REQUIRE(crofton_world_add(world.get(), &description, &object) == CROFTON_OK);
        return object;
    }
    std::vector<std::uint32_t> look() const {
        update(world);
        REQUIRE(crofton_world_view(world.get(), &view, 1, nullptr, visible.get()) == CROFTON_OK);
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        REQUIRE(crofton_view_result_ids(visible.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
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
        REQUIRE(world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
        CHECK(count == 0);
        auto find = sized<crofton_find_options>();
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, &find) == CROFTON_OK);
        CHECK(s.hides());
        REQUIRE(world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        auto occluder = sized<crofton_occluder>();
        REQUIRE(crofton_world_get_occluder(s.world.get(), s.mesh, 0, &occluder) == CROFTON_OK);
        CHECK(occluder.kind == CROFTON_OCCLUDER_CONVEX);
        CHECK(occluder.position_count == 8);
        CHECK(occluder.piece_max[0] == 5.0);
        CHECK(crofton_world_get_occluder(s.world.get(), s.mesh, 1, &occluder) == CROFTON_OUT_OF_RANGE);

        crofton_occluder_ref named[2] = {};
        REQUIRE(world_hidden_by(s.world.get(), s.behind, s.visible.get(), named, 2, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(named[0].object.index == s.wall.index);
        CHECK(named[0].user == 7);
        REQUIRE(world_hidden_by(s.world.get(), s.beside, s.visible.get(), nullptr, 0, &count) == CROFTON_OK);
        CHECK(count == 0);
        REQUIRE(world_drawn_occluders(s.world.get(), s.visible.get(), named, 1, &count) == CROFTON_OK);
        CHECK(count == 1);
        CHECK(world_hidden_by(s.world.get(), s.behind, s.visible.get(), nullptr, 1, &count) ==
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
        // As a level: the shape, and all six faces as a surface.
        find.level_triangles = 48;
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, &find) == CROFTON_OK);
        REQUIRE(world_occluder_count(s.world.get(), s.mesh, &count) == CROFTON_OK);
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
        REQUIRE(world_set_occludes(s.world.get(), s.wall, 0) == CROFTON_OK);
        CHECK_FALSE(s.hides());
        (void)s.add_wall(0);
        CHECK_FALSE(s.hides());
        (void)s.add_wall(1);
        CHECK(s.hides());
    }

    TEST_CASE("options, limits, matrices, statistics and the depth buffer") {
        Walled s;
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, nullptr) == CROFTON_OK);
        s.occlusion.list_occluded = 1;
        s.occlusion.width = 160;
        s.occlusion.height = 90;
        CHECK(s.look() == std::vector<std::uint32_t>{s.wall.index, s.beside.index});
        const std::uint32_t* ids = nullptr;
        std::size_t count = 0;
        REQUIRE(view_result_occluded_ids(s.visible.get(), &ids, &count) == CROFTON_OK);
        REQUIRE(count == 1);
        CHECK(ids[0] == s.behind.index);
        auto statistics = sized<crofton_view_info>();
        REQUIRE(crofton_view_result_get_view(s.visible.get(), 0, &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 1);
        CHECK(statistics.occluder_pieces_drawn == 1);
        CHECK(statistics.occlusion_items_hidden >= 1);
        CHECK(statistics.depth_width == 160);
        CHECK(statistics.depth_height == 90);
        CHECK((statistics.occluded_count == 1 && statistics.occluded_ids[0] == s.behind.index));
        CHECK((statistics.triangles == nullptr && statistics.triangles_listed == 0));
        std::vector<float> pixels(160 * 90);
        CHECK(crofton_view_result_depth(s.visible.get(), 0, pixels.data(), pixels.size() - 1) == CROFTON_OUT_OF_RANGE);
        REQUIRE(crofton_view_result_depth(s.visible.get(), 0, pixels.data(), pixels.size()) == CROFTON_OK);
        CHECK(1.0 / double(pixels[45 * 160 + 80]) == doctest::Approx(9.5).epsilon(1e-3));
        CHECK(pixels[0] < -1e38f);

        // The query that lists what is hidden went through the volume; without, nothing is counted, not even by an
        // earlier view.
        if (crofton::cull::kCountStatistics) CHECK(statistics.boxes_tested > 0);
        s.occlusion.list_occluded = 0;
        CHECK(s.look().size() == 2);
        REQUIRE(crofton_view_result_get_view(s.visible.get(), 0, &statistics) == CROFTON_OK);
        CHECK((statistics.nodes_tested == 0 && statistics.boxes_tested == 0 && statistics.occluded_count == 0));
        s.occlusion.list_occluded = 1;

        // The same view by its matrix.
        const glm::dmat4 to_clip = crofton::world_to_clip(crofton::Camera());
        const glm::dmat4 by_rows = glm::transpose(to_clip);
        const glm::mat4 floats(to_clip), floats_by_rows(by_rows);
        crofton_view_matrix matrix = crofton_default_view_matrix();
        s.view.camera = nullptr;
        s.view.matrix = &matrix;
        for (const std::uint32_t form : {0u, 1u, 2u, 3u}) {
            matrix.is_row_major = form % 2;
            matrix.doubles = form == 0 ? &to_clip[0][0] : form == 1 ? &by_rows[0][0] : nullptr;
            matrix.floats = form == 2 ? &floats[0][0] : form == 3 ? &floats_by_rows[0][0] : nullptr;
            CHECK(s.look() == std::vector<std::uint32_t>{s.wall.index, s.beside.index});
        }
        s.view.layers = 0;
        CHECK(s.look().empty());
        s.view.layers = ~0u;
        // A volume beside the eye's: what is in it, unless it is hidden from the eye.
        View around = default_view();
        s.view.volume = &around.frustum;
        CHECK(s.look() == std::vector<std::uint32_t>{s.wall.index, s.beside.index});
        s.view.volume = nullptr;
        // The wall is too far to be drawn, and hides nothing then.
        std::vector<float> distances{5.0f, 1e9f, 1e9f};
        auto limits = sized<crofton_draw_limits>();
        limits.item_distances = distances.data();
        limits.item_count = distances.size();
        s.view.limits = &limits;
        CHECK(s.look() == std::vector<std::uint32_t>{s.behind.index, s.beside.index});
        s.view.limits = nullptr;
        s.view.occlusion = nullptr;
        CHECK(s.look().size() == 3);
        CHECK(crofton_view_result_depth(s.visible.get(), 0, nullptr, 0) == CROFTON_EMPTY);
        REQUIRE(crofton_view_result_get_view(s.visible.get(), 0, &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 0);

        // Many views: the second looks away.
        crofton_camera away = s.camera;
        away.forward[2] = 1.0;
        s.view.occlusion = &s.occlusion;
        crofton_view_request views[2] = {s.view, s.view};
        views[1].matrix = nullptr;
        views[1].camera = &away;
        const ViewResultHandle in_views = make_view_result();
        REQUIRE(crofton_world_view(s.world.get(), views, 2, nullptr, in_views.get()) == CROFTON_OK);
        crofton_object_ref refs[3] = {};
        std::uint32_t masks[3] = {};
        REQUIRE(crofton_view_result_list(in_views.get(), s.world.get(), 0, refs, masks, 3) == CROFTON_OK);
        CHECK(masks[0] == 1);
        CHECK(masks[1] == 1);
        CHECK(masks[2] == 0);
        REQUIRE(crofton_view_result_get_view(in_views.get(), 1, &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 0);
        CHECK(crofton_view_result_get_view(in_views.get(), 2, &statistics) == CROFTON_OUT_OF_RANGE);
        CHECK(crofton_view_result_depth(in_views.get(), 0, pixels.data(), pixels.size()) == CROFTON_OK);
        CHECK(crofton_view_result_depth(in_views.get(), 0, nullptr, 0) == CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_view_result_depth(in_views.get(), 2, nullptr, 0) == CROFTON_OUT_OF_RANGE);
        // The same result holds one view or many, and what only one has is refused of many.
        REQUIRE(crofton_view_result_get_view(in_views.get(), 0, &statistics) == CROFTON_OK);
        CHECK((statistics.occluders_drawn == 1 && statistics.depth_height == 90));
        CHECK((statistics.occluded_count == 1 && statistics.occluded_ids[0] == s.behind.index));
        CHECK(world_drawn_occluders(s.world.get(), in_views.get(), nullptr, 0, &count) == CROFTON_UNSUPPORTED);
        REQUIRE(crofton_world_view(s.world.get(), &views[0], 1, nullptr, in_views.get()) == CROFTON_OK);
        REQUIRE(crofton_view_result_get_view(in_views.get(), 0, &statistics) == CROFTON_OK);
        CHECK(statistics.occluders_drawn == 1);
        CHECK(crofton_view_result_get_view(in_views.get(), 1, &statistics) == CROFTON_OUT_OF_RANGE);
        REQUIRE(crofton_view_result_list(in_views.get(), s.world.get(), 0, refs, masks, 3) == CROFTON_OK);
        CHECK(masks[1] == 1);
        views[0].occlusion = nullptr;
        REQUIRE(crofton_world_view(s.world.get(), views, 1, nullptr, in_views.get()) == CROFTON_OK);
        CHECK(crofton_view_result_depth(in_views.get(), 0, nullptr, 0) == CROFTON_EMPTY);
    }

    TEST_CASE("each view of many keeps its own limits, mask and occlusion") {
        Walled s;
        REQUIRE(crofton_world_find_occluders(s.world.get(), s.mesh, nullptr) == CROFTON_OK);
        for (int i = 0; i < 40; ++i) update(s.world);    // masks say nothing about what may have moved since
        std::vector<float> distances{5.0f, 1e9f, 1e9f};  // the wall is too far to be drawn: it hides nothing then
        auto limits = sized<crofton_draw_limits>();
        limits.item_distances = distances.data();
        limits.item_count = distances.size();
        const crofton_draw_limits same = limits;
        const std::uint64_t mask = ~(std::uint64_t{1} << s.beside.index);
        std::vector<crofton_view_request> views(5, s.view);
        views[1].limits = &limits;
        views[2].limits = &same;
        views[3].occlusion = nullptr;
        views[4].candidate_mask = &mask;
        views[4].candidate_words = 1;
        const ViewResultHandle many = make_view_result();
        REQUIRE(crofton_world_view(s.world.get(), views.data(), 5, nullptr, many.get()) == CROFTON_OK);
        crofton_object_ref refs[3] = {};
        std::uint32_t masks[3] = {};
        REQUIRE(crofton_view_result_list(many.get(), s.world.get(), 0, refs, masks, 3) == CROFTON_OK);
        CHECK(masks[0] == 0b11001);  // the wall
        CHECK(masks[1] == 0b01110);  // behind it
        CHECK(masks[2] == 0b01111);  // beside it
        for (std::size_t v = 0; v < views.size(); ++v) {
            CAPTURE(v);
            REQUIRE(crofton_world_view(s.world.get(), &views[v], 1, nullptr, s.visible.get()) == CROFTON_OK);
            std::vector<crofton_object_ref> seen(3);
            const std::uint32_t* ids = nullptr;
            std::size_t count = 0, expected = 0;
            REQUIRE(crofton_view_result_ids(s.visible.get(), &ids, &count, nullptr, nullptr) == CROFTON_OK);
            for (const std::uint32_t bits : masks) expected += bits >> v & 1u;
            CHECK(count == expected);
        }
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
        CHECK(world_occluder_count(world, stale, &count) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_get_occluder(world, stale, 0, &box) == CROFTON_STALE_HANDLE);
        CHECK(crofton_world_find_occluders(world, stale, nullptr) == CROFTON_STALE_HANDLE);
        CHECK(world_set_occludes(world, s.behind, 0) == CROFTON_INVALID_ARGUMENT);
        auto find = sized<crofton_find_options>();
        find.grid = 99;
        CHECK(crofton_world_find_occluders(world, s.mesh, &find) == CROFTON_OUT_OF_RANGE);

        const auto view = [&](const crofton_view_request& asked) {
            return crofton_world_view(world, &asked, 1, nullptr, s.visible.get());
        };
        CHECK(view(s.view) == CROFTON_OK);
        s.occlusion.width = 5;
        CHECK(view(s.view) == CROFTON_OUT_OF_RANGE);
        s.occlusion.size = 4096;
        CHECK(view(s.view) == CROFTON_WRONG_SIZE);
        s.occlusion = crofton_default_occlusion_options();
        crofton_view_request bad = s.view;
        bad.camera = nullptr;
        CHECK(view(bad) == CROFTON_INVALID_ARGUMENT);
        const glm::dmat4 to_clip(0.0);
        const glm::mat4 floats(1.0f);
        crofton_view_matrix matrix = crofton_default_view_matrix();
        bad.matrix = &matrix;
        CHECK(view(bad) == CROFTON_INVALID_ARGUMENT);  // neither kind of numbers
        matrix.doubles = &to_clip[0][0];
        CHECK(view(bad) != CROFTON_OK);
        matrix.floats = &floats[0][0];
        CHECK(view(bad) == CROFTON_INVALID_ARGUMENT);  // both
        matrix.doubles = nullptr;
        matrix.depth = 7;
        CHECK(view(bad) == CROFTON_INVALID_ARGUMENT);
        matrix.depth = 0;
        bad.camera = &s.camera;
        CHECK(view(bad) == CROFTON_INVALID_ARGUMENT);  // two eyes
        s.camera.fov_y = -1.0;
        CHECK(view(s.view) == CROFTON_OUT_OF_RANGE);
        s.camera.fov_y = 1.0;
        auto limits = sized<crofton_draw_limits>();
        limits.hysteresis = 0.5;
        s.view.limits = &limits;
        CHECK(view(s.view) == CROFTON_OUT_OF_RANGE);
        s.view.limits = nullptr;
        s.view.candidate_words = 1;
        CHECK(view(s.view) == CROFTON_INVALID_ARGUMENT);
        s.view.candidate_words = 0;
        crofton_frustum planes = default_view().frustum;
        planes.plane_count = CROFTON_MAX_PLANES + 1;
        s.view.volume = &planes;
        CHECK(view(s.view) == CROFTON_OUT_OF_RANGE);
        s.view.volume = nullptr;
        const crofton_view_request zero{};
        CHECK(view(zero) == CROFTON_WRONG_SIZE);
        CHECK(mentions(crofton_last_error(), "crofton_default_"));
        const WorldHandle other = make_world();
        CHECK(world_hidden_by(other.get(), s.behind, s.visible.get(), nullptr, 0, &count) == CROFTON_INVALID_ARGUMENT);
        const std::vector<crofton_view_request> many(33, s.view);
        CHECK(crofton_world_view(world, many.data(), 33, nullptr, make_view_result().get()) == CROFTON_OUT_OF_RANGE);
    }

    TEST_CASE("jobs are checked also without any views") {
        const Walled s;
        const ViewResultHandle visible = make_view_result();
        const auto look = [&](const crofton_jobs* jobs) {
            return crofton_world_view(s.world.get(), nullptr, 0, jobs, visible.get());
        };
        const crofton_jobs no_jobs{}, no_function{sizeof no_jobs, nullptr, 1, nullptr};
        CHECK(look(nullptr) == CROFTON_OK);
        CHECK(look(&no_jobs) == CROFTON_WRONG_SIZE);
        CHECK(look(&no_function) == CROFTON_INVALID_ARGUMENT);
    }

    TEST_CASE("the error for several views names the wrong one") {
        Walled s;
        crofton_view_request views[3] = {s.view, s.view, s.view};
        views[2].camera = nullptr;
        CHECK(crofton_world_view(s.world.get(), views, 3, nullptr, make_view_result().get()) ==
              CROFTON_INVALID_ARGUMENT);
        CHECK(crofton_last_error_item() == 2);
    }
}
