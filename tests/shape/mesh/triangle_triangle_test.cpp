// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "oracle/exact_triangles.hpp"
#include "shape/collide/random_boxes.hpp"

using namespace crofton;
using namespace crofton::mesh;
using namespace crofton::testing;

namespace {

bool agree(const Triangle& a, const Triangle& b, int& hits) {
    const bool truth = oracle::triangles_meet(a, b);
    hits += truth;
    return intersects(a, b) == truth && intersects(b, a) == truth &&
           intersects({a[1], a[2], a[0]}, {b[2], b[1], b[0]}) == truth;
}

// Few distinct coordinates: coplanar, collinear and coincident points abound.
glm::dvec3 lattice_point(std::mt19937_64& random, int size, bool flat) {
    const auto number = [&] { return double(int(random() % unsigned(size))); };
    return {number(), number(), flat ? 1.0 : number()};
}

}  // namespace

TEST_SUITE("mesh/triangle_triangle") {
    TEST_CASE("a triangle that is not finite meets nothing, wherever the NaN sits") {
        const Triangle good = {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
        CHECK(intersects(good, good));
        for (std::size_t k = 0; k < 9; ++k)
            for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
                Triangle bad = good;
                bad[k / 3][int(k % 3)] = value;
                CHECK_FALSE(intersects(good, bad));
                CHECK_FALSE(intersects(bad, good));
            }
    }

    TEST_CASE("lattice triangles in space, in a plane, as segments and as points: as the oracle says") {
        std::mt19937_64 random(1);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 1500; ++trial) {
            const int size = 2 + trial % 4;
            const bool flat = trial % 3 == 0;
            Triangle a, b;
            for (std::size_t k = 0; k < 3; ++k) {
                a[k] = lattice_point(random, size, flat);
                b[k] = lattice_point(random, size, flat);
            }
            if (trial % 5 == 0) a[2] = a[0];
            if (trial % 7 == 0) b[2] = 0.5 * (b[0] + b[1]);
            if (trial % 11 == 0) a[1] = a[2] = a[0];
            wrong += !agree(a, b, hits);
        }
        CHECK(wrong == 0);
        CHECK(hits > 400);
        CHECK(hits < 1300);
    }

    TEST_CASE("triangles that touch up to rounding: as the oracle says") {
        std::mt19937_64 random(2);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 1000; ++trial) {
            Triangle a, b;
            for (std::size_t k = 0; k < 3; ++k) a[k] = random_vector(random), b[k] = random_vector(random);
            const double u = unit(random), v = unit(random) * (1.0 - u);
            const glm::dvec3 inside = a[0] + u * (a[1] - a[0]) + v * (a[2] - a[0]);
            if (trial % 3 == 0) b[0] = inside;                                   // vertex on face
            if (trial % 3 == 1) b[0] = 2.0 * (a[0] + u * (a[1] - a[0])) - b[1];  // edge on edge
            if (trial % 3 == 2)
                b = {inside, inside + v * (a[1] - a[0]), inside - u * (a[2] - a[1])};  // nearly coplanar
            wrong += !agree(a, b, hits);
        }
        CHECK(wrong == 0);
        CHECK(hits > 300);
        CHECK(hits < 980);
    }

    TEST_CASE("generic triangles: as the oracle says, with the ends of the common segment in both planes") {
        std::mt19937_64 random(3);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 1000; ++trial) {
            Triangle a, b;
            for (std::size_t k = 0; k < 3; ++k) a[k] = random_vector(random), b[k] = random_vector(random);
            wrong += !agree(a, b, hits);
            if (!intersects(a, b)) continue;
            const SegmentOfContact segment = contact_segment(a, b);
            for (const glm::dvec3& end : {segment.begin, segment.end})
                for (const Triangle* t : {&a, &b}) {
                    const glm::dvec3 n = glm::normalize(glm::cross((*t)[1] - (*t)[0], (*t)[2] - (*t)[0]));
                    CHECK(std::abs(glm::dot(n, end - (*t)[0])) < 1e-10);
                }
        }
        CHECK(wrong == 0);
        CHECK(hits > 100);
    }

    TEST_CASE("crossing and coplanar triangles of known intersection") {
        const Triangle a = {glm::dvec3(0, 0, 0), glm::dvec3(4, 0, 0), glm::dvec3(0, 4, 0)};
        const SegmentOfContact crossing =
            contact_segment(a, {glm::dvec3(1, 1, -1), glm::dvec3(1, 1, 1), glm::dvec3(1, 9, 0)});
        CHECK(glm::distance(crossing.begin, crossing.end) == doctest::Approx(2.0));  // from (1,1,0) to (1,3,0)
        const SegmentOfContact inner =
            contact_segment(a, {glm::dvec3(1, 1, 0), glm::dvec3(2, 1, 0), glm::dvec3(1, 2, 0)});
        CHECK(glm::distance(inner.begin, inner.end) == doctest::Approx(std::sqrt(2.0)));
        // An edge that runs in the other's plane, from before it to behind it, wherever that is.
        for (const glm::dvec3& place :
             {glm::dvec3(0), glm::dvec3(10, 0, 0), glm::dvec3(-7, 5, 3), glm::dvec3(1, -9, -4)}) {
            Triangle floor,
                wall = {place + glm::dvec3(-1, 1, 0), place + glm::dvec3(9, 1, 0), place + glm::dvec3(2, 1, 5)};
            for (std::size_t k = 0; k < 3; ++k) floor[k] = place + a[k];
            for (int turn = 0; turn < 6; ++turn) {
                std::rotate(wall.begin(), wall.begin() + 1, wall.end());
                if (turn == 3) std::swap(wall[0], wall[1]);
                for (const SegmentOfContact& found : {contact_segment(floor, wall), contact_segment(wall, floor)}) {
                    CHECK(glm::distance(0.5 * (found.begin + found.end), place + glm::dvec3(1.5, 1, 0)) <= 1e-12);
                    CHECK(glm::distance(found.begin, found.end) == doctest::Approx(3.0));
                }
            }
        }
    }

    TEST_CASE("contact segments lie on both triangles: nearly coplanar, touching with a corner, slivers, segments") {
        std::mt19937_64 random(71);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        const auto vector = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
        int met[4] = {};
        for (int trial = 0; trial < 8000; ++trial) {
            const int kind = trial % 4;
            Triangle a, b;
            if (kind == 1) {
                // A corner of b lies on a side of a, a quarter along it, exactly; all in one plane.
                const auto on_grid = [&](double cells) { return glm::round(vector() * cells) / cells; };
                const glm::dvec3 p = on_grid(0x1p20), side = 4.0 * on_grid(0x1p18) * glm::dvec3(1.0, 1.0, 0.0);
                const glm::dvec3 out(-side.y, side.x, 0.0), tip = p + 0.25 * side;
                a = {p, p + side, p + 0.5 * side - out};
                b = {tip, tip + out + uniform(random) * 0.3 * side, tip + 1.5 * out + uniform(random) * 0.3 * side};
            } else {
                const glm::dvec3 x = vector(), y = vector();
                for (std::size_t v = 0; v < 3; ++v) {
                    a[v] = x * uniform(random) + y * uniform(random);
                    b[v] = x * uniform(random) + y * uniform(random);
                    if (kind == 2) a[v] = x * uniform(random) + 1e-12 * vector();
                }
                if (kind == 3) b = {0.5 * (a[0] + a[1]), b[1], b[1]};
            }
            if (!intersects(a, b)) continue;
            ++met[kind];
            for (const SegmentOfContact& found : {contact_segment(a, b), contact_segment(b, a)})
                for (const glm::dvec3& p : {found.begin, found.end})
                    for (const Triangle& t : {a, b}) CHECK(glm::distance(p, closest_on_triangle(p, t)) < 1e-9);
        }
        for (const int count : met) CHECK(count > 100);
    }

    TEST_CASE("a triangle that is a point touches a side at that point") {
        const Triangle a = {glm::dvec3(0, 0, 0), glm::dvec3(4, 0, 0), glm::dvec3(0, 4, 0)};
        const glm::dvec3 on_side(1, 0, 0);
        const SegmentOfContact found = contact_segment(a, {on_side, on_side, on_side});
        CHECK(found.begin == on_side);
        CHECK(found.end == on_side);
    }
}
