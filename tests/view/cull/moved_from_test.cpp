// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/lights.hpp>
#include <oracle/random_boxes.hpp>
#include <utility>

using namespace crofton;
using cull::BoxSet;

TEST_SUITE("cull/moved_from") {
    TEST_CASE("a moved-from answer is empty, and may be used again") {
        const oracle::Crowd crowd = oracle::random_crowd(300, 0.0, 5);
        BoxSet set;
        set.assign(crowd.boxes);
        BoxSet other(std::move(set));
        CHECK(other.size() == 300);
        CHECK(set.size() == 0);
        set = std::move(other);
        CHECK(set.size() == 300);
        CHECK(other.size() == 0);
        cull::VerdictBits bits;
        cull::find_visible(other, {}, {*frustum_of(Camera{})}, bits);
        CHECK(bits.visible.empty());
        other.assign(crowd.boxes);
        CHECK(other.size() == 300);

        const auto tree = *boxtree::BoxTree::build(crowd.boxes);
        const cull::View views[1] = {{*frustum_of(Camera{})}};
        cull::VisibleSet visible;
        cull::find_visible(tree, views[0], visible, {.order = cull::ResultOrder::tree});
        cull::MaskedVisibleSet many;
        (void)cull::find_visible(tree, views, many);
        const std::size_t seen = visible.size();
        REQUIRE(visible.inside_count() > 0);
        REQUIRE(many.size() == seen);
        const cull::VisibleSet kept(std::move(visible));
        const cull::MaskedVisibleSet kept_many(std::move(many));
        CHECK(kept.size() == seen);
        CHECK(kept_many.size() == seen);
        CHECK(visible.size() == 0);
        CHECK(visible.ids().empty());
        CHECK(visible.inside_count() == 0);
        CHECK(visible.verdicts().empty());
        CHECK(many.size() == 0);
        CHECK(many.ids().empty());
        cull::find_visible(tree, views[0], visible);
        CHECK(visible.size() == seen);
    }

    TEST_CASE("a grid of froxels that was not built, or was moved from, has none, and no lights") {
        auto built = *cull::FroxelGrid::build(Camera{}, {.columns = 4, .rows = 3, .slices = 2});
        const Sphere light[1] = {{{0.0, 0.0, -5.0}, 4.0f}};
        cull::FroxelLights lights;
        REQUIRE(cull::find_lights(built, light, {}, lights));
        REQUIRE_FALSE(lights.lights().empty());
        const cull::FroxelGrid kept(std::move(built));
        CHECK(kept.size() == 24);
        const cull::FroxelGrid unbuilt;
        for (const cull::FroxelGrid* grid : {&unbuilt, static_cast<const cull::FroxelGrid*>(&built)}) {
            CHECK(grid->size() == 0);
            CHECK(grid->columns() == 0);
            REQUIRE(cull::find_lights(*grid, light, {}, lights));
            CHECK(lights.offsets().size() == 1);
            CHECK(lights.lights().empty());
        }
        REQUIRE(cull::find_lights(kept, light, {}, lights));
        CHECK_FALSE(lights.lights().empty());
    }
}
