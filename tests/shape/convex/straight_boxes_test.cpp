// SPDX-License-Identifier: MIT
// Two boxes that are not turned, exactly touching or nearly: they take a shorter way to the same answers.
#include <doctest/doctest.h>
#include <gmpxx.h>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <limits>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct StraightPair {
    Shape a, b;
    glm::dvec3 at_a, at_b;
};

// Along each axis: apart or overlapping by any amount, flush on one side, or touching within three bits.
StraightPair random_pair(RandomShapes& random, double offset) {
    const auto side = [&] {
        const int kind = random.index(3);
        return kind == 0 ? 0.5f : static_cast<float>(kind == 1 ? random.number(0.1, 2.0) : random.number(1e-3, 20.0));
    };
    const float ax = side(), ay = side(), az = side(), bx = side(), by = side(), bz = side();
    const glm::vec3 a(ax, ay, az), b = random.index(2) == 0 ? a : glm::vec3(bx, by, bz);
    StraightPair pair{Shape::box(a).value(), Shape::box(b).value(), {}, {}};
    for (int k = 0; k < 3; ++k) {
        pair.at_a[k] = random.index(2) == 0 ? offset : offset + random.number(-1.0, 1.0);
        const double sum = static_cast<double>(a[k]) + static_cast<double>(b[k]),
                     sign = random.index(2) == 0 ? 1.0 : -1.0;
        const int kind = random.index(6);
        double way = sum;
        if (kind == 0) way = sum * random.number(0.0, 1.05);
        if (kind == 1) way = std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k]));
        if (kind == 2) way = sum - std::pow(10.0, -random.number(2.0, 8.0));
        pair.at_b[k] = pair.at_a[k] + sign * way;
        for (int bits = random.index(7) - 3; kind >= 4 && bits != 0; bits += bits < 0 ? 1 : -1)
            pair.at_b[k] = std::nextafter(pair.at_b[k], bits < 0 ? -HUGE_VAL : HUGE_VAL);
    }
    return pair;
}

bool meet_in_rationals(const StraightPair& pair) {
    for (int k = 0; k < 3; ++k) {
        const mpq_class way = mpq_class(pair.at_b[k]) - mpq_class(pair.at_a[k]),
                        sum = mpq_class(pair.a.half_extents()[k]) + mpq_class(pair.b.half_extents()[k]);
        if (abs(way) > sum) return false;
    }
    return true;
}

// Turned by a quarter about an axis, exactly.
glm::dmat3 quarter_turn(int axis) {
    glm::dmat3 turn(0.0);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    turn[axis][axis] = 1.0;
    turn[u][v] = 1.0;
    turn[v][u] = -1.0;
    return turn;
}

// Numbers within rounding of the size, ids exactly.
void check_same(const Manifold& straight, const Manifold& turned, const glm::dmat3& turn, double size) {
    REQUIRE(straight.count == turned.count);
    if (straight.count == 0) return;
    CHECK(glm::distance(turn * straight.normal, turned.normal) <= 1e-14);
    CHECK(std::abs(straight.depth - turned.depth) <= 1e-15 * size);
    for (int i = 0; i < straight.count; ++i) {
        const ContactPoint &p = straight.points[i], &q = turned.points[i];
        CHECK(glm::distance(turn * p.position, q.position) <= 1e-15 * size);
        CHECK(std::abs(p.depth - q.depth) <= 1e-15 * size);
        CHECK(p.on_a == q.on_a);
        CHECK(p.on_b == q.on_b);
    }
}

}  // namespace

TEST_SUITE("convex/straight_boxes") {
    TEST_CASE("whether boxes that are not turned meet agrees with rationals, within bits of a touch, at any place") {
        RandomShapes random(4911);
        int meeting = 0;
        for (int i = 0; i < 60000; ++i) {
            const double offsets[] = {0.0, 1e3, -1e7};
            const StraightPair pair = random_pair(random, offsets[i % 3]);
            const bool truth = meet_in_rationals(pair);
            const RigidTransform at_a{glm::dmat3(1.0), pair.at_a}, at_b{glm::dmat3(1.0), pair.at_b};
            CHECK(intersects({pair.a, at_a}, {pair.b, at_b}) == truth);
            CHECK(intersects({pair.b, at_b}, {pair.a, at_a}) == truth);
            PairCache cache;
            CHECK((contact_manifold({pair.a, at_a}, {pair.b, at_b}, {}, &cache).count > 0) == truth);
            CHECK((contact_manifold({pair.a, at_a}, {pair.b, at_b}, {}, &cache).count > 0) == truth);
            meeting += truth;
        }
        CHECK(meeting > 10000);
        CHECK(meeting < 50000);
    }

    TEST_CASE("boxes turned together by a quarter have the same contacts, turned, and the same with a cache") {
        RandomShapes random(4912);
        for (int i = 0; i < 30000; ++i) {
            const StraightPair pair = random_pair(random, i % 2 == 0 ? 0.0 : 1e3);
            const glm::dmat3 turn = quarter_turn(i % 3);
            const RigidTransform at_a{glm::dmat3(1.0), pair.at_a}, at_b{glm::dmat3(1.0), pair.at_b},
                turned_a{turn, turn * pair.at_a}, turned_b{turn, turn * pair.at_b};
            const double size = glm::length(pair.at_a) + glm::length(pair.at_b) + 100.0;
            const ManifoldOptions options{.margin = i % 4 == 0 ? 0.0 : 0.02};
            const Manifold straight = contact_manifold({pair.a, at_a}, {pair.b, at_b}, options);
            check_same(straight, contact_manifold({pair.a, turned_a}, {pair.b, turned_b}, options), turn, size);
            PairCache cache;
            for (int call = 0; call < 2; ++call)
                check_same(contact_manifold({pair.a, at_a}, {pair.b, at_b}, options, &cache), straight, glm::dmat3(1.0),
                           size);
        }
    }
}
