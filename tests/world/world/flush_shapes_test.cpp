// SPDX-License-Identifier: MIT
// Shapes that move over objects which lie flush: tiles of a floor, walls on it.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <crofton/crofton.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "../../shape/convex/flat_floors.hpp"

using namespace crofton;
using namespace crofton::testing;

namespace {

Obb box_around(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 half = glm::max(glm::abs(shape.bounds().min), glm::abs(shape.bounds().max)) * 1.000001;
    return {pose.translation, glm::mat3(pose.rotation), glm::vec3(half)};
}

ObjectHandle add(World& world, const convex::Shape& shape, const RigidTransform& pose, std::uint32_t layers,
                 std::uint32_t collides_with) {
    ObjectDescription object;
    object.bound = box_around(shape, pose);
    object.layers = layers;
    object.collides_with = collides_with;
    const ObjectHandle handle = world.add(object).value();
    REQUIRE(world.set_shape(handle, &shape).has_value());
    return handle;
}

// Tiles that do not collide with each other, as static ones do not, or do.
struct TiledWorld {
    World world;
    RigidTransform frame;

    TiledWorld(const Floor& floor, const RigidTransform& place, bool tiles_collide) : frame(place) {
        for (const convex::CompoundChild& tile : floor.parts)
            add(world, tile.shape, placed_in(frame, tile.pose), 1, tiles_collide ? 3 : 2);
    }
};

World world_of(const Floor& floor, const RigidTransform& frame) {
    World world;
    for (const convex::CompoundChild& tile : floor.parts) {
        const RigidTransform pose = placed_in(frame, tile.pose);
        REQUIRE(world.add({.transform = Transform{pose.rotation, pose.translation}, .shape = &tile.shape}).has_value());
    }
    REQUIRE(world.update().has_value());
    return world;
}

// Another kind of tiles each round.
Floor floor_of(RandomShapes& random, int round) {
    constexpr std::array kinds{Tiles::boxes, Tiles::turned_boxes, Tiles::hulls, Tiles::prisms};
    if (round % 5 == 4) return triangulated(random, 0.5f, false);
    return strips(random, kinds[static_cast<std::size_t>(round % 5)], round % 2 == 0, 0.5f);
}

}  // namespace

TEST_SUITE("world/flush_shapes") {
    TEST_CASE("shapes that slide over tiles that lie flush are pushed along the floor's normal alone") {
        RandomShapes random(71);
        const Sliders sliders(random);
        int touching = 0, several = 0;
        for (int round = 0; round < 8; ++round) {
            CAPTURE(round);
            const Floor floor = floor_of(random, round);
            const RigidTransform frame{round % 3 == 0 ? glm::dmat3(1.0) : random.rotation(),
                                       (round % 2 == 0 ? 0.0 : 100.0) * random.direction()};
            TiledWorld tiled(floor, frame, round == 1);
            World& world = tiled.world;
            std::vector<ObjectHandle> movers;
            for (const convex::Shape& shape : sliders.shapes) movers.push_back(add(world, shape, frame, 2, 1));
            for (int frame_number = 0; frame_number < 12; ++frame_number) {
                CAPTURE(frame_number);
                std::vector<double> depths;
                for (std::size_t i = 0; i < movers.size(); ++i) {
                    const convex::Shape& shape = sliders.shapes[i];
                    const double depth = std::pow(10.0, -random.number(1.7, 4.0));
                    const glm::dmat3 turn = around_y(random.number(0, 6.2));
                    const RigidTransform pose = placed_in(
                        frame, {turn, {random.number(-2, 2), below(shape, turn) - depth, random.number(-2, 2)}});
                    depths.push_back(depth);
                    REQUIRE(world.set_bound(movers[i], box_around(shape, pose)).has_value());
                }
                REQUIRE(world.update().has_value());
                for (std::size_t i = 0; i < movers.size(); ++i) {
                    double deepest = -1.0;
                    int pairs = 0;
                    for (const Contact& contact : world.contacts()) {
                        if (contact.first.object != movers[i] && contact.second.object != movers[i]) continue;
                        if (contact.phase == ContactPhase::ended) continue;
                        const double side = contact.second.object == movers[i] ? 1.0 : -1.0;
                        ++pairs;
                        for (const convex::TrackedPoint& p : contact.shape_points) {
                            CAPTURE(i);
                            CHECK(glm::distance(side * p.normal, glm::normalize(frame.rotation[1])) <= 2e-3);
                            const glm::dvec3 on_floor = p.contact.position + side * 0.5 * p.contact.depth * p.normal;
                            CHECK(std::abs(glm::dot(on_floor - frame.translation, frame.rotation[1])) <= 1e-4);
                            deepest = std::max(deepest, p.contact.depth);
                        }
                    }
                    CHECK(deepest == doctest::Approx(depths[i]).epsilon(1e-9).scale(6e-5 / 1e-9));
                    touching += pairs > 0 ? 1 : 0;
                    several += pairs > 1 ? 1 : 0;
                }
            }
        }
        CHECK(touching == 8 * 12 * 11);
        CHECK(several > 200);
    }

    TEST_CASE("a cast slides over tiles that are objects, lands on them and presses on them with the floor's normal") {
        RandomShapes random(9500);
        const Sliders sliders(random);
        for (int round = 0; round < 80; ++round) {
            CAPTURE(round);
            const Floor floor = floor_of(random, round);
            const RigidTransform frame{round % 3 == 0 ? glm::dmat3(1.0) : random.rotation(),
                                       (round % 2 == 0 ? 0.0 : 100.0) * random.direction()};
            const World world = world_of(floor, frame);
            const glm::dvec3 up = frame.rotation[1];
            for (int i = 0; i < 40; ++i) {
                const convex::Shape& mover = sliders.shapes[static_cast<std::size_t>(random.index(11))];
                const bool lattice = random.index(3) == 0, lands = i % 4 == 3;
                const glm::dmat3 turn = lattice ? glm::dmat3(1.0) : random.rotation();
                const std::array gaps{0.0, random.number(-1, 1) * 1e-9, random.number(-1, 1) * 1e-7,
                                      random.number(-8, 8) * 1e-7};
                const double gap =
                    lands ? std::exp2(random.number(-24.0, 0.0)) : gaps[static_cast<std::size_t>(random.index(4))];
                glm::dvec3 place(random.number(-1, 1), 0.0, random.number(-1, 1));
                if (lattice) place = glm::round(place * 4.0) / 4.0;
                place.y = below(mover, turn) + gap;
                const RigidTransform from = placed_in(frame, {turn, place});
                const glm::dvec3 way(random.number(-1, 1), 0.0, random.number(-1, 1));
                const auto go = [&](double rise) {
                    return world.cast(mover, from, {frame.rotation * (way + glm::dvec3(0, rise, 0)), {}, {}}, {})
                        .value();
                };
                CAPTURE(gap);
                CAPTURE(lattice);
                if (!lands) {
                    CHECK_FALSE(go(0.0).has_value());
                    CHECK_FALSE(go(random.number(0.01, 1.0)).has_value());
                }
                const double fall = lands ? gap / random.number(0.1, 0.9) : random.number(0.01, 1.0);
                const auto hit = go(-fall);
                REQUIRE(hit.has_value());
                CHECK(glm::length(hit->normal + up) < 1.7453e-3);
                const double left = gap - hit->time * fall;
                CHECK(left >= (lands ? -1e-9 : gap - 1e-9));
                CHECK(left <= 1e-6);
                CHECK(std::abs(hit->distance - left) < 1e-8);
            }
        }
    }

    TEST_CASE(
        "what begins within the tolerance over corners of tiles, and lands as flat as that, has the floor's normal") {
        RandomShapes random(9600);
        const Sliders sliders(random);
        for (int round = 0; round < 84; ++round) {
            CAPTURE(round);
            const Floor floor = round % 7 < 6 ? strips(random, static_cast<Tiles>(round % 7), round % 3 == 0, 0.5f)
                                              : triangulated(random, 0.5f, round % 2 == 0);
            const std::vector<glm::dvec3> corners = corners_of(floor);
            const RigidTransform frame{round % 2 == 0 ? glm::dmat3(1.0) : random.rotation(),
                                       (round % 5 == 0 ? 100.0 : 0.0) * random.direction()};
            const World world = world_of(floor, frame);
            for (int i = 0; i < 250; ++i) {
                const int kind = random.index(11);
                const convex::Shape& mover = sliders.shapes[static_cast<std::size_t>(kind)];
                const bool lattice = random.index(3) == 0;
                const glm::dmat3 turn = lattice ? glm::dmat3(1.0) : random.rotation();
                // Down to below the edges of cracks.
                const double gap = std::exp2(random.number(-24.0, -14.0));
                const double fall = std::max(gap / random.number(0.1, 0.9), gap + 2e-6);
                const double z = random.number(-1, 1), x = random.number(-1, 1);
                glm::dvec3 place(x, 0.0, z);
                if (lattice) place = glm::round(place * 4.0) / 4.0;
                const double way_z = random.number(-1, 1), way_x = random.number(-1, 1);
                if (i % 3 == 0)
                    place = over_corner(random, corners, mover, turn, gap / fall * glm::dvec3(way_x, 0, way_z));
                place.y = below(mover, turn) + gap;
                const glm::dvec3 velocity = frame.rotation * glm::dvec3(way_x, -fall, way_z);
                const RigidTransform from = placed_in(frame, {turn, place});
                CAPTURE(kind);
                CAPTURE(gap);
                CAPTURE(lattice);
                const auto hit = world.cast(mover, from, {velocity, {}, {}}, {}).value();
                REQUIRE(hit.has_value());
                CHECK(glm::length(hit->normal + frame.rotation[1]) < 1.7453e-3);
                const double left = gap - hit->time * fall;
                CHECK(left >= (kind == 10 ? -1e-7 : -1e-9));  // of a rounded cylinder
                CHECK(left <= 1e-6);
                CHECK(std::abs(hit->distance - left) < 1e-8);
                CHECK(std::abs(glm::dot(hit->point - frame.translation, frame.rotation[1])) < 1e-8);
            }
        }
    }

    TEST_CASE("a wall on tiles pushes sideways, and the tiles up, the contact changes when a tile comes or goes") {
        World world;
        const convex::Shape tile = convex::Shape::box({1, 0.5f, 4}).value(),
                            wall = convex::Shape::box({0.5f, 1, 4}).value(),
                            crate = convex::Shape::box({0.25f, 0.25f, 0.25f}).value();
        const ObjectHandle left = add(world, tile, at({-1, -0.5, 0}), 1, 2);
        add(world, tile, at({1, -0.5, 0}), 1, 2);
        add(world, wall, at({1.5, 1, 0}), 1, 2);
        const ObjectHandle mover = add(world, crate, at({0.75, 0.245, 0}), 2, 1);
        const auto normals = [&] {
            std::vector<glm::dvec3> result;
            for (const Contact& contact : world.contacts())
                for (const convex::TrackedPoint& point : contact.shape_points)
                    if (contact.phase != ContactPhase::ended) {
                        const glm::dvec3 n = (contact.second.object == mover ? 1.0 : -1.0) * point.normal;
                        if (std::none_of(result.begin(), result.end(),
                                         [&](const glm::dvec3& m) { return glm::distance(m, n) < 1e-6; }))
                            result.push_back(n);
                    }
            return result;
        };
        const auto move = [&](const glm::dvec3& to) {
            REQUIRE(world.set_bound(mover, box_around(crate, at(to))).has_value());
            REQUIRE(world.update().has_value());
        };
        move({0.752, 0.245, 0});
        CHECK(normals().size() == 2);  // up, and away from the wall
        // Over the seam, at rest while the other tile goes: then the edge that is left is a real one.
        move({-0.248, 0.245, 0});
        CHECK(normals().size() == 1);
        CHECK(normals()[0].y == doctest::Approx(1.0));
        REQUIRE(world.update().has_value());
        CHECK(normals().size() == 1);
        REQUIRE(world.remove(left).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(normals().size() == 1);
        CHECK(normals()[0].x == doctest::Approx(-1.0));
        CHECK(world.statistics().shape_pairs_computed == 1);
        const ObjectHandle again = add(world, tile, at({-1, -0.5, 0}), 1, 2);
        REQUIRE(world.update().has_value());
        REQUIRE(normals().size() == 1);
        CHECK(normals()[0].y == doctest::Approx(1.0));
        // Moved down by a centimetre the tile leaves a step.
        REQUIRE(world.set_bound(again, box_around(tile, at({-1, -0.51, 0}))).has_value());
        REQUIRE(world.update().has_value());
        REQUIRE(normals().size() == 1);
        CHECK(normals()[0].x == doctest::Approx(-1.0));
    }
}
