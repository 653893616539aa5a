// SPDX-License-Identifier: MIT
// Views of a World that leave out what is hidden.
#include <doctest/doctest.h>
#include <algorithm>
#include <error_of.hpp>
#include <limits>

#include "box_at.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

// A wall of 10 × 10 × 1 ten metres before the eye, and a sphere behind it.
struct BehindAWall {
    World world;
    MeshHandle mesh = world.add_mesh(description_of(cuboid({5.0f, 5.0f, 0.5f}), true)).value();
    NodeHandle node = world.add_node({.transform = at(0.0, 0.0, -10.0)}).value();
    ObjectHandle wall = world.add({.mesh = mesh, .node = node, .user = 7}).value();
    ObjectHandle behind = world.add({.bound = box_at({0.0, 0.0, -20.0}), .user = 9}).value();
    ObjectHandle beside = world.add({.bound = box_at({-14.0, 0.0, -20.0})}).value();
    ViewResult visible;

    [[nodiscard]] bool hides(const cull::DrawLimits* limits = nullptr, std::uint32_t layers = ~0u) {
        REQUIRE(world.update().has_value());
        const ViewRequest request{.camera = Camera(),
                                  .layers = layers,
                                  .occlusion = OcclusionOptions{.list_occluded = true},
                                  .limits = limits};
        REQUIRE(world.view(request, visible).has_value());
        const auto contains = [](std::span<const std::uint32_t> ids, ObjectHandle object) {
            return std::binary_search(ids.begin(), ids.end(), object.index);
        };
        CHECK(contains(visible.ids(), beside));
        CHECK(contains(visible.ids(), behind) != contains(visible.occluded_ids(), behind));
        return visible.verdict_of(behind.index) == occlude::Verdict::occluded;
    }
};

}  // namespace

TEST_SUITE("world/occlusion") {
    TEST_CASE("an object behind a wall is occluded, and the wall is named") {
        BehindAWall s;
        REQUIRE(s.hides());
        CHECK(s.visible.has_occlusion());
        CHECK(s.visible.occlusion_statistics().occluders_drawn == 1);
        CHECK(s.visible.occlusion_statistics().drawn.pieces_drawn == 1);
        CHECK(s.visible.occlusion_statistics().asked.items_hidden >= 1);
        Vector<OccluderRef> occluders;
        REQUIRE(s.world.hidden_by(s.behind, s.visible, occluders).has_value());
        REQUIRE(occluders.size() == 1);
        CHECK(occluders[0].object == s.wall);
        CHECK(occluders[0].user == 7);
        CHECK(occluders[0].place == 0);
        REQUIRE(s.world.hidden_by(s.beside, s.visible, occluders).has_value());
        CHECK(occluders.empty());
        REQUIRE(s.world.drawn_occluders(s.visible, occluders).has_value());
        CHECK(occluders.size() == 1);
        // Of each index its verdict, whichever list it is in.
        REQUIRE(s.visible.verdicts().size() == s.visible.size());
        for (std::size_t i = 0; i < s.visible.size(); ++i)
            CHECK(int(s.visible.verdict_of(s.visible.ids()[i])) == int(s.visible.verdicts()[i]));
        CHECK(s.visible.verdict_of(s.wall.index) == occlude::Verdict::inside);
        CHECK(s.visible.verdict_of(s.behind.index) == occlude::Verdict::occluded);
        CHECK(s.visible.verdict_of(s.beside.index) != occlude::Verdict::outside);
        CHECK(s.visible.verdict_of(1000) == occlude::Verdict::outside);
        // The picture: the wall in the middle, nothing at the edge.
        const occlude::OcclusionBuffer* buffer = s.visible.occlusion_buffer();
        REQUIRE(buffer != nullptr);
        CHECK(1.0 / double(buffer->nearness(240, 135)) == doctest::Approx(9.5).epsilon(1e-3));
        CHECK(buffer->nearness(1, 1) == occlude::OcclusionBuffer::kUncovered);
        CHECK(buffer->count_covered() > 1000);
        std::vector<float> pixels(480 * 270);
        buffer->read(pixels);
        CHECK(pixels[135 * 480 + 240] == buffer->nearness(240, 135));
        // Without the switch.
        REQUIRE(s.world.view({.camera = Camera()}, s.visible).has_value());
        CHECK(s.visible.size() == 3);
        CHECK(!s.visible.has_occlusion());
        CHECK(s.visible.occlusion_buffer() == nullptr);
    }

    TEST_CASE("an object that a view does not draw hides nothing in it") {
        BehindAWall s;
        REQUIRE(s.hides());
        SUBCASE("hidden") {
            REQUIRE(s.world.set_hidden(s.wall, true).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_hidden(s.wall, false).has_value());
            CHECK(s.hides());
        }
        SUBCASE("added hidden, until it is shown") {
            REQUIRE(s.world.remove(s.wall).has_value());
            s.wall = s.world.add({.mesh = s.mesh, .node = s.node, .hidden = true}).value();
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_hidden(s.wall, false).has_value());
            CHECK(s.hides());
        }
        SUBCASE("transparent") {
            REQUIRE(s.world.set_occludes(s.wall, false).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_occludes(s.wall, true).has_value());
            CHECK(s.hides());
            CHECK(error_of(s.world.set_occludes(s.behind, true)).code == ErrorCode::invalid_argument);
        }
        SUBCASE("in another layer, by itself or by its node") {
            REQUIRE(s.world.set_layers(s.wall, 2).has_value());
            CHECK_FALSE(s.hides(nullptr, 1));
            CHECK(s.hides(nullptr, 3));
            REQUIRE(s.world.set_layers(s.node, 1).has_value());
            CHECK_FALSE(s.hides());
        }
        SUBCASE("removed, alone or with its node") {
            REQUIRE(s.world.remove(s.wall).has_value());
            CHECK_FALSE(s.hides());
            BehindAWall other;
            REQUIRE(other.hides());
            REQUIRE(other.world.remove(other.node).has_value());
            CHECK_FALSE(other.hides());
        }
        SUBCASE("flat, or a point") {
            glm::dmat3 flat(1.0);
            flat[2][2] = 0.0;
            REQUIRE(s.world.set_transform(s.node, {flat, {0.0, 0.0, -10.0}}).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_transform(s.node, {glm::dmat3(0.0), {}}).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_transform(s.node, at(0.0, 0.0, -10.0)).has_value());
            CHECK(s.hides());
        }
        SUBCASE("too small or too far for the view") {
            cull::DrawLimits limits;
            limits.least_radius = 20.0;
            REQUIRE(s.world.view({.camera = Camera(), .occlusion = OcclusionOptions{}, .limits = &limits}, s.visible)
                        .has_value());
            CHECK(s.visible.size() == 0);
            std::vector<float> distances(3, 1e9f);
            distances[s.wall.index] = 5.0f;
            cull::DrawLimits by_item;
            by_item.item_distances = distances;
            CHECK_FALSE(s.hides(&by_item));
            distances[s.wall.index] = 15.0f;
            CHECK(s.hides(&by_item));
        }
        SUBCASE("another mesh, other vertices") {
            const auto small = s.world.add_mesh(description_of(cuboid({0.1f, 0.1f, 0.1f}), true)).value();
            REQUIRE(s.world.set_mesh(s.wall, small).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.set_mesh(s.wall, s.mesh).has_value());
            CHECK(s.hides());
            const TriangleMesh same = cuboid({5.0f, 5.0f, 0.5f});
            REQUIRE(s.world.set_vertices(s.mesh, same.positions).has_value());
            CHECK(s.world.occluders_of(s.mesh).empty());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.find_occluders(s.mesh).has_value());
            CHECK(s.hides());
            REQUIRE(s.world.replace_mesh(s.mesh, description_of(same, false)).has_value());
            CHECK_FALSE(s.hides());
            REQUIRE(s.world.replace_mesh(s.mesh, description_of(same, true)).has_value());
            CHECK(s.hides());
        }
    }

    TEST_CASE("an occluder follows its node, in the update that moves it") {
        BehindAWall s;
        REQUIRE(s.hides());
        REQUIRE(s.world.set_transform(s.node, at(12.0, 0.0, -10.0)).has_value());
        CHECK_FALSE(s.hides());
        for (int i = 0; i < 5; ++i) {
            REQUIRE(s.world.set_transform(s.node, at(0.0, 0.1 * i, -10.0)).has_value());
            CHECK(s.hides());
        }
        // What moves is asked as well.
        for (int i = 0; i < 5; ++i) {
            REQUIRE(s.world.set_bound(s.behind, box_at({0.1 * i, 0.0, -20.0})).has_value());
            CHECK(s.hides());
        }
        CHECK(s.world.statistics().moving >= 1);
        REQUIRE(s.world.set_bound(s.behind, box_at({0.0, 7.0, -20.0})).has_value());
        CHECK(s.hides());  // 7.5 of 20 behind 5 of 9.5
        REQUIRE(s.world.set_bound(s.behind, box_at({0.0, 0.0, -8.0})).has_value());
        CHECK_FALSE(s.hides());
    }

    TEST_CASE("occluders are given, listed and given again, and bad ones are refused by name") {
        BehindAWall s;
        const auto found = s.world.occluders_of(s.mesh);
        REQUIRE(found.size() == 1);
        const std::vector<occlude::FoundOccluder> stored(found.begin(), found.end());
        REQUIRE(s.world.set_occluders(s.mesh, {}).has_value());
        CHECK_FALSE(s.hides());
        REQUIRE(s.world.set_occluders(s.mesh, stored).has_value());
        CHECK(s.hides());
        occlude::FoundOccluder box;
        box.box.half_extents = {4.0f, 4.0f, 0.25f};
        REQUIRE(s.world.set_occluders(s.mesh, {&box, 1}).has_value());
        CHECK(s.hides());
        CHECK(s.world.occluders_of(s.mesh)[0].surface.positions.size() == 8);
        occlude::FoundOccluder patch;
        patch.kind = occlude::OccluderKind::patch;
        patch.surface.positions = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
        patch.surface.indices = {0, 1, 2, 0, 2, 3};
        patch.sides = occlude::Sides::front;
        REQUIRE(s.world.set_occluders(s.mesh, {&patch, 1}).has_value());
        CHECK(s.hides());
        std::swap(patch.surface.indices[1], patch.surface.indices[2]);
        std::swap(patch.surface.indices[4], patch.surface.indices[5]);
        REQUIRE(s.world.set_occluders(s.mesh, {&patch, 1}).has_value());
        CHECK_FALSE(s.hides());
        occlude::FoundOccluder closed;
        closed.kind = occlude::OccluderKind::patch;
        closed.surface = cuboid({4.0f, 4.0f, 0.25f});
        REQUIRE(s.world.set_occluders(s.mesh, {&closed, 1}).has_value());
        CHECK(s.hides());

        occlude::FoundOccluder bad[3] = {box, box, box};
        bad[1].box.half_extents.x = 0.0f;
        auto refused = s.world.set_occluders(s.mesh, bad);
        CHECK(error_of(refused).code == ErrorCode::degenerate);
        CHECK(error_of(refused).item == 1);
        bad[1] = box;
        bad[2].box.center.y = std::numeric_limits<double>::quiet_NaN();
        refused = s.world.set_occluders(s.mesh, bad);
        CHECK(error_of(refused).code == ErrorCode::non_finite);
        CHECK(error_of(refused).item == 2);
        CHECK(s.hides());  // as before
        CHECK(error_of(s.world.set_occluders({}, {})).code == ErrorCode::stale_handle);
        CHECK(error_of(s.world.find_occluders({})).code == ErrorCode::stale_handle);
        CHECK(s.world.occluders_of({}).empty());
        CHECK(error_of(s.world.set_occludes({}, true)).code == ErrorCode::stale_handle);
        Vector<OccluderRef> none;
        CHECK(error_of(s.world.hidden_by({}, s.visible, none)).code == ErrorCode::stale_handle);
        CHECK(error_of(s.world.view({.camera = Camera(), .occlusion = OcclusionOptions{.size = {4, 270}}}, s.visible))
                  .code == ErrorCode::out_of_range);
        CHECK(error_of(s.world.view({.camera = Camera{.fov_y = -1.0}, .occlusion = OcclusionOptions{}}, s.visible))
                  .code != ErrorCode::out_of_memory);
    }

    TEST_CASE("hidden_by() answers until an update changes something") {
        BehindAWall s;
        REQUIRE(s.hides());
        Vector<OccluderRef> occluders;
        const auto check_told = [&](bool told) {
            CHECK(s.world.hidden_by(s.behind, s.visible, occluders).has_value() == told);
            CHECK(s.world.drawn_occluders(s.visible, occluders).has_value() == told);
            if (told) return;
            CHECK(error_of(s.world.drawn_occluders(s.visible, occluders)).code == ErrorCode::invalid_argument);
            CHECK(error_of(s.world.drawn_occluders(s.visible, occluders)).message.find("changed since") !=
                  std::string::npos);
        };
        check_told(true);
        REQUIRE(s.world.update());
        check_told(true);
        // Occluders change with the next update.
        REQUIRE(s.world.set_occluders(s.mesh, {}));
        check_told(true);
        REQUIRE(s.world.update());
        check_told(false);
        REQUIRE(s.world.view({.camera = Camera(), .occlusion = OcclusionOptions{}}, s.visible));
        check_told(true);
        REQUIRE(s.world.remove(s.wall));
        check_told(true);
        REQUIRE(s.world.update());
        check_told(false);
        // Another World at the same place.
        REQUIRE(s.world.view({.camera = Camera(), .occlusion = OcclusionOptions{}}, s.visible));
        s.world = World();
        CHECK_FALSE(s.world.drawn_occluders(s.visible, occluders));
    }

    TEST_CASE("an object that only occludes is in no answer") {
        World world;
        const auto mesh = world.add_mesh(description_of(cuboid({5.0f, 5.0f, 0.5f}), true)).value();
        const auto wall = world.add({.mesh = mesh, .transform = at(0.0, 0.0, -10.0), .only_occludes = true}).value();
        (void)world.add({.bound = box_at({0.0, 0.0, -20.0})}).value();
        CHECK(error_of(world.add({.bound = box_at({0.0, 0.0, -20.0}), .only_occludes = true})).code ==
              ErrorCode::invalid_argument);
        REQUIRE(world.update().has_value());
        ViewResult visible;
        REQUIRE(world.view({.camera = Camera()}, visible).has_value());
        CHECK(visible.size() == 1);
        REQUIRE(world.view({.camera = Camera(), .occlusion = OcclusionOptions{}}, visible).has_value());
        CHECK(visible.size() == 0);
        CHECK_FALSE(world.raycast({{0, 0, 0}, {0, 0, -1}, 15.0}).has_value());
        REQUIRE(world.set_hidden(wall, true).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(world.view({.camera = Camera(), .occlusion = OcclusionOptions{}}, visible).has_value());
        CHECK(visible.size() == 1);
    }
}
