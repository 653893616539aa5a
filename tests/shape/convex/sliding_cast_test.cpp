// SPDX-License-Identifier: MIT
// Casts of shapes that slide over flush parts, land on them, and meet what stands on them.
#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <vector>

#include "flat_floors.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

constexpr double kTenthOfADegree = 1.7453e-3;

// A floor whose top is y = 0 of a frame, in one of the forms that shapes of parts have.
struct Ground {
    Floor tiles;
    Surface surface;
    std::vector<float> zeros;
    std::optional<HeightField> field;
    std::optional<Compound> compound;
    std::optional<Shape> shape;
    RigidTransform pose;

    Ground(RandomShapes& random, int form, const RigidTransform& frame) : pose(frame) {
        if (form < 6) {
            tiles = form == 5 ? triangulated(random, 0.5f, random.index(2) == 0)
                              : strips(random, static_cast<Tiles>(form), random.index(2) == 0, 0.5f);
            compound = Compound::build(tiles.parts).value();
            shape = Shape::compound(*compound);
        } else if (form == 6) {
            surface = ground(
                random, 12, 0.5, [](double, double) { return 0.0; }, random.index(2) * 0.3);
            shape = surface.shape(random.index(2) == 0 ? Sides::both : Sides::front);
        } else {
            zeros.assign(13 * 13, 0.0f);
            field = HeightField::build({.columns = 13, .rows = 13, .heights = zeros, .spacing = {0.5, 0.5}}).value();
            shape = Shape::height_field(*field);
            pose = placed_in(frame, at({-3, 0, -3}));
        }
    }
};

RigidTransform any_frame(RandomShapes& random, int kind) {
    if (kind == 0) return at({});
    if (kind == 1) return {around_y(random.number(0, 6)), 10.0 * random.direction()};
    const glm::dmat3 turn = random.rotation();
    const glm::dvec3 direction = random.direction();
    return {turn, std::exp2(random.number(0.0, 10.0)) * direction};
}

// A cast of a mover over the ground, with either as the first shape. The normal is from the ground.
struct Answer {
    Impact impact;
    glm::dvec3 normal;
};
Answer go(const Ground& ground, const Shape& mover, const RigidTransform& from, const Motion& motion, bool ground_first,
          const CastOptions& options = {}) {
    const ShapeAtPose floor{*ground.shape, ground.pose}, shape{mover, from};
    const Impact i = ground_first ? cast(floor, {}, shape, motion, options).value()
                                  : cast(shape, motion, floor, {}, options).value();
    return {i, ground_first ? i.normal : -i.normal};
}

bool is_up(const Answer& answer, const glm::dvec3& up) {
    return glm::length(glm::cross(answer.normal, up)) < kTenthOfADegree && glm::dot(answer.normal, up) > 0.0;
}

// Somewhere over the middle of the floor; on a lattice now and then, where corners and edges come together.
glm::dvec3 any_place(RandomShapes& random, bool lattice) {
    const double z = random.number(-1.2, 1.2), x = random.number(-1.2, 1.2);
    const glm::dvec3 place(x, 0.0, z);
    return lattice ? glm::round(place * 4.0) / 4.0 : place;
}

}  // namespace

TEST_SUITE("convex/sliding_cast") {
    TEST_CASE("a shape in contact with a floor of flush parts slides and leaves without a hit, and presses on it up") {
        RandomShapes random(9100);
        const Sliders sliders(random);
        std::vector<CompoundChild> shoes{{Shape::box({0.2f, 0.125f, 0.2f}).value(), at({-0.2, 0, 0})},
                                         {Shape::box({0.25f, 0.125f, 0.25f}).value(), at({0.25, 0, 0})}};
        const Compound pair = Compound::build(shoes).value();
        for (int round = 0; round < 240; ++round) {
            const RigidTransform frame = any_frame(random, random.index(3));
            const Ground ground(random, round % 8, frame);
            const glm::dvec3 up = frame.rotation[1];
            for (std::size_t kind = 0; kind <= sliders.shapes.size(); ++kind) {
                const bool is_pair = kind == sliders.shapes.size(), lattice = random.index(3) == 0;
                const Shape mover = is_pair ? Shape::compound(pair) : sliders.shapes[kind];
                glm::dmat3 turn = lattice && random.index(2) == 0 ? glm::dmat3(1.0) : around_y(random.number(0, 6));
                if (!lattice && !is_pair && random.index(2) == 0) turn = random.rotation();
                const std::array gaps{0.0, random.number(-1, 1) * 1e-9, random.number(-1, 1) * 1e-7,
                                      random.number(-8, 8) * 1e-7};
                const double gap = gaps[static_cast<std::size_t>(random.index(4))];
                const double low = is_pair ? 0.125 : below(mover, turn);
                glm::dvec3 place = any_place(random, lattice);
                place.y = low + gap;
                const RigidTransform from = placed_in(frame, {turn, place});
                const double way_z = random.number(-1.5, 1.5), way_x = random.number(-1.5, 1.5);
                glm::dvec3 way(way_x, 0.0, way_z);
                if (lattice && random.index(2) == 0) way[2 * random.index(2)] = 0.0;
                const double rise = std::exp2(random.number(-8.0, 1.0));
                const bool ground_first = random.index(2) == 0;
                CAPTURE(round);
                CAPTURE(kind);
                CAPTURE(gap);
                CAPTURE(lattice);
                const auto move = [&](double y) {
                    return Motion{frame.rotation * (way + glm::dvec3(0, y, 0)), {}, {}};
                };
                CHECK(go(ground, mover, from, move(0.0), ground_first).impact.result == CastResult::miss);
                CHECK(go(ground, mover, from, move(rise), ground_first).impact.result == CastResult::miss);
                // To spin about the floor's normal is to slide, too.
                Motion spinning = move(0.0);
                spinning.spin = random.number(-20, 20) * up;
                CHECK(go(ground, mover, from, spinning, ground_first).impact.result == CastResult::miss);
                const Answer in = go(ground, mover, from, move(-rise), ground_first);
                REQUIRE(in.impact.result == CastResult::hit);
                CHECK(in.impact.time * rise <= 1e-6);
                CHECK(is_up(in, up));
                CHECK(std::abs(in.impact.distance - gap + in.impact.time * rise) < 1e-8);
                // Sunk in, and told that this is no hit; beside an edge the way out would be sideways.
                if (lattice) continue;
                RigidTransform sunk = from;
                sunk.translation -= random.number(1e-6, 1e-4) * up;
                CastOptions options;
                options.ignore_initial_overlaps = true;
                CHECK(go(ground, mover, sunk, move(0.0), ground_first, options).impact.result == CastResult::miss);
            }
        }
    }

    TEST_CASE(
        "what lands on a floor of flush parts has the floor's normal, however flat its way, at the plane's time") {
        RandomShapes random(9200);
        const Sliders sliders(random);
        // On a flat way a corner is within the tolerance for long, so that seams are often beside it.
        for (int round = 0; round < 480; ++round) {
            const RigidTransform frame = any_frame(random, random.index(3));
            const Ground ground(random, round % 8, frame);
            const std::vector<glm::dvec3> corners = corners_of(ground.tiles);
            for (const Shape& mover : sliders.shapes) {
                // On the lattice edges lie over seams, to rounding.
                const bool lattice = random.index(3) == 0;
                const glm::dmat3 turn = lattice ? glm::dmat3(1.0) : random.rotation();
                const double steep = random.number(-12.0, 0.0), flat = random.number(-24.0, -12.0);
                const double height = std::exp2(round / 8 % 2 == 0 ? flat : steep);
                // Down to below the edges of cracks.
                const double when = std::min(random.number(0.05, 0.9), height / (height + 2e-6));
                glm::dvec3 place = any_place(random, lattice);
                const double velocity_z = random.number(-1.5, 1.5), velocity_x = random.number(-1.5, 1.5);
                const glm::dvec3 velocity(velocity_x, -height / when, velocity_z);
                if (ground.compound && round / 8 % 3 == 0)
                    place = over_corner(random, corners, mover, turn, when * velocity);
                place.y = below(mover, turn) + height;
                const RigidTransform from = placed_in(frame, {turn, place});
                const Answer hit = go(ground, mover, from, {frame.rotation * velocity, {}, {}}, random.index(2) == 0);
                CAPTURE(round);
                CAPTURE(height);
                REQUIRE(hit.impact.result == CastResult::hit);
                CHECK(is_up(hit, frame.rotation[1]));
                const double left = height - hit.impact.time * height / when;
                CHECK(left >= -1e-9);
                CHECK(left <= 1e-6);
                CHECK(std::abs(hit.impact.distance - left) < 1e-8);
                const glm::dvec3 between = hit.impact.on_b - hit.impact.on_a;
                CHECK(std::abs(glm::length(between) - hit.impact.distance) < 1e-9);
            }
        }
    }

    TEST_CASE("a wall on the floor is hit by what slides along, where it stands, and a step is if it is no rounding") {
        RandomShapes random(9300);
        const Sliders sliders(random);
        for (int round = 0; round < 300; ++round) {
            const RigidTransform frame = any_frame(random, random.index(3));
            const glm::dvec3 face = frame.rotation * glm::dvec3(-1, 0, 0);
            // Boxes side by side, a floor and a wall of them whose face is x = 2.
            std::vector<CompoundChild> parts;
            const Shape tile = Shape::box({0.25f, 0.25f, 0.25f}).value();
            const bool is_step = round % 3 == 0;
            const double step =
                is_step ? std::array{1e-7, 4e-6, 1e-3, 0.1}[static_cast<std::size_t>(round / 3 % 4)] : 0.5;
            for (int x = -2; x <= 5; ++x)
                for (int z = -6; z <= 6; ++z) {
                    const bool high = x >= 4;
                    const double y = !high ? -0.25 : is_step ? -0.25 + step : 0.0;  // a wall goes down into the floor
                    parts.push_back({tile, at({0.5 * x + 0.25, y, 0.5 * z})});
                    for (const double above : {0.5, 1.0})
                        if (high && !is_step) parts.push_back({tile, at({0.5 * x + 0.25, above, 0.5 * z})});
                }
            const Compound compound = Compound::build(parts).value();
            Ground ground(random, 7, frame);
            ground.shape = Shape::compound(compound);
            ground.pose = frame;
            const Shape mover =
                is_step ? sliders.shapes[0] : sliders.shapes[static_cast<std::size_t>(random.index(11))];
            const glm::dmat3 turn = is_step || random.index(2) == 0 ? glm::dmat3(1.0) : random.rotation();
            const double gap = std::array{0.0, 5e-7, -5e-7}[static_cast<std::size_t>(random.index(3))];
            const RigidTransform from =
                placed_in(frame, {turn, {random.number(0.5, 1.0), below(mover, turn) + gap, random.number(-1, 1)}});
            const glm::dvec3 right = glm::transpose(turn) * glm::dvec3(1, 0, 0);
            const double reach = glm::dot(support_point(mover, right), right);
            const double free = 2.0 - reach - glm::dot(frame.rotation[0], from.translation - frame.translation);
            const double velocity_z = random.number(-1, 1);
            const glm::dvec3 velocity(random.number(1.6, 3.0), 0.0, velocity_z);
            const Answer hit = go(ground, mover, from, {frame.rotation * velocity, {}, {}}, random.index(2) == 0);
            CAPTURE(round);
            CAPTURE(step);
            if (is_step && step < 1e-6) {
                CHECK(hit.impact.result == CastResult::miss);
                continue;
            }
            REQUIRE(hit.impact.result == CastResult::hit);
            CHECK(glm::length(glm::cross(hit.normal, face)) < kTenthOfADegree);
            const double left = free - hit.impact.time * velocity.x;
            CHECK(left >= -1e-9);
            CHECK(left <= 1e-6);
        }
    }

    TEST_CASE("over a ridge a shape leaves the ground, in a valley it meets the other slope where that begins") {
        RandomShapes random(9400);
        for (int round = 0; round < 400; ++round) {
            const double slope = random.number(0.05, 1.0) * (round % 2 == 0 ? -1.0 : 1.0);
            const RigidTransform frame = any_frame(random, random.index(3));
            Ground land(random, 7, frame);
            if (round % 4 < 2) {
                land.surface = ground(
                    random, 12, 0.5, [&](double x, double) { return x <= 0.0 ? 0.0 : slope * x; }, 0.0);
                land.shape = land.surface.shape(random.index(2) == 0 ? Sides::both : Sides::front);
                land.pose = frame;
            } else {
                for (std::size_t i = 0; i < land.zeros.size(); ++i)
                    land.zeros[i] = static_cast<float>(slope * std::max(0.0, 0.5 * static_cast<double>(i % 13) - 3.0));
                land.field =
                    HeightField::build({.columns = 13, .rows = 13, .heights = land.zeros, .spacing = {0.5, 0.5}})
                        .value();
                land.shape = Shape::height_field(*land.field);
            }
            const Shape mover = Shape::box({0.2f, 0.25f, 0.3f}).value();
            const double gap = std::array{0.0, 5e-7, -5e-7}[static_cast<std::size_t>(random.index(3))];
            const double x = random.number(-1.0, -0.5);
            const RigidTransform from = placed_in(frame, {glm::dmat3(1.0), {x, 0.25 + gap, random.number(-1, 1)}});
            const double velocity_z = random.number(-0.5, 0.5);
            const glm::dvec3 velocity(random.number(1.0, 2.0), 0.0, velocity_z);
            const Answer hit = go(land, mover, from, {frame.rotation * velocity, {}, {}}, random.index(2) == 0);
            CAPTURE(round);
            CAPTURE(slope);
            if (slope < 0.0) {
                CHECK(hit.impact.result == CastResult::miss);
                continue;
            }
            REQUIRE(hit.impact.result == CastResult::hit);
            const double front = x + static_cast<double>(0.2f) + hit.impact.time * velocity.x;
            CHECK(front <= 1e-9 + std::max(gap, 0.0) / slope);
            CHECK(front >= -3e-6 / slope);
        }
    }
}
