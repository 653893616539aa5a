// SPDX-License-Identifier: MIT
// The example of docs/occlude.md, compiled and run.
#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <cstdio>
#include <vector>

namespace {

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return 1;
}

template <class Draw>
int show(const std::vector<crofton::Obb>& walls, const crofton::boxtree::BoxTree& tree, const crofton::Camera& camera,
         crofton::occlude::VisibleSet& visible, const Draw& draw_object) {
    using namespace crofton;

    occlude::OccluderSet occluders;
    for (const Obb& wall : walls)
        if (const auto placed = occluders.place(wall); !placed) return report(placed.error());  // which one, and why
    auto buffer = occlude::OcclusionBuffer::create({.width = 480, .height = 270});
    if (!buffer) return report(buffer.error());

    // Each frame: draw, then query.
    const auto view = occlude::occlusion_view_of(camera);
    if (!view) return report(view.error());
    buffer->draw(occluders, *view);
    occlude::find_visible(tree, *buffer, visible);
    for (const boxtree::ItemId id : visible.ids()) draw_object(id);
    return 0;
}

}  // namespace

TEST_SUITE("occlude/guide") {
    TEST_CASE("the guide's example draws the objects in front of the wall and next to it") {
        const auto box = [](double x, double z, float half) {
            crofton::Obb result;
            result.center = {x, 0.0, z};
            result.half_extents = {half, half, half};
            return result;
        };
        const std::vector<crofton::Obb> walls = {box(0.0, -10.0, 2.0f)};
        const auto tree = *crofton::boxtree::BoxTree::build(
            std::vector{box(0.0, -5.0, 0.5f), box(0.0, -20.0, 0.5f), box(12.0, -20.0, 0.5f)});
        crofton::occlude::VisibleSet visible;
        std::vector<crofton::boxtree::ItemId> drawn;
        CHECK(show(walls, tree, {}, visible, [&](crofton::boxtree::ItemId id) { drawn.push_back(id); }) == 0);
        CHECK(drawn == std::vector<crofton::boxtree::ItemId>{0, 2});
        crofton::Obb flat = walls[0];
        flat.half_extents.y = 0.0f;
        CHECK(show({flat}, tree, {}, visible, [](crofton::boxtree::ItemId) {}) == 1);
    }
}
