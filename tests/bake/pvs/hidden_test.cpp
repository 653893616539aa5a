// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/occlude/occluder.hpp>
#include <crofton/pvs/pvs.hpp>
#include <crofton/sampling/sampling.hpp>
#include <error_of.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <oracle/plain_pvs.hpp>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

// By how much the half extents of a box may shrink until a segment misses it; below 0 where it does at once. Halving,
// as plain as can be.
double depth_in(const Obb& box, const glm::dvec3& p, const glm::dvec3& q) {
    const glm::dmat3 to_box = glm::inverse(glm::dmat3(box.axes));
    const Line line{to_box * (p - box.center), to_box * (q - p)};
    const auto meets = [&](double s) {
        const glm::dvec3 half = glm::dvec3(box.half_extents) - glm::dvec3(s);
        double begin, end;
        return half.x > 0.0 && half.y > 0.0 && half.z > 0.0 && oracle::span_in({-half, half}, line, begin, end) &&
               begin <= 1.0 && end >= 0.0;
    };
    if (!meets(0.0)) return -1.0;
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (meets(middle) ? low : high) = middle;
    }
    return low;
}

struct Walls {
    BakeGeometry geometry;   // the objects, then the walls
    std::vector<Obb> boxes;  // of the walls
    std::vector<occlude::FoundOccluder> found;
    std::vector<PlacedOccluder> placed;
};

// Turned boxes as occluders, and small objects all around.
Walls random_walls(std::uint64_t seed, int walls, int objects, const glm::dvec3& origin) {
    sampling::Random random(seed);
    Walls result;
    result.geometry.origin = origin;
    const auto place = [&] {
        const auto at = random.point<3>();
        return origin + glm::dvec3(24.0 * at[0] - 12.0, 4.0 * at[1], 24.0 * at[2] - 12.0);
    };
    for (int i = 0; i < objects; ++i) {
        const glm::dvec3 at = place();
        add_box(result.geometry, box_around(at, glm::dvec3(0.1 + random.uniform())));
    }
    for (int i = 0; i < walls; ++i) {
        const auto size = random.point<3>();
        Obb box;
        box.axes = glm::mat3(sampling::rotation(random.point<3>()));
        box.half_extents = glm::vec3(1.0 + 3.0 * size[0], 1.0 + 3.0 * size[1], 0.2 + size[2]);
        occlude::FoundOccluder found;
        found.box = box;
        found.piece_bounds = aabb_of(box);
        result.found.push_back(found);
        box.center = place();
        result.boxes.push_back(box);
        add_box(result.geometry, box);
    }
    for (std::size_t i = 0; i < result.boxes.size(); ++i)
        result.placed.push_back({&result.found[i], {glm::dmat3(1.0), result.boxes[i].center}});
    return result;
}

Pvs finished(const Walls& walls, const Cells& cells, const ProofOptions& options) {
    Bake bake = Bake::create(walls.geometry, cells, {.epsilon = 5e-3, .confidence = 0.9}).value();
    REQUIRE(bake.run().has_value());
    return Pvs::finish(bake, walls.placed, options).value();
}

// How deep the least deep segment from the cell's corners to the object's box passes through the body.
double least_depth(const Obb& body, const Aabb& cell, const Obb& object) {
    double least = HUGE_VAL;
    for (const glm::dvec3& q : corners(object))
        for (const glm::dvec3& p : corners(obb_of(cell))) {
            least = std::min(least, depth_in(body, p, q));
            if (least < 0.0) return least;
        }
    return least;
}

bool is_near(const Obb& body, const Aabb& cell, double distance) {
    const Aabb bounds = aabb_of(body);
    return intersects(Aabb{bounds.min - distance, bounds.max + distance}, cell);
}

glm::dvec3 point_in(const Obb& box, sampling::Random& random) {
    glm::dvec3 point = box.center;
    for (int k = 0; k < 3; ++k)
        point += random.uniform(-1.0, 1.0) * static_cast<double>(box.half_extents[k]) * glm::dvec3(box.axes[k]);
    return point;
}

}  // namespace

TEST_SUITE("pvs/hidden") {
    TEST_CASE("proofs that are stopped keep what was proved by then, and all else stays unseen") {
        const Walls walls = random_walls(9, 14, 60, glm::dvec3(0.0));
        const Cells cells = Cells::grid({{-12, 0, -12}, {12, 3, 12}}, {12, 2, 12}).value();
        ProofOptions options{.near_radius = 0.1, .halvings = 8, .surface_steps = 400};
        const Pvs all = finished(walls, cells, options);
        struct Patience {
            int left;
            double last_share = 0.0;
            bool is_sane = true;
        };
        std::uint64_t partly = 0;
        for (const int patience : {0, 1, 2, 5, 20, 1'000'000}) {
            CAPTURE(patience);
            Patience user{patience};
            options.user = &user;
            options.should_stop = [](void* who, double share) {
                Patience& it = *static_cast<Patience*>(who);
                it.is_sane = it.is_sane && share >= it.last_share && share <= 1.0;
                it.last_share = share;
                return it.left-- <= 0;
            };
            const Pvs some = finished(walls, cells, options);
            CHECK(user.is_sane);
            for (std::size_t c = 0; c < cells.size(); ++c)
                for (std::uint32_t o = 0; o < some.object_count(); ++o) {
                    const PairState state = some.state(c, o), whole = all.state(c, o);
                    CHECK((state == whole || (state == PairState::unseen && whole == PairState::hidden)));
                }
            if (patience == 0) CHECK(some.counts().hidden == 0);
            if (patience == 1'000'000) CHECK(some.counts().hidden == all.counts().hidden);
            partly += some.counts().hidden > 0 && some.counts().hidden < all.counts().hidden;
        }
        MESSAGE("stopped on the way: " << partly);
    }

    TEST_CASE("every segment of a hidden pair meets a body, and what one body hides is proved, at any offset") {
        std::uint64_t hidden = 0, by_one = 0, by_halves = 0;
        for (const double offset : {0.0, 1e4, 1e7})
            for (std::uint64_t seed = 1; seed <= 4; ++seed) {
                const glm::dvec3 o = offset * glm::dvec3(1.0, -0.75, 0.25);
                const Walls walls = random_walls(seed, 14, 40, o);
                const Aabb bounds{o + glm::dvec3(-12.0, 0.0, -12.0), o + glm::dvec3(12.0, 3.0, 12.0)};
                const Cells cells = Cells::grid(bounds, {6, 2, 6}).value();
                const Pvs pvs = finished(walls, cells, {.near_radius = 0.1, .halvings = seed % 2 ? 0u : 4u});
                sampling::Random random(seed);
                for (std::size_t c = 0; c < cells.size(); ++c)
                    for (std::uint32_t i = 0; i < 40 && pvs.kind(c) == CellKind::open; ++i) {
                        const Obb& object = walls.geometry.boxes[i];
                        double depth = -1.0;
                        for (const Obb& body : walls.boxes)
                            if (!is_near(body, cells.box(c), 0.1001))
                                depth = std::max(depth, least_depth(body, cells.box(c), object));
                        if (depth > 1e-4) {
                            ++by_one;
                            CHECK(pvs.state(c, i) == PairState::hidden);
                        }
                        if (pvs.state(c, i) != PairState::hidden) continue;
                        ++hidden;
                        by_halves += depth < 0.0;
                        for (int n = 0; n < 40; ++n) {
                            const glm::dvec3 p = sampling::box_point(cells.box(c), random.point<3>());
                            const glm::dvec3 q = point_in(object, random);
                            bool met = false;
                            for (const Obb& body : walls.boxes)
                                met = met || (!is_near(body, cells.box(c), 0.0999) && depth_in(body, p, q) >= 0.0);
                            CHECK(met);
                        }
                    }
            }
        CHECK(by_one > 500);
        CHECK(by_halves > 50);
        MESSAGE(hidden << " hidden, " << by_one << " by one body, " << by_halves << " by halves");
    }

    TEST_CASE("every segment of a hidden pair of a convex cell meets a body, and more is proved than with boxes") {
        std::uint64_t hidden = 0, hidden_of_boxes = 0;
        for (const double offset : {0.0, 1e7})
            for (std::uint64_t seed = 1; seed <= 2; ++seed) {
                const glm::dvec3 o = offset * glm::dvec3(1.0, -0.75, 0.25);
                const Walls walls = random_walls(seed, 14, 40, o);
                sampling::Random random(seed);
                std::vector<ConvexCell> convex;
                std::vector<Aabb> boxes;
                for (int i = 0; i < 40; ++i) {
                    const double x = random.uniform(-11.0, 11.0), z = random.uniform(-11.0, 11.0);
                    convex.push_back(random_cell(random, o + glm::dvec3(x, 1.5, z), 1.5));
                    boxes.emplace_back();
                    for (const glm::dvec3& p : convex.back().corners) boxes.back().include(p);
                }
                const Cells cells = Cells::convex(convex).value();
                const ProofOptions options{.near_radius = 0.1, .halvings = seed % 2 ? 0u : 4u};
                const Pvs pvs = finished(walls, cells, options);
                hidden_of_boxes += finished(walls, Cells::boxes(boxes).value(), options).counts().hidden;
                for (std::size_t c = 0; c < cells.size(); ++c)
                    for (std::uint32_t i = 0; i < 40 && pvs.kind(c) == CellKind::open; ++i) {
                        if (pvs.state(c, i) != PairState::hidden) continue;
                        ++hidden;
                        for (int n = 0; n < 40; ++n) {
                            const glm::dvec3 p = point_in(convex[c], random),
                                             q = point_in(walls.geometry.boxes[i], random);
                            bool met = false;
                            for (const Obb& body : walls.boxes)
                                met = met || (!is_near(body, cells.box(c), 0.0999) && depth_in(body, p, q) >= 0.0);
                            CHECK(met);
                        }
                    }
            }
        CHECK(hidden > 400);
        CHECK(hidden > hidden_of_boxes);
        MESSAGE(hidden << " hidden, of the boxes around the cells " << hidden_of_boxes);
    }

    TEST_CASE("a body proves nothing for eyes near it, behind its open side, or where it is a patch or flat") {
        BakeGeometry geometry;
        add_box(geometry, box_around({0.0, 0.0, 10.0}, glm::dvec3(0.5)));
        add_box(geometry, {{-8.0, -8.0, 4.0}, {8.0, 8.0, 5.0}});
        const Cells cells = Cells::boxes(std::vector<Aabb>{box_around({}, glm::dvec3(1.0))}).value();
        Bake bake = Bake::create(geometry, cells, {.epsilon = 1e-3, .confidence = 0.9}).value();
        REQUIRE(bake.run().has_value());
        occlude::FoundOccluder wall;
        wall.box = geometry.boxes[1];
        wall.piece_bounds = aabb_of(wall.box);
        const auto state = [&](const occlude::FoundOccluder& found, const glm::dmat3& linear, double near_radius) {
            const std::vector<PlacedOccluder> placed = {{&found, {linear, glm::dvec3(0.0)}}};
            return Pvs::finish(bake, placed, {.near_radius = near_radius}).value().state(0, 0);
        };
        CHECK(state(wall, glm::dmat3(1.0), 0.5) == PairState::hidden);
        CHECK(state(wall, glm::dmat3(1.0), 2.9) == PairState::hidden);
        CHECK(state(wall, glm::dmat3(1.0), 3.1) == PairState::unseen);
        glm::dmat3 flat(1.0);
        flat[0][0] = 0.0;
        CHECK(state(wall, flat, 0.5) == PairState::unseen);
        CHECK(state(wall, glm::dmat3(std::numeric_limits<double>::quiet_NaN()), 0.5) == PairState::unseen);
        occlude::FoundOccluder other = wall;
        other.kind = occlude::OccluderKind::patch;
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::unseen);
        other = wall;
        other.eyes_within.min.z = 0.5;  // the cell reaches beyond
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::unseen);
        other.eyes_within.min.z = -1.5;
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::hidden);
        other.box.half_extents.x = 0.5f;  // too narrow for the whole cell
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::unseen);

        other = wall;
        other.kind = occlude::OccluderKind::convex;
        other.surface.positions = {{-8.f, -8.f, 4.f}, {8.f, -8.f, 4.f}, {0.f, 9.f, 4.f}, {0.f, 0.f, 6.f}};
        other.surface.indices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::hidden);
        other.surface.indices[0] = 4;
        CHECK(state(other, glm::dmat3(1.0), 0.5) == PairState::unseen);

        const std::vector<PlacedOccluder> none = {{nullptr, {}}};
        CHECK(Pvs::finish(bake, none).value().state(0, 0) == PairState::unseen);
        CHECK(error_of(Pvs::finish(bake, {}, {.near_radius = -1.0})).code == ErrorCode::invalid_argument);
        CHECK(error_of(Pvs::finish(bake, {}, {.halvings = 99})).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("proofs are the same bits on three threads") {
        const Walls walls = random_walls(9, 20, 60, glm::dvec3(0.0));
        const Cells cells = Cells::grid({{-12.0, 0.0, -12.0}, {12.0, 3.0, 12.0}}, {12, 2, 12}).value();
        Bake bake = Bake::create(walls.geometry, cells, {.epsilon = 1e-2, .confidence = 0.9}).value();
        REQUIRE(bake.run().has_value());
        ThreadPool pool(3);
        CHECK(plain(Pvs::finish(bake, walls.placed, {}, pool).value().to_file().value()) ==
              plain(Pvs::finish(bake, walls.placed).value().to_file().value()));
    }

    TEST_CASE("a body that its transform has flattened proves nothing, however it was turned") {
        // An object in front of the flattened body, and eyes on both sides of it: those in front see the object.
        BakeGeometry geometry;
        add_box(geometry, box_around({0.0, 0.0, 5.0}, glm::dvec3(1e-4)));
        const Cells cells = Cells::grid({{-1.0, -1.0, -2.0}, {1.0, 1.0, 1.0}}, {1, 1, 1}).value();
        Bake bake = Bake::create(geometry, cells, {.epsilon = 0.5}).value();
        REQUIRE(bake.run({.lines = 1}).has_value());
        REQUIRE_FALSE(bake.is_seen(0, 0));
        occlude::FoundOccluder cube;
        cube.box.half_extents = glm::vec3(1.0f);
        occlude::FoundOccluder convex;
        convex.kind = occlude::OccluderKind::convex;
        for (const glm::dvec3& p : corners(cube.box)) convex.surface.positions.emplace_back(p);
        convex.surface.indices = convex_hull(convex.surface.positions)->triangles;
        sampling::Random random(3);
        for (int i = 0; i < 400; ++i) {
            const glm::dmat3 flat = i == 0
                                        ? glm::dmat3(1, 0, 0, 0, 1, 0, -1, -1, 0)
                                        : glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 0) * sampling::rotation(random.point<3>());
            for (const auto* occluder : {&cube, &convex}) {
                const PlacedOccluder placed{occluder, {flat, {}}};
                const Pvs sets = Pvs::finish(bake, {&placed, 1}).value();
                REQUIRE(sets.find_cell({}) == 0);
                CHECK(sets.state(0, 0) == PairState::unseen);
            }
        }
    }
}
