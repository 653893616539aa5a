// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <oracle/plain_pvs.hpp>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

oracle::Pairs pairs_of(const Bake& bake, std::size_t cells, std::size_t objects) {
    oracle::Pairs pairs;
    for (std::size_t c = 0; c < cells; ++c)
        for (std::uint32_t o = 0; o < objects; ++o)
            if (bake.is_seen(c, o)) pairs.insert({c, o});
    return pairs;
}

// ε for which so many lines through the smallest cell are enough.
double epsilon_for(double lines, std::size_t pairs, double confidence) {
    return std::log(static_cast<double>(pairs) / (1.0 - confidence)) / lines;
}

}  // namespace

TEST_SUITE("pvs/bake") {
    TEST_CASE("options, objects and triangles that make no sense are named errors") {
        BakeGeometry geometry = random_geometry(1, 5);
        const Cells cells = Cells::grid({{-5.0, 0.0, -5.0}, {5.0, 2.0, 5.0}}, {4, 1, 4}).value();
        for (const double bad : {0.0, -1.0, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
            CHECK(error_of(Bake::create(geometry, cells, {.epsilon = bad})).code == ErrorCode::invalid_argument);
            CHECK(error_of(Bake::create(geometry, cells, {.confidence = bad})).code == ErrorCode::invalid_argument);
        }
        CHECK(error_of(Bake::create(geometry, cells, {.epsilon = 1e-14})).code == ErrorCode::out_of_range);
        geometry.object_of[7] = 5;
        CHECK(error_of(Bake::create(geometry, cells)).code == ErrorCode::out_of_range);
        CHECK(error_of(Bake::create(geometry, cells)).item == 7);
        geometry.object_of[7] = 0;
        geometry.mesh.positions[3].y = std::numeric_limits<float>::infinity();
        CHECK(error_of(Bake::create(geometry, cells)).item == 3);
        geometry.mesh.positions[3].y = 0.0f;
        for (std::size_t i = 0; i < geometry.boxes.size(); ++i) {
            BakeGeometry bad = geometry;
            bad.boxes[i].half_extents.x = -1.0f;
            CHECK(error_of(Bake::create(bad, cells)).item == i);
        }
        CHECK(error_of(Bake::create(BakeGeometry{}, cells)).code == ErrorCode::empty);
        CHECK(error_of(Bake::create(random_geometry(1, 5), Cells{})).code == ErrorCode::empty);
        geometry.object_of.pop_back();
        CHECK(error_of(Bake::create(geometry, cells)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("witnesses what a plain walk along the same lines does, in grids and boxes, with either kind of sides") {
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const BakeGeometry geometry = random_geometry(seed, 12);
            const bool boxes = seed % 2 == 0;
            std::vector<Aabb> few;
            sampling::Random random(seed + 100);
            for (int i = 0; i < 20; ++i) {
                const auto at = random.point<3>();
                const auto size = random.point<3>();
                few.push_back(box_around({16.0 * at[0] - 8.0, 3.0 * at[1], 16.0 * at[2] - 8.0},
                                         {0.5 + size[0], 0.5 + size[1], 0.5 + size[2]}));
            }
            const Cells cells = boxes ? Cells::boxes(few).value()
                                      : Cells::grid({{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}}, {5, 2, 5}).value();
            BakeOptions options{.confidence = 0.9, .seed = seed};
            options.sides = seed % 3 == 0 ? occlude::Sides::front : occlude::Sides::both;
            options.epsilon = epsilon_for(300.0, cells.size() * 12, 0.9);
            Bake bake = Bake::create(geometry, cells, options).value();
            REQUIRE(bake.run().has_value());
            REQUIRE(bake.is_complete());
            CAPTURE(seed);
            CHECK(bake.lines_planned() < 60 * 4096);
            const auto expected = oracle::witnessed(geometry, cells, options);
            const auto found = pairs_of(bake, cells.size(), 12);
            CHECK(found.size() > 100);
            CHECK(found.size() < cells.size() * 12);
            CHECK(found == expected);
        }
    }

    TEST_CASE("witnesses what a plain walk does in convex cells, near and far, together and each by itself") {
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const BakeGeometry geometry =
                random_geometry(seed, 12, (seed % 2 ? 1e5 : 0.0) * glm::dvec3(1.0, -0.7, 0.3));
            const bool far_apart = seed % 3 == 0;
            std::vector<ConvexCell> convex;
            sampling::Random random(seed + 100);
            for (int i = 0; i < (far_apart ? 3 : 20); ++i) {
                const double x = random.uniform(-8.0, 8.0), y = random.uniform(0.0, 3.0), z = random.uniform(-8.0, 8.0);
                const glm::dvec3 at(x, y, z + (far_apart ? 400.0 * i : 0.0));
                convex.push_back(random_cell(random, geometry.origin + at, 2.0));
            }
            const Cells cells = Cells::convex(convex).value();
            const BakeOptions options{.epsilon = epsilon_for(far_apart ? 4000.0 : 60.0, cells.size() * 12, 0.9),
                                      .confidence = 0.9,
                                      .seed = seed,
                                      .sides = seed % 4 == 0 ? occlude::Sides::front : occlude::Sides::both};
            Bake bake = Bake::create(geometry, cells, options).value();
            REQUIRE(bake.run().has_value());
            REQUIRE(bake.is_complete());
            CHECK(bake.epsilon_reached() <= options.epsilon);
            CAPTURE(seed);
            const auto found = pairs_of(bake, cells.size(), 12);
            CHECK(found.size() > (far_apart ? 10 : 100));
            CHECK(found == oracle::witnessed(geometry, cells, options));
        }
    }

    TEST_CASE("as many lines of the box around a convex cell meet it as their surfaces say") {
        sampling::Random random(5);
        for (int i = 0; i < 20; ++i) {
            const ConvexCell cell = random_cell(random, {}, 1.0);
            const Cells cells = Cells::convex(std::vector<ConvexCell>{cell}).value();
            const Aabb box = cells.box(0);
            const glm::dvec3 e = box.max - box.min;
            const double share = cells.surface(0) / (2.0 * (e.x * e.y + e.y * e.z + e.z * e.x));
            constexpr int kLines = 4000;
            int met = 0;
            for (int n = 0; n < kLines; ++n) {
                double begin, end;
                met += oracle::span_in(cell, {}, sampling::line_from_box(box, random.point<5>()), begin, end);
            }
            CHECK(std::abs(met - kLines * share) < 5.0 * std::sqrt(kLines * share * (1.0 - share)) + 1.0);
        }
    }

    TEST_CASE("cells that are few and far apart get lines of their own, and witness the same as the plain walk") {
        const BakeGeometry geometry = random_geometry(8, 12);
        const std::vector<Aabb> far = {box_around({-400.0, 1.0, 0.0}, glm::dvec3(0.5)),
                                       box_around({0.0, 1.0, 0.0}, glm::dvec3(0.6)),
                                       box_around({3.0, 2.0, 500.0}, glm::dvec3(0.5))};
        const Cells cells = Cells::boxes(far).value();
        const BakeOptions options{.epsilon = epsilon_for(8000.0, 36, 0.9), .confidence = 0.9};
        Bake bake = Bake::create(geometry, cells, options).value();
        CHECK(bake.lines_planned() == 6 * 4096);
        REQUIRE(bake.run({.lines = 1}).has_value());
        REQUIRE(bake.is_complete());
        CHECK(bake.epsilon_reached() <= options.epsilon);
        CHECK(pairs_of(bake, 3, 12) == oracle::witnessed(geometry, cells, options));
    }

    TEST_CASE("the guarantee's number of lines is that of the theory") {
        const BakeGeometry geometry = random_geometry(2, 10);
        // A cell of 1 × 1 × 1 in a box of 10 × 1 × 10 has 6/240 of its surface.
        const Cells cells = Cells::grid({{0.0, 0.0, 0.0}, {10.0, 1.0, 10.0}}, {10, 1, 10}).value();
        Bake bake = Bake::create(geometry, cells, {.epsilon = 5e-4, .confidence = 0.99}).value();
        const double expected = std::log(1000.0 / 0.01) / 5e-4 * 240.0 / 6.0;
        CHECK(static_cast<double>(bake.lines_planned()) >= expected);
        CHECK(static_cast<double>(bake.lines_planned()) <= expected + 12 * 4096.0 + 40.0);  // six faces, two rounds
        CHECK(bake.epsilon_reached() > 1.0);
        // Half of the lines: the first round, and a part of the next that does not count yet.
        REQUIRE(bake.run({.lines = bake.lines_planned() / 2 + 6 * 4096}).has_value());
        CHECK_FALSE(bake.is_complete());
        CHECK(bake.epsilon_reached() <= 1.01e-3);
        CHECK(bake.epsilon_reached() >= 0.95e-3);
        REQUIRE(bake.run().has_value());
        CHECK(bake.epsilon_reached() <= 0.5e-3);
        CHECK(bake.epsilon_reached() >= 0.49e-3);
    }

    TEST_CASE("a pair is missed as often as its share of the lines says, and no more than the bound allows") {
        // A small plate opposite a small cell, far away: nearly all lines through both are lines from one to the other,
        // in a measure of A_plate · A_cell's shadow / distance². The share of the cell's lines is that over π/2 · F.
        const double side = 0.06, distance = 3.0, edge = 0.5;
        BakeGeometry geometry;
        add_box(geometry, box_around({0.0, 0.0, distance}, {side / 2, side / 2, 1e-4}));
        const Cells cells = Cells::boxes(std::vector<Aabb>{box_around({}, glm::dvec3(edge / 2))}).value();
        const double share =
            side * side * edge * edge / (distance * distance) / (std::numbers::pi / 2 * 6 * edge * edge);
        int missed = 0;
        const int bakes = 200;
        double lines = 0.0;
        for (int i = 0; i < bakes; ++i) {
            Bake bake = Bake::create(geometry, cells,
                                     {.epsilon = epsilon_for(4000.0, 1, 0.5),
                                      .confidence = 0.5,
                                      .seed = 1000 + static_cast<std::uint64_t>(i)})
                            .value();
            REQUIRE(bake.run().has_value());
            lines = static_cast<double>(bake.lines_done());
            missed += !bake.is_seen(0, 0);
        }
        const double expected = bakes * std::exp(-share * lines);
        CHECK(expected > 40.0);
        CHECK(std::abs(missed - expected) < 4.0 * std::sqrt(expected * (1.0 - expected / bakes)) + 0.05 * expected);
    }

    TEST_CASE("same bits on one thread and three, in one run and in many") {
        const BakeGeometry geometry = random_geometry(3, 30);
        const Cells cells = Cells::grid({{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}}, {9, 2, 9}).value();
        const BakeOptions options{.epsilon = 4e-4, .confidence = 0.9};
        Bake one = Bake::create(geometry, cells, options).value();
        REQUIRE(one.run().has_value());
        Bake many = Bake::create(geometry, cells, options).value();
        ThreadPool pool(3);
        int runs = 0;
        for (; !many.is_complete(); ++runs) REQUIRE(many.run({.lines = 1}, pool).has_value());
        CHECK(runs > 1);
        CHECK(plain(one.state().value()) == plain(many.state().value()));
    }

    TEST_CASE("same bits on every instruction set, in grids and among cells of the caller's") {
        const BakeGeometry geometry = random_geometry(9, 30, {1e7, -1e7, 0.5e7});
        const glm::dvec3 o = geometry.origin;
        std::vector<Aabb> few;
        sampling::Random random(10);
        for (int i = 0; i < 30; ++i) {
            const auto at = random.point<3>();
            few.push_back(
                box_around(o + glm::dvec3(16.0 * at[0] - 8.0, 3.0 * at[1], 16.0 * at[2] - 8.0), glm::dvec3(1.0)));
        }
        const Aabb bounds{o + glm::dvec3(-10.0, 0.0, -10.0), o + glm::dvec3(10.0, 3.0, 10.0)};
        // 200 in a row: more steps than there is room for at first.
        for (const Cells& cells : {Cells::grid(bounds, {9, 2, 7}).value(), Cells::grid(bounds, {200, 1, 1}).value(),
                                   Cells::boxes(few).value()}) {
            std::vector<std::byte> first;
            for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
                hwy::SetSupportedTargetsForTest(rest & -rest);
                CAPTURE(hwy::TargetName(rest & -rest));
                Bake bake = Bake::create(geometry, cells, {.epsilon = 1e-2, .confidence = 0.9}).value();
                REQUIRE(bake.run().has_value());
                const auto bytes = plain(bake.state().value());
                if (first.empty()) first = bytes;
                CHECK(bytes == first);
            }
            hwy::SetSupportedTargetsForTest(0);
        }
    }

    TEST_CASE("a scene far from the origin has the pairs that it has near") {
        // 2^23 keeps all of these coordinates as they are.
        const glm::dvec3 far(8388608.0, -8388608.0, 16777216.0);
        const BakeGeometry near_by = random_geometry(4, 20), far_away = [&] {
            BakeGeometry moved = random_geometry(4, 20);
            moved.origin = far;
            for (Obb& box : moved.boxes) box.center += far;
            return moved;
        }();
        const Aabb bounds{{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}};
        const BakeOptions options{.epsilon = 1e-2, .confidence = 0.9};
        Bake here = Bake::create(near_by, Cells::grid(bounds, {8, 2, 8}).value(), options).value();
        Bake there =
            Bake::create(far_away, Cells::grid({bounds.min + far, bounds.max + far}, {8, 2, 8}).value(), options)
                .value();
        REQUIRE(here.run().has_value());
        REQUIRE(there.run().has_value());
        CHECK(pairs_of(here, 128, 20) == pairs_of(there, 128, 20));
    }

    TEST_CASE("cells in solids, in a closed room and in the open get different kinds") {
        BakeGeometry room;
        add_box(room, {{0.0, 0.0, 0.0}, {12.0, 4.0, 12.0}}, true);
        add_box(room, {{4.0, 0.0, 4.0}, {8.0, 4.0, 8.0}});  // a block as high as the room
        const Cells cells = Cells::grid({{0.0, 0.0, 0.0}, {12.0, 4.0, 12.0}}, {3, 1, 3}).value();
        const BakeOptions options{.epsilon = 1e-3, .confidence = 0.9};
        const auto kinds_of = [&](const BakeGeometry& geometry) {
            Bake bake = Bake::create(geometry, cells, options).value();
            REQUIRE(bake.run().has_value());
            return Pvs::finish(bake).value();
        };
        const Pvs closed = kinds_of(room);
        for (std::size_t c = 0; c < 9; ++c) CHECK(closed.kind(c) == (c == 4 ? CellKind::solid : CellKind::inner));
        CHECK(closed.find_cell({6.0, 2.0, 6.0}) == kNoCell);
        CHECK(closed.visible_from(4, Mode::statistical)[0] == 0);
        CHECK(closed.visible_from(3, Mode::statistical)[0] == 3);

        // A leak: a triangle of the room's ceiling is missing.
        room.mesh.indices.erase(room.mesh.indices.begin() + 18, room.mesh.indices.begin() + 21);
        room.object_of.erase(room.object_of.begin());
        const Pvs leaking = kinds_of(room);
        int open = 0;
        for (std::size_t c = 0; c < 9; ++c) open += leaking.kind(c) == CellKind::open;
        CHECK(open == 8);
        CHECK(leaking.visible_from(3, Mode::statistical)[0] == 3);
    }

    TEST_CASE("objects behind a wall are not seen, and a door lets lines through") {
        const auto rooms = [](bool door) {
            BakeGeometry geometry;
            add_box(geometry, {{-6.0, 0.0, -3.0}, {6.0, 3.0, 3.0}}, true);
            add_box(geometry, {{-0.2, 0.0, -3.0}, {0.2, 3.0, door ? -0.5 : 3.0}});
            if (door) add_box(geometry, {{-0.2, 0.0, 0.5}, {0.2, 3.0, 3.0}});
            add_box(geometry, box_around({4.0, 1.0, 2.0}, glm::dvec3(0.3)));
            return geometry;
        };
        const Cells cells = Cells::grid({{-6.0, 0.0, -3.0}, {6.0, 3.0, 3.0}}, {2, 1, 1}).value();
        for (const bool door : {false, true}) {
            Bake bake = Bake::create(rooms(door), cells, {.epsilon = 1e-4, .confidence = 0.9}).value();
            REQUIRE(bake.run().has_value());
            const std::uint32_t thing = door ? 3 : 2;
            CHECK(bake.is_seen(0, thing) == door);
            CHECK(bake.is_seen(1, thing));
        }
    }

    TEST_CASE("sheets back to back at one place are seen from both of their sides") {
        // Two one-sided plates at z = 0 that face away from each other, each an object.
        BakeGeometry geometry;
        geometry.mesh.positions = {{-1.f, -1.f, 0.f}, {1.f, -1.f, 0.f}, {1.f, 1.f, 0.f}, {-1.f, 1.f, 0.f}};
        geometry.mesh.indices = {0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2};
        geometry.object_of = {0, 0, 1, 1};  // 0 looks along +z
        geometry.boxes.assign(2, obb_of(Aabb{{-1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}}));
        const std::vector<Aabb> sides = {box_around({0.0, 0.0, 3.0}, glm::dvec3(1.0)),
                                         box_around({0.0, 0.0, -3.0}, glm::dvec3(1.0))};
        for (const occlude::Sides which : {occlude::Sides::both, occlude::Sides::front}) {
            Bake bake = Bake::create(geometry, Cells::boxes(sides).value(),
                                     {.epsilon = 1e-3, .confidence = 0.9, .sides = which})
                            .value();
            REQUIRE(bake.run().has_value());
            CHECK(bake.is_seen(0, 0));
            CHECK(bake.is_seen(1, 1));
            CHECK_FALSE(bake.is_seen(0, 1));
            CHECK_FALSE(bake.is_seen(1, 0));
        }
    }

    TEST_CASE("an object without triangles is in every set, and one that no cell sees in none") {
        BakeGeometry geometry;
        add_box(geometry, box_around({0.0, 0.0, 0.0}, glm::dvec3(3.0)));
        add_box(geometry, box_around({0.0, 0.0, 0.0}, glm::dvec3(1.0)));  // within the first
        geometry.boxes.push_back(geometry.boxes[0]);                      // moves
        const Cells cells = Cells::grid({{5.0, -1.0, -1.0}, {7.0, 1.0, 1.0}}, {2, 2, 2}).value();
        Bake bake = Bake::create(geometry, cells, {.epsilon = 1e-3, .confidence = 0.9}).value();
        REQUIRE(bake.run().has_value());
        const Pvs pvs = Pvs::finish(bake).value();
        for (std::uint32_t c = 0; c < 8; ++c) CHECK(pvs.visible_from(c, Mode::statistical)[0] == 0b101);
        CHECK_FALSE(pvs.is_baked(2));
        CHECK(pvs.counts().seen == 8);
        CHECK(pvs.counts().all() == 16);
    }
}
