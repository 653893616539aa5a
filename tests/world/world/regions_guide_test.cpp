// SPDX-License-Identifier: MIT
// The code of docs/large_worlds.md.
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <crofton/crofton.hpp>
#include <string>
#include <vector>

#include "occlusion_town.hpp"

namespace {

// What an engine has of its own.
struct Tree {
    crofton::Obb box;
    std::uint64_t number = 0;
};
struct Model {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
};
struct Wall {
    std::uint64_t number = 0;
    std::uint32_t model = 0;
    crofton::Transform transform;
};
struct Part {
    crofton::Region region;
    glm::dvec3 origin{0.0};
    crofton::RegionHandle handle = {};
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

    TEST_CASE("the guide's code names an object of a region for a saved game, and shifts the origin") {
        std::vector<Part> parts;
        for (int i = 0; i < 3; ++i) {
            std::vector<crofton::RegionObject> doors(4);
            for (std::size_t d = 0; d < doors.size(); ++d)
                doors[d].bound = crofton::Sphere{{4.0 * static_cast<double>(d), 0.0, 0.0}, 1.0};
            parts.push_back({crofton::Region::prepare(doors).value(), glm::dvec3(100.0 * i, 0.0, 0.0)});
        }
        const std::size_t number = 1;
        crofton::World played;
        for (Part& part : parts) part.handle = played.attach(part.region, part.origin).value();
        crofton::ObjectHandle opened_door = played.object_in(parts[number].handle, 2).value();
        played.update().value();
        std::uint32_t place = 0;
        {
            const crofton::World& world = played;
            // Saved: the number of a part that is loaded, and the place of its object.
            const auto saved = world.place_of(opened_door).value().index;
            place = saved;
        }
        crofton::World world;
        const auto saved = place;
        // After loading: regions may be attached in any order.
        for (Part& part : parts) part.handle = world.attach(part.region, part.origin).value();
        opened_door = world.object_in(parts[number].handle, saved).value();
        world.set_hidden(opened_door, true).value();

        world.update().value();
        const auto door_at = [&](double x) { return world.raycast({{x, 0.0, 10.0}, {0.0, 0.0, -1.0}}).has_value(); };
        CHECK(door_at(104.0));
        CHECK_FALSE(door_at(108.0));

        const glm::dvec3 shift(100.0, 0.0, 0.0);
        for (Part& part : parts) {
            world.detach(part.handle).value();
            part.origin -= shift;
            part.handle = world.attach(part.region, part.origin).value();
        }

        world.update().value();
        CHECK(door_at(4.0));
        CHECK(door_at(8.0));  // is not hidden any more
        CHECK(door_at(-100.0));
        CHECK_FALSE(door_at(204.0));
    }

    TEST_CASE("the guide's code makes a street of walls, which rays hit and things hide behind") {
        const crofton::TriangleMesh cuboid = crofton::testing::cuboid({4.0f, 3.0f, 0.5f});
        const std::vector<Model> models{
            {{cuboid.positions.begin(), cuboid.positions.end()}, {cuboid.indices.begin(), cuboid.indices.end()}}};
        const crofton::convex::Shape stone = crofton::convex::Shape::box({4.0f, 3.0f, 0.5f}).value();
        std::vector<Wall> street(5);
        for (std::size_t i = 0; i < street.size(); ++i)
            street[i].transform.translation.x = 8.0 * static_cast<double>(i);

        // The meshes of this part, which its objects share; a wall has a shape as well, for bodies to stand on.
        std::vector<crofton::RegionMesh> meshes;
        for (const Model& model : models)
            meshes.push_back({.mesh = {.positions = model.positions, .indices = model.indices, .occluders = true}});
        std::vector<crofton::RegionObject> walls;
        for (const Wall& wall : street)
            walls.push_back({.user = wall.number, .mesh = wall.model, .shape = &stone, .transform = wall.transform});
        const auto town = crofton::Region::prepare(walls, {.meshes = meshes});

        crofton::World world;
        world.attach(*town, {0.0, 0.0, -10.0}).value();
        const auto behind = world.add({.bound = crofton::Sphere{{0.0, 0.0, -20.0}, 0.5}}).value();
        world.update().value();
        CHECK(world.statistics().occluders_waiting == 0);
        CHECK(world.raycast({{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}})->t == 9.5);
        crofton::ViewResult visible;
        world
            .view({.camera = crofton::Camera{}, .occlusion = crofton::OcclusionOptions{.list_occluded = true}}, visible)
            .value();
        CHECK(visible.verdict_of(behind.index) == crofton::occlude::Verdict::occluded);
    }
}
