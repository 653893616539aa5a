// SPDX-License-Identifier: MIT
// Manifolds of pairs that remember the frame before.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <limits>
#include <set>
#include <vector>

#include "contact_ids.hpp"
#include "counting_memory.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// Of the points, in their order.
double area(const Manifold& m) {
    glm::dvec3 sum(0.0);
    for (int i = 1; i + 1 < m.count; ++i)
        sum += glm::cross(m.points[i].position - m.points[0].position, m.points[i + 1].position - m.points[0].position);
    return 0.5 * glm::length(sum);
}

}  // namespace

TEST_SUITE("convex/warm_manifold") {
    TEST_CASE("a warm call returns what a cold one does, up to ties, and ids stay while a shape slides and rocks") {
        RandomShapes random(2);
        int kept = 0, frames = 0;
        for (int i = 0; i < 60; ++i) {
            const Shape a = Shape::box({2, 0.5f, 2}).value(),
                        b = i % 2 == 0 ? Shape::box({0.5f, 0.5f, 0.5f}).value() : random.hull(32);
            const RigidTransform ground = at({});
            PairCache cache;
            std::set<std::pair<Feature, Feature>> last;
            for (int frame = 0; frame < 60; ++frame) {
                const double t = frame / 60.0;
                RigidTransform pose = at({0.05 * t, 0.0, 0.03 * t});
                pose.rotation = glm::mat3_cast(glm::angleAxis(1e-3 * std::sin(9 * t), glm::dvec3(0.6, 0, 0.8)));
                const glm::dvec3 low = support_point(b, glm::transpose(pose.rotation) * glm::dvec3(0, -1, 0));
                pose.translation.y = 0.5 - (pose.rotation * low).y - 1e-3 - 1e-4 * std::sin(20 * t);
                const ShapeAtPose pa{a, ground}, pb{b, pose};
                const Manifold warm = contact_manifold(pa, pb, {.margin = 0.01}, &cache);
                const Manifold cold = contact_manifold(pa, pb, {.margin = 0.01});
                CHECK(std::abs(warm.depth - cold.depth) <= 1e-4 * (a.core_radius() + b.core_radius() + 1.0));
                CHECK(glm::dot(warm.normal, cold.normal) == doctest::Approx(1.0).epsilon(1e-6));
                if (frame > 0) ++frames, kept += ids(warm) == last;
                last = ids(warm);
            }
        }
        CHECK(kept >= frames * 95 / 100);
    }

    // The face of the frame before tells of a gap, 2e-6 of the size, where other points meet.
    TEST_CASE("round shapes that meet by little have a point, whatever face the frame before had") {
        const std::vector<glm::vec3> points{{7.75f, 0.0859069824f, -11.125f}, {-6.78479385f, 14.875f, 12.375f},
                                            {0.25f, -11.625f, -9.875f},       {12.75f, 5.75f, 0.625f},
                                            {-12.5f, 0.75f, 1.15012884f},     {0.0f, -12.375f, 3.03466797f},
                                            {14.125f, 1.24355674f, 0.0f}};
        const Hull hull = Hull::build(points).value();
        const Shape a = Shape::hull(hull), b = Shape::rounded(Shape::box(glm::vec3(1.5f)).value(), 2.125f).value();
        const RigidTransform pose_a{{{-0.95819209039547992, 0.15819209039548021, -0.23841807909604518},
                                     {-0.072316384180790949, 0.67231638418079109, 0.7367231638418078},
                                     {0.2768361581920904, 0.72316384180790949, -0.63276836158192085}},
                                    {0.94829255342483521, 0.125, -15.125}};
        const RigidTransform pose_b{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                    {-12.753576550384418, -9.2189960879518615, -12.068284181183571}};
        REQUIRE(intersects({a, pose_a}, {b, pose_b}));
        int tried = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0})
                for (int exponent = 0; exponent < 60; ++exponent) {
                    RigidTransform before = pose_b;
                    before.translation[axis] += std::ldexp(sign, -exponent);
                    PairCache cache;
                    tried += contact_manifold({a, pose_a}, {b, before}, {}, &cache).count > 0;
                    CHECK(contact_manifold({a, pose_a}, {b, pose_b}, {}, &cache).count > 0);
                }
        CHECK(tried > 100);
    }

    // Found by fuzzing: a sliver's clipped face was from 2e-5 to 7e-4 deep, and the proof took all of it for the least.
    TEST_CASE("a sliver that slides off a face has no point, whatever face the frame before had") {
        const std::vector<glm::vec3> sliver = {{0, -0x1p-3f, -0x1p-3f},
                                               {-0x1p-3f, -0x1.ff5718p-4f, 0},
                                               {0, -0x1p-3f, -0x1.cp+1f},
                                               {-0x1.ff5718p-4f, -0x1.ff5718p-4f, -0x1.ff5718p-4f}};
        const std::vector<glm::vec3> wedge = {{0x1.48p+3f, -0x1p-3f, -0x1.ff5718p-4f},
                                              {-0x1.ff5718p-4f, -0x1.ff5718p-4f, -0x1.15c5fp-3f},
                                              {0x1.48p+3f, 0x1.48p+3f, 0x1.48p+3f},
                                              {0x1.48p+3f, -0x1.ff5718p-4f, 0x1.6f869ap+2f},
                                              {-0x1.ff5718p-4f, -0x1.ff5718p-4f, 0x1.6aa8e8p+3f},
                                              {-0x1p-3f, -0x1p-3f, 0}};
        const Hull a = Hull::build(sliver).value(), b = Hull::build(wedge).value();
        const ShapeAtPose thin{Shape::hull(a), at({0, -0x1.102a3ap-3, -0x1.ff5718p-4})};
        const Shape wide = Shape::hull(b);
        const RigidTransform touching = at({-0x1.4cp+3, -0x1.0fd5c6p-3, 0}), past = at({-0x1.2cp+3, -0x1.0fd5c6p-3, 0});
        PairCache cache;
        REQUIRE(contact_manifold(thin, {wide, touching}, {}, &cache).count > 0);
        REQUIRE(cache.reference != 0);
        CHECK_FALSE(intersects(thin, {wide, past}));
        CHECK(contact_manifold(thin, {wide, past}, {}, &cache).count == 0);

        // The same from many places nearby.
        RandomShapes random(77);
        int meeting = 0, apart = 0;
        for (int i = 0; i < 20000; ++i) {
            PairCache from = cache;
            RigidTransform near = past;
            near.translation +=
                glm::dvec3(random.number(-1.0, 1.0), random.number(-1e-3, 1e-3), random.number(-1e-3, 1e-3));
            const bool meet = intersects(thin, {wide, near});
            ++(meet ? meeting : apart);
            CHECK((contact_manifold(thin, {wide, near}, {}, &from).count > 0) == meet);
        }
        CHECK(meeting > 5000);
        CHECK(apart > 5000);
    }

    TEST_CASE("a face that is no longer the least deep is given up") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const RigidTransform ground = at({}), top = at({0.5, 1.99, 0.25}), side = at({1.9, 1.5, 0.25});
        PairCache cache;
        CHECK(contact_manifold({box, ground}, {box, top}, {}, &cache).normal.y == doctest::Approx(1.0));
        const Manifold m = contact_manifold({box, ground}, {box, side}, {}, &cache);
        CHECK(m.normal.x == doctest::Approx(1.0));
        CHECK(m.depth == doctest::Approx(0.1));
        RandomShapes random(5);
        for (int i = 0; i < 400; ++i) {
            const Shape a = random.polytope(24), b = random.polytope(24);
            const CasePair where = nearly_touching(random, a, b, -0.01, 0.0);
            RigidTransform next = where.pose_b;
            next.translation += (i % 2 == 0 ? 0.3 : 0.03) * random.direction();
            PairCache kept;
            (void)contact_manifold({a, where.pose_a}, {b, where.pose_b}, {.margin = 0.02}, &kept);
            const Manifold warm = contact_manifold({a, where.pose_a}, {b, next}, {.margin = 0.02}, &kept);
            const Manifold cold = contact_manifold({a, where.pose_a}, {b, next}, {.margin = 0.02});
            const double size =
                a.core_radius() + b.core_radius() + glm::length(next.translation - where.pose_a.translation);
            CHECK((warm.count > 0) == (cold.count > 0));
            CHECK(std::abs(warm.depth - cold.depth) <= 1.5e-4 * size);
        }
    }

    TEST_CASE("warm calls allocate nothing") {
        RandomShapes random(4);
        for (int i = 0; i < 50; ++i) {
            const Shape a = random.hull(32), b = i % 2 == 0 ? random.box() : random.hull(32);
            const CasePair where = nearly_touching(random, a, b, 0.02 * (i % 3 - 1.5), 0.0);
            const ShapeAtPose pa{a, where.pose_a}, pb{b, where.pose_b};
            PairCache cache;
            (void)contact_manifold(pa, pb, {.margin = 0.1}, &cache);
            const CountingMemory memory;
            (void)contact_manifold(pa, pb, {.margin = 0.1}, &cache);
            (void)intersects(pa, pb, &cache);
            (void)distance(pa, pb, &cache);
            (void)cast(pa, {}, pb, {.velocity = -where.normal, .spin = {1, 2, 3}}, {}, &cache);
            CHECK(memory.allocations() == 0);
        }
    }

    // Prisms on eight corners that stand on each other and sway: which corner is the deepest goes round.
    TEST_CASE("if there are more points than wanted, those of the last frame stay while they are as good") {
        std::vector<glm::vec3> corners;
        for (int k = 0; k < 8; ++k)
            for (const float y : {-0.5f, 0.5f}) {
                const float angle = 0.785398f * static_cast<float>(k) + 0.3f;
                corners.emplace_back(std::cos(angle), y, std::sin(angle));
            }
        const Hull hull = Hull::build(corners).value();
        for (glm::vec3& p : corners) p *= glm::vec3(1.3f, 1.0f, 1.3f);
        const Hull wide_hull = Hull::build(corners).value();
        const Shape box = Shape::box({1.5f, 0.5f, 1.5f}).value(), prism = Shape::hull(hull),
                    wide = Shape::hull(wide_hull);
        for (const Shape* below : {&wide, &box}) {
            PairCache cache;
            std::set<std::pair<Feature, Feature>> before;
            int kept = 0, all = 0, eight = 0;
            for (int frame = 0; frame < 2000; ++frame) {
                const double round = 0.02 * frame;
                RigidTransform top = at({1e-4 * std::cos(round), 0.999, 1e-4 * std::sin(round)});
                top.rotation = glm::mat3_cast(
                    glm::angleAxis(2e-5 * std::sin(0.37 * frame), glm::dvec3(std::cos(round), 0, std::sin(round))));
                const RigidTransform low = at({});
                PairCache same = cache;
                const Manifold m = contact_manifold({*below, low}, {prism, top}, {}, &cache),
                               full = contact_manifold({*below, low}, {prism, top}, {.max_points = 8}, &same),
                               fresh = contact_manifold({*below, low}, {prism, top});
                REQUIRE(m.count == 4);
                eight += full.count == 8;
                CHECK(std::abs(m.depth - fresh.depth) <= 2e-4);
                double deepest = -1.0;
                for (int i = 0; i < 4; ++i) {
                    deepest = std::max(deepest, m.points[i].depth);
                    CHECK(ids(full).count({m.points[i].on_a, m.points[i].on_b}) == 1);
                }
                CHECK(deepest >= full.depth - 4e-4);
                CHECK(area(m) >= 0.9 * area(fresh) - 1e-12);
                for (const auto& id : ids(m)) kept += static_cast<int>(before.count(id));
                if (frame > 0) all += 4;
                before = ids(m);
            }
            CHECK(eight > 1500);
            CHECK(kept >= 0.99 * all);
        }
    }

    TEST_CASE("points of the frame before that lie together now make room for others") {
        const Shape box = Shape::box({1, 1, 1}).value();
        PairCache cache;
        for (int frame = 0; frame < 200; ++frame) {
            RigidTransform top = at({0.01 * frame, 1.99, 0.004 * frame});
            top.rotation = glm::mat3_cast(glm::angleAxis(0.785398 + 0.002 * frame, glm::dvec3(0, 1, 0)));
            const RigidTransform low = at({});
            const Manifold m = contact_manifold({box, low}, {box, top}, {}, &cache),
                           fresh = contact_manifold({box, low}, {box, top});
            CHECK(m.count == fresh.count);
            CHECK(m.depth == doctest::Approx(0.01));
            CHECK(area(m) >= 0.9 * area(fresh) - 1e-12);
        }
    }
}
