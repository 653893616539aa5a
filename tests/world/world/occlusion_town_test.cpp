// SPDX-License-Identifier: MIT
// A town that changes: nothing seen is left out, the same answers from many views and threads, and no allocation.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <counting_memory.hpp>

#include "../../ranges.hpp"
#include "new_counter.hpp"
#include "occlusion_town.hpp"

using namespace crofton;
using namespace crofton::testing;

TEST_SUITE("world/occlusion") {
    TEST_CASE("no object that a ray of the view reaches first is left out, whatever has changed") {
        NearMisses random(171);
        std::size_t hidden = 0, witnessed = 0;
        for (const double offset : {0.0, 1e5, 1e7}) {
            Town town(random, offset * glm::dvec3(1.0, 0.5, -1.0), 300);
            ViewResult visible, plain;
            for (int frame = 0; frame < 12; ++frame) {
                REQUIRE(town.world.update().has_value());
                const Camera camera = town.camera(random);
                const std::uint32_t layers = random.index(2) ? ~0u : 3u;
                const Frustum frustum = occlude::occlusion_view_of(camera)->frustum;
                const OcclusionOptions listing{.list_occluded = true};
                REQUIRE(
                    town.world.view({.camera = camera, .layers = layers, .occlusion = listing}, visible).has_value());
                REQUIRE(town.world.view({.volume = frustum, .layers = layers}, plain).has_value());
                std::vector<std::uint32_t> both(visible.ids().begin(), visible.ids().end());
                both.insert(both.end(), visible.occluded_ids().begin(), visible.occluded_ids().end());
                std::sort(both.begin(), both.end());
                REQUIRE(std::equal(both.begin(), both.end(), plain.ids().begin(), plain.ids().end()));
                for (std::size_t i = 0; i < visible.size(); ++i)
                    CHECK(visible.verdicts()[i] ==
                          plain.verdicts()[std::size_t(
                              std::lower_bound(plain.ids().begin(), plain.ids().end(), visible.ids()[i]) -
                              plain.ids().begin())]);
                for (const std::uint32_t id : visible.occluded_ids()) {
                    ++hidden;
                    const ObjectHandle object = visible.ref(id).object;
                    CHECK_FALSE(is_witnessed(town.world, camera, frustum, object, layers, random));
                }
                for (std::size_t i = 0; i < visible.size(); i += 4)
                    witnessed += is_witnessed(town.world, camera, frustum, visible[i].object, layers, random);
                town.change(random);
            }
        }
        MESSAGE(hidden << " hidden, " << witnessed << " of a fourth of the others witnessed");
        CHECK(hidden > 1000);
        CHECK(witnessed > 80);
    }

    TEST_CASE("many views in one call, threads and matrices give the same answers") {
        NearMisses random(172);
        Town town(random, {1e4, 0.0, 0.0}, 500);
        REQUIRE(town.world.update().has_value());
        ThreadPool pool(3);
        std::vector<ViewRequest> views;
        for (int v = 0; v < 9; ++v)
            views.push_back(
                {.camera = town.camera(random), .layers = v % 3 ? ~0u : 5u, .occlusion = OcclusionOptions{}});
        MultiViewResult together, alone;
        REQUIRE(town.world.view(views, together, pool).has_value());
        REQUIRE(town.world.view(views, alone).has_value());
        CHECK(test::ranges::equal(together.ids(), alone.ids()));
        CHECK(together.view_count() == views.size());
        std::size_t seen = 0;
        for (std::size_t v = 0; v < views.size(); ++v) {
            ViewResult one, threaded;
            REQUIRE(town.world.view(views[v], one).has_value());
            REQUIRE(town.world.view(views[v], threaded, pool).has_value());
            CHECK(test::ranges::equal(one.ids(), threaded.ids()));
            std::vector<std::uint32_t> of_view;
            for (std::size_t i = 0; i < together.size(); ++i) {
                CHECK(together.view_mask(i) == alone.view_mask(i));
                if (together.view_mask(i) >> v & 1u) of_view.push_back(together.ids()[i]);
            }
            CHECK(test::ranges::equal(one.ids(), of_view));
            CHECK(together.occlusion_statistics(v).occluders_drawn == one.occlusion_statistics().occluders_drawn);
            std::vector<float> a(480 * 270), b(a.size()), c(a.size());
            one.occlusion_buffer()->read(a);
            threaded.occlusion_buffer()->read(b);
            together.occlusion_buffer(v)->read(c);
            CHECK(a == b);
            CHECK(a == c);
            seen += one.size();
        }
        CHECK(seen > 100);
        // Again with fewer views, and without occlusion.
        REQUIRE(town.world.view(std::span(views).first(2), together).has_value());
        for (std::size_t i = 0; i < together.size(); ++i) CHECK(together.view_mask(i) < 4);
        MultiViewResult plain;
        for (ViewRequest& view : views) view.occlusion.reset();
        REQUIRE(town.world.view(std::span(views).first(2), plain).has_value());
        CHECK(plain.size() > together.size());
        CHECK(plain.view_count() == 2);
        CHECK(plain.occlusion_buffer(0) == nullptr);

        // An engine's own matrix sees what the camera sees, up to rounding.
        const Camera camera = town.camera(random);
        ViewResult by_camera, by_matrix;
        REQUIRE(town.world.view({.camera = camera, .occlusion = OcclusionOptions{}}, by_camera).has_value());
        const ViewMatrix matrix{world_to_clip(camera)};
        REQUIRE(town.world.view({.matrix = matrix, .occlusion = OcclusionOptions{}}, by_matrix).has_value());
        CHECK(std::abs(double(by_camera.size()) - double(by_matrix.size())) <= 2.0);
    }

    TEST_CASE("frames with occlusion allocate nothing once warm") {
        testing::CountingMemory memory;
        {
            NearMisses random(173);
            Town town(random, {}, 500);
            std::array<ViewRequest, 2> views;
            for (ViewRequest& view : views) view = {.camera = town.camera(random), .occlusion = OcclusionOptions{}};
            ViewRequest listing = views[0];
            listing.occlusion->list_occluded = true;
            ViewResult visible;
            MultiViewResult in_views;
            const auto frame = [&](double shift) {
                for (std::size_t i = 0; i < town.boxes.size(); i += 3) town.boxes[i].center.x += shift;
                REQUIRE(town.world.set_bounds(town.things, town.boxes).has_value());
                for (std::size_t b = 0; b < 4; ++b)
                    REQUIRE(
                        town.world.set_transform(town.blocks[b], at(40.0 * double(b) + shift, 0.0, 0.0)).has_value());
                REQUIRE(town.world.update().has_value());
                REQUIRE(town.world.view(listing, visible).has_value());
                REQUIRE(town.world.view(views, in_views).has_value());
            };
            for (int i = 0; i < 24; ++i) frame(i % 2 ? 0.1 : -0.1);
            const std::size_t before = memory.allocations(), news = testing::operator_news();
            for (int i = 0; i < 6; ++i) frame(i % 2 ? 0.1 : -0.1);
            CHECK(memory.allocations() == before);
            CHECK(testing::operator_news() == news);
            CHECK(visible.occluded_ids().size() > 10);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
