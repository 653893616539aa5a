// SPDX-License-Identifier: MIT
// The code of docs/large_worlds.md.
#include <doctest/doctest.h>
#include <crofton/crofton.hpp>
#include <string>
#include <vector>

namespace {

// What an engine has of its own.
struct Tree {
    crofton::Obb box;
    std::uint64_t number = 0;
};
std::vector<std::uint64_t> drawn;
std::size_t drawn_of_regions = 0;
void fail_loading(const std::string& why) {
    FAIL(why);
}
void draw(std::uint64_t number) {
    drawn.push_back(number);
}
void draw_of_region(crofton::RegionHandle, std::uint32_t) {
    ++drawn_of_regions;
}

}  // namespace

TEST_SUITE("world/regions guide") {
    TEST_CASE("the guide's code attaches a forest, lists its trees and fells one") {
        std::vector<Tree> forest(20);
        for (std::size_t i = 0; i < forest.size(); ++i) {
            forest[i].box.center = {3.0 * static_cast<double>(i), 0.0, -20.0};
            forest[i].box.half_extents = glm::vec3(1.0f);
            forest[i].number = i;
        }
        crofton::World world;
        crofton::ViewResult visible;
        crofton::Camera camera;
        camera.position.x = 1000.0;
        world.add({.bound = crofton::Sphere{{1000.0, 0.0, -10.0}, 0.5}, .user = 77}).value();

        // On a thread that loads: coordinates are relative to the region's origin.
        std::vector<crofton::RegionObject> objects;
        for (const Tree& tree : forest) objects.push_back({.bound = tree.box, .user = tree.number});
        const auto region = crofton::Region::prepare(objects);
        if (!region) return fail_loading(region.error().message);  // which object, why

        // On the game's thread, when the player comes near, and when the player has gone:
        const auto east = world.attach(*region, {1000.0, 0.0, 0.0}).value();
        const auto west = world.attach(*region, {-1000.0, 0.0, 0.0}).value();
        world.update().value();
        world.detach(west).value();

        world.view({.camera = camera}, visible).value();
        for (std::size_t i = 0; i < visible.size(); ++i) {
            const crofton::ObjectRef ref = visible[i];
            if (ref.object.index < crofton::kFirstRegionIndex)
                draw(ref.user);
            else if (const auto place = world.place_of(ref.object))  // of which region, and which of its objects
                draw_of_region(place->region, place->index);
        }
        // A tree is felled: it is hidden, and an object of the World's own falls in its place.
        const auto felled = world.object_in(east, 3).value();
        world.set_hidden(felled, true).value();
        const auto falling = world.add({.bound = world.box_of(felled).value()}).value();

        CHECK(drawn == std::vector<std::uint64_t>{77});
        CHECK(drawn_of_regions == 8);  // up to 20.5 to the right, at a distance of 20
        world.update().value();
        const auto hit = world.raycast({{1009.0, 0.0, 0.0}, {0.0, 0.0, -1.0}});
        REQUIRE(hit.has_value());
        CHECK(hit->object == falling);
        CHECK(!world.contains(west));
    }
}
