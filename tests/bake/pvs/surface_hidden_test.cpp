// SPDX-License-Identifier: MIT
// What the scene's own surface hides: sheets, rooms, corners, holes.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <glm/geometric.hpp>
#include <oracle/plain_pvs.hpp>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

using Points = std::vector<glm::dvec3>;

// Triangles 0, 1, 2, 0, 2, 3, … of a polygon, as one object; they face the side from which it is counter-clockwise.
void add_fan(BakeGeometry& geometry, const Points& polygon) {
    const auto first = static_cast<std::uint32_t>(geometry.mesh.positions.size());
    const auto object = static_cast<std::uint32_t>(geometry.boxes.size());
    Aabb box;
    for (const glm::dvec3& p : polygon) {
        geometry.mesh.positions.push_back(glm::vec3(p));
        box.include(p + geometry.origin);
    }
    for (std::uint32_t i = 2; i < polygon.size(); ++i) {
        for (const std::uint32_t v : {0u, i - 1, i}) geometry.mesh.indices.push_back(first + v);
        geometry.object_of.push_back(object);
    }
    geometry.boxes.push_back(obb_of(box));
}

Points turned_over(Points polygon) {
    return {polygon.rbegin(), polygon.rend()};
}

// Polygons between an eye around 0 and an object around (0, 0, 10), relative to an origin.
struct Case {
    std::vector<Points> walls;
    occlude::Sides sides = occlude::Sides::both;
    glm::dvec3 origin{0.0};
    double near_radius = 0.1;
    std::uint32_t halvings = 0;
    int way = 0;  // 0 … 5: all of it turned, so that the object is along z, x, y, −z, −x, −y
};

glm::dvec3 turned(const glm::dvec3& p, int way) {
    const glm::dvec3 q = way < 3 ? p : glm::dvec3(p.x, -p.y, -p.z);
    return way % 3 == 0 ? q : way % 3 == 1 ? glm::dvec3(q.z, q.x, q.y) : glm::dvec3(q.y, q.z, q.x);
}

PairState state_of(const Case& given) {
    BakeGeometry geometry;
    geometry.origin = given.origin;
    add_box(geometry, box_around(given.origin + turned({0.0, 0.0, 10.0}, given.way), glm::dvec3(0.5)));
    // Lines that meet this alone call the cell free.
    add_box(geometry, box_around(given.origin + turned({0.0, 0.0, -3.0}, given.way), glm::dvec3(1.0)));
    for (Points wall : given.walls) {
        for (glm::dvec3& p : wall) p = turned(p, given.way);
        add_fan(geometry, wall);
    }
    const Cells cells = Cells::boxes(std::vector<Aabb>{box_around(given.origin, glm::dvec3(0.5))}).value();
    // Few lines: the question is what is proved.
    Bake bake = Bake::create(geometry, cells, {.epsilon = 0.5, .confidence = 0.5, .sides = given.sides}).value();
    REQUIRE(bake.run().has_value());
    const Pvs pvs =
        Pvs::finish(bake, {}, {.near_radius = given.near_radius, .halvings = given.halvings, .surface_steps = 400})
            .value();
    REQUIRE(pvs.kind(0) != CellKind::unknown);
    REQUIRE(pvs.kind(0) != CellKind::solid);
    return pvs.state(0, 0);
}

// Counter-clockwise as the eye sees it, which looks along +z: x to the left.
Points wall(double x0, double x1, double z0, double z1, double y0 = -2.0, double y1 = 2.0) {
    return {{x0, y0, z0}, {x0, y1, z0}, {x1, y1, z1}, {x1, y0, z1}};
}

}  // namespace

TEST_SUITE("pvs/surface") {
    TEST_CASE("a sheet hides what lies behind it, and two that share an edge hide what neither does alone") {
        CHECK(state_of({.walls = {}}) != PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 2, 5, 5)}}) == PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5)}}) != PairState::hidden);
        CHECK(state_of({.walls = {wall(0, 2, 5, 5)}}) != PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), wall(0, 2, 5, 5)}}) == PairState::hidden);
        // A corner toward the eye, and one away from it.
        CHECK(state_of({.walls = {wall(-2, 0, 6, 4), wall(0, 2, 4, 6)}}) == PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 4, 6), wall(0, 2, 6, 4)}}) == PairState::hidden);
        // Next to each other, but with a slit between them.
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), wall(0.001, 2, 5, 5)}}) != PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), wall(0, 2, 5.001, 5.001)}}) != PairState::hidden);
    }

    TEST_CASE("a window is no wall, wherever it is, a hole that no line of sight passes does not matter") {
        const std::vector<Points> frame = {wall(-3, -0.3, 5, 5), wall(0.3, 3, 5, 5), wall(-0.3, 0.3, 5, 5, -2.0, -0.3),
                                           wall(-0.3, 0.3, 5, 5, 0.3, 2.0)};
        CHECK(state_of({.walls = frame}) != PairState::hidden);
        std::vector<Points> closed = frame;
        closed.push_back(wall(-0.3, 0.3, 5, 5, -0.3, 0.3));
        CHECK(state_of({.walls = closed}) == PairState::hidden);
        closed.back() = {{-0.3, -0.3, 5}, {-0.3, 0.3, 5}, {0.3, 0.3, 5}};  // half of it
        CHECK(state_of({.walls = closed}) != PairState::hidden);
        const std::vector<Points> aside = {wall(-2, 1, 5, 5), wall(1.5, 3, 5, 5)};
        CHECK(state_of({.walls = aside}) == PairState::hidden);
    }

    TEST_CASE("T-junctions on lines along an axis are closed, others are seams") {
        // Two walls above each other meet one of both heights.
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), wall(0, 2, 5, 5, -2, 0.1), wall(0, 2, 5, 5, 0.1, 2)}}) ==
              PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), wall(0, 2, 5, 5, -2, 0.1), wall(0, 2, 5, 5, 0.2, 2)}}) !=
              PairState::hidden);
    }

    TEST_CASE("one-sided sheets hide from their front alone") {
        const auto front = occlude::Sides::front;
        CHECK(state_of({.walls = {wall(-2, 2, 5, 5)}, .sides = front}) == PairState::hidden);
        CHECK(state_of({.walls = {turned_over(wall(-2, 2, 5, 5))}, .sides = front}) != PairState::hidden);
        CHECK(state_of({.walls = {turned_over(wall(-2, 2, 5, 5))}}) == PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 0, 5, 5), turned_over(wall(0, 2, 5, 5))}, .sides = front}) !=
              PairState::hidden);
        // Back to back at one place.
        CHECK(state_of({.walls = {wall(-2, 2, 5, 5), turned_over(wall(-2, 2, 5, 5))}, .sides = front}) ==
              PairState::hidden);
        CHECK(state_of({.walls = {wall(-2, 2, 5, 5), turned_over(wall(-2, 2, 5, 5))}}) == PairState::hidden);
        // A back before a front.
        CHECK(state_of({.walls = {turned_over(wall(-2, 2, 4, 4)), wall(-2, 2, 5, 5)}, .sides = front}) ==
              PairState::hidden);
    }

    TEST_CASE("triangles that meet the cell, are near it, or touch the object prove nothing") {
        for (int way = 0; way < 6; ++way) {
            CHECK(state_of({.walls = {wall(-2, 2, 0.2, 0.2)}, .way = way}) != PairState::hidden);  // through the cell
            CHECK(state_of({.walls = {wall(-2, 2, 0.55, 0.55)}, .way = way}) != PairState::hidden);
            CHECK(state_of({.walls = {wall(-2, 2, 0.55, 0.55)}, .near_radius = 0.01, .way = way}) == PairState::hidden);
            CHECK(state_of({.walls = {wall(-2, 2, 9.5, 9.5)}, .way = way}) !=
                  PairState::hidden);  // on a face of the object
            CHECK(state_of({.walls = {wall(-2, 2, 10.2, 10.2)}, .way = way}) != PairState::hidden);
            CHECK(state_of({.walls = {wall(-2, 2, 9.4, 9.4)}, .way = way}) == PairState::hidden);
            CHECK(state_of({.walls = {wall(-2, 2, 11, 11)}, .way = way}) != PairState::hidden);
        }
    }

    TEST_CASE("triangles without an area, doubled and crossing ones do no harm") {
        std::vector<Points> walls = {
            wall(-2, 2, 5, 5), {{-1, 0, 5}, {0, 0, 5}, {1, 0, 5}}, {{0, 0, 5}, {0, 0, 5}, {1, 1, 5}}};
        CHECK(state_of({.walls = walls}) == PairState::hidden);
        walls.push_back(wall(-2, 2, 5, 5));
        walls.push_back({{0, -3, 3}, {0.1, 3, 3}, {0.1, 3, 7}, {0, -3, 7}});  // across the wall
        CHECK(state_of({.walls = walls}) == PairState::hidden);
        walls = {
            wall(-2, 0, 5, 5), wall(0, 2, 5, 5), {{0, -2, 5}, {0, 2, 5}, {0, 2, 8}, {0, -2, 8}}};  // three at an edge
        CHECK(state_of({.walls = walls}) == PairState::hidden);
        walls.erase(walls.begin());
        CHECK(state_of({.walls = walls}) != PairState::hidden);
    }

    TEST_CASE("a triangle that two walls hide together, one half each, is proved by halving its longest side") {
        // As the eye sees it, the walls are a roof along the two upper sides. The corners of its box stick out.
        const glm::dvec3 corner[3] = {{-2, 0, 10}, {2, 0, 10}, {0, 1, 10}};
        const auto wall_under = [](double side) {
            const double s = 1.0 / std::sqrt(5.0);
            const glm::dvec3 along(side * 2.0 * s, s, 0.0), up(-side * s, 2.0 * s, 0.0);
            // From before the lower corner, halfway, to beyond the top; 0.1 above the side and 2 deep.
            Obb wall;
            wall.center = glm::dvec3(-side, 0.0, 5.0) + 0.46 * along - 0.95 * up;
            wall.axes = glm::mat3(glm::vec3(along), glm::vec3(up), {0.f, 0.f, static_cast<float>(side)});
            wall.half_extents = {0.76f, 1.05f, 0.2f};
            return wall;
        };
        const auto state = [&](std::size_t first, std::size_t walls, const ProofOptions& options) {
            BakeGeometry geometry;
            add_fan(geometry, {corner[first], corner[(first + 1) % 3], corner[(first + 2) % 3]});
            add_box(geometry, box_around({0.0, 0.0, -3.0}, glm::dvec3(1.0)));  // calls the cell free
            std::vector<occlude::FoundOccluder> found;
            for (std::size_t i = 0; i < walls; ++i) {
                found.emplace_back().box = wall_under(i == 0 ? 1.0 : -1.0);
                found.back().piece_bounds = aabb_of(found.back().box);
                add_box(geometry, found.back().box);
            }
            std::vector<PlacedOccluder> placed;
            for (const auto& occluder : found) placed.push_back({&occluder, {}});
            const Aabb cell = box_around({}, glm::dvec3(0.05));
            Bake bake = Bake::create(geometry, Cells::boxes(std::vector<Aabb>{cell}).value(),
                                     {.epsilon = 0.5, .confidence = 0.5})
                            .value();
            REQUIRE(bake.run().has_value());
            const Pvs pvs = Pvs::finish(bake, placed, options).value();
            REQUIRE(pvs.kind(0) != CellKind::unknown);
            REQUIRE(pvs.kind(0) != CellKind::solid);
            if (pvs.state(0, 0) == PairState::hidden) {
                sampling::Random random(first);
                for (int n = 0; n < 300; ++n) {
                    const glm::dvec3 p = sampling::box_point(cell, random.point<3>());
                    double u = random.uniform(), v = random.uniform();
                    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
                    const glm::dvec3 q = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
                    const auto hits = oracle::crossings(geometry, {p, q - p});
                    const bool met = std::any_of(hits.begin(), hits.end(),
                                                 [](const auto& hit) { return hit.t > 0.0 && hit.t < 0.9; });
                    CHECK(met);
                }
            }
            return pvs.state(0, 0);
        };
        // Whichever side comes first.
        for (const std::size_t first : {0u, 1u, 2u}) {
            CHECK(state(first, 2, {.near_radius = 0.1, .halvings = 1, .surface_steps = 400}) == PairState::hidden);
            CHECK(state(first, 2, {.near_radius = 0.1, .halvings = 4, .surface_steps = 400}) == PairState::hidden);
            // No wall hides it alone. Of its box more is seen.
            CHECK(state(first, 2, {.near_radius = 0.1, .halvings = 0, .surface_steps = 400}) != PairState::hidden);
            CHECK(state(first, 1, {.near_radius = 0.1, .halvings = 4, .surface_steps = 400}) != PairState::hidden);
            CHECK(state(first, 2, {.near_radius = 0.1, .halvings = 4}) != PairState::hidden);
        }
    }

    TEST_CASE("far from the world's origin too") {
        for (const double far : {1e4, 1e7}) {
            const glm::dvec3 origin = far * glm::dvec3(1.0, -0.75, 0.25);
            CHECK(state_of({.walls = {wall(-2, 0, 6, 4), wall(0, 2, 4, 6)}, .origin = origin}) == PairState::hidden);
            CHECK(state_of({.walls = {wall(-2, 0, 6, 4), wall(0.001, 2, 4, 6)}, .origin = origin}) !=
                  PairState::hidden);
        }
    }

    TEST_CASE("no segment of a hidden pair reaches the object: random mazes, either sides, any offset") {
        std::uint64_t hidden = 0, wrong = 0;
        for (const double far : {0.0, 1e7})
            for (const auto sides : {occlude::Sides::both, occlude::Sides::front})
                for (std::uint64_t seed = 1; seed <= 3; ++seed) {
                    sampling::Random random(seed);
                    BakeGeometry geometry;
                    geometry.origin = far * glm::dvec3(1.0, -0.75, 0.25);
                    // Walls of a lattice with moved corners: some are left out, some have a window, some are turned.
                    constexpr int kSide = 5;
                    const auto corner = [&](int i, int j) {
                        sampling::Random at(100 * seed + 10 * static_cast<std::uint64_t>(i),
                                            static_cast<std::uint64_t>(j));
                        return glm::dvec3(4.0 * i + at.uniform(-1.0, 1.0), 0.0, 4.0 * j + at.uniform(-1.0, 1.0));
                    };
                    const auto add_wall = [&](const glm::dvec3& a, const glm::dvec3& b) {
                        const glm::dvec3 up(0.0, 3.0, 0.0);
                        const double kind = random.uniform();
                        if (kind < 0.2) return;
                        Points points = {a, b, b + up, a + up};
                        if (kind < 0.3) points[3] = a + 0.3 * up;  // a gap above
                        if (sides == occlude::Sides::front && random.uniform() < 0.5) points = turned_over(points);
                        add_fan(geometry, points);
                        if (sides == occlude::Sides::front && random.uniform() < 0.5)
                            add_fan(geometry, turned_over(points));
                    };
                    for (int i = 0; i <= kSide; ++i)
                        for (int j = 0; j <= kSide; ++j) {
                            if (i < kSide) add_wall(corner(i, j), corner(i + 1, j));
                            if (j < kSide) add_wall(corner(i, j), corner(i, j + 1));
                        }
                    std::vector<Aabb> boxes;
                    for (int i = 0; i < kSide; ++i)
                        for (int j = 0; j < kSide; ++j) {
                            const glm::dvec3 middle(4.0 * i + 2.0, 1.5, 4.0 * j + 2.0);
                            boxes.push_back(box_around(geometry.origin + middle, {0.7, 0.6, 0.7}));
                            add_box(geometry,
                                    box_around(geometry.origin + middle - glm::dvec3(0.0, 0.8, 0.0), glm::dvec3(0.3)));
                        }
                    // Every other maze has convex cells.
                    std::vector<ConvexCell> convex;
                    for (const Aabb& box : boxes) convex.push_back(random_cell(random, box.center(), 0.9));
                    const Cells cells = seed % 2 ? Cells::boxes(boxes).value() : Cells::convex(convex).value();
                    Bake bake =
                        Bake::create(geometry, cells, {.epsilon = 2e-2, .confidence = 0.9, .sides = sides}).value();
                    REQUIRE(bake.run().has_value());
                    const Pvs pvs =
                        Pvs::finish(bake, {},
                                    {.near_radius = 0.05, .halvings = seed == 1 ? 0u : 3u, .surface_steps = 400})
                            .value();
                    for (std::size_t c = 0; c < cells.size(); ++c)
                        for (std::size_t t = 0; t < geometry.object_of.size(); ++t) {
                            const std::uint32_t object = geometry.object_of[t];
                            if (pvs.kind(c) == CellKind::solid || pvs.state(c, object) != PairState::hidden) continue;
                            ++hidden;
                            for (int n = 0; n < 6; ++n) {
                                const glm::dvec3 p =
                                    (cells.is_convex() ? point_in(convex[c], random)
                                                       : sampling::box_point(cells.box(c), random.point<3>())) -
                                    geometry.origin;
                                double u = random.uniform(), v = random.uniform();
                                if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
                                glm::dvec3 q[3];
                                for (std::size_t k = 0; k < 3; ++k)
                                    q[k] = glm::dvec3(geometry.mesh.positions[geometry.mesh.indices[3 * t + k]]);
                                const glm::dvec3 target = q[0] + u * (q[1] - q[0]) + v * (q[2] - q[0]);
                                bool met = false;
                                for (const auto& hit : oracle::crossings(geometry, {p, target - p}))
                                    met = met || (hit.t > 0.0 && hit.t < 1.0 - 1e-6 &&
                                                  (sides == occlude::Sides::both || hit.front));
                                wrong += !met;
                            }
                        }
                }
        CHECK(hidden > 2000);
        CHECK(wrong == 0);
        MESSAGE(hidden << " triangles of hidden pairs");
    }
}
