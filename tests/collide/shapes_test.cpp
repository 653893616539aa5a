// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "oracle/edges.hpp"
#include "oracle/exact_boxes.hpp"
#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A parallelogram is a box without thickness; a triangle meets a box iff … here by rational linear programming: no
// plane of the box's and the triangle's half-spaces excludes all vertices of their intersection.
bool oracle_triangle(const Obb& box, const Triangle& t) {
    using namespace oracle;
    // Clip the triangle, a convex polygon in rationals, by the six sides of the box.
    std::vector<Vec3q> polygon;
    for (const glm::dvec3& p : t) polygon.push_back(rational(p));
    for (int k = 0; k < 3; ++k) {
        const Vec3q u = rational(box.axes[k]);
        const Vec3q n = cross(rational(box.axes[(k + 1) % 3]), rational(box.axes[(k + 2) % 3]));
        const Rational projected_radius = abs(dot(u, n)) * Rational(double(box.half_extents[k]));
        const Rational center = dot(n, rational(box.center));
        for (const int sign : {1, -1}) {
            std::vector<Vec3q> kept;
            const auto over = [&](const Vec3q& p) { return Rational(sign * (dot(n, p) - center) - projected_radius); };
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const Vec3q &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
                const Rational at_p = over(p), at_q = over(q);
                if (at_p <= 0) kept.push_back(p);
                if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
                    const Rational s = at_p / (at_p - at_q);
                    kept.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), p[2] + s * (q[2] - p[2])});
                }
            }
            polygon = kept;
            if (polygon.empty()) return false;
        }
    }
    return true;
}

}  // namespace

TEST_SUITE("collide/shapes") {
    TEST_CASE("shapes that are not finite meet nothing") {
        const Obb box = cube_box({});
        CHECK_FALSE(intersects(box, Sphere{{0.0, kNan, 0.0}, 1.0}));
        CHECK_FALSE(intersects(box, Sphere{{}, kNan}));
        CHECK_FALSE(intersects(box, Capsule{{}, {kNan, 0.0, 0.0}, 1.0}));
        CHECK_FALSE(intersects(box, Plane{{kNan, 0.0, 1.0}, 0.0}));
        CHECK_FALSE(intersects(box, Triangle{glm::dvec3(0.0), glm::dvec3(1.0), glm::dvec3(0.0, kNan, 0.0)}));
    }

    TEST_CASE("a half-space is met to the last bit") {
        const Obb box = cube_box({5.0, 0.0, 0.0});
        CHECK(intersects(box, Plane{{1.0, 0.0, 0.0}, -6.0}));
        CHECK_FALSE(intersects(box, Plane{{1.0, 0.0, 0.0}, std::nextafter(-6.0, -7.0)}));
        CHECK(intersects(box, Plane{{-0.5, 0.0, 0.0}, 2.0}));
        std::mt19937_64 random(1);
        for (int trial = 0; trial < 3000; ++trial) {
            const Obb tilted = random_box(random);
            Plane plane{random_vector(random), 0.0};
            plane.offset = -glm::dot(plane.normal, support_point(tilted, plane.normal));
            oracle::Rational value(plane.offset);
            value += oracle::dot(oracle::rational(plane.normal), oracle::rational(tilted.center));
            for (int k = 0; k < 3; ++k)
                value += abs(oracle::dot(oracle::rational(plane.normal), oracle::rational(tilted.axes[k]))) *
                         oracle::Rational(double(tilted.half_extents[k]));
            CHECK(intersects(tilted, plane) == (value >= 0));
        }
    }

    TEST_CASE("triangles against boxes: as rational clipping says, for generic, touching and degenerate ones") {
        std::mt19937_64 random(2);
        int wrong = 0, hits = 0;
        for (int trial = 0; trial < 4000; ++trial) {
            Obb box = random_box(random);
            Triangle t = {2.0 * random_vector(random), 2.0 * random_vector(random), 2.0 * random_vector(random)};
            if (trial % 4 == 1) t[0] = corners(box)[std::size_t(trial / 4 % 8)];  // a corner, up to rounding
            if (trial % 4 == 2) {                                                 // along an edge
                const auto corner = corners(box);
                const glm::dvec3 middle = 0.5 * (corner[0] + corner[1]), away = middle - box.center;
                t = {middle + glm::cross(away, t[0]), middle - glm::cross(away, t[0]), middle + 2.0 * away};
            }
            if (trial % 8 == 3) t[2] = t[1];
            if (trial % 5 == 0) box.half_extents[trial % 3] = 0.0f;
            const bool truth = oracle_triangle(box, t);
            hits += truth;
            wrong += intersects(box, t) != truth || intersects(box, Triangle{t[2], t[0], t[1]}) != truth;
        }
        CHECK(wrong == 0);
        CHECK(hits > 500);
        CHECK(hits < 3500);
    }

    TEST_CASE("long boxes and the triangles that just miss them: as rational clipping says, to the last bit") {
        std::mt19937_64 random(3);
        int compared = 0;
        for (int trial = 0; trial < 400; ++trial) {
            Obb box = random_box(random);
            const int k = trial % 3;
            // Sums along the box's length cancel, but for a rounding that is large beside all else.
            box.half_extents[k] = std::pow(10.0f, float(2 + trial % 6));
            const Triangle t = {box.center + random_vector(random), box.center + random_vector(random),
                                box.center + random_vector(random)};
            const glm::dvec3 away = glm::dvec3(box.axes[(k + 1 + trial % 2) % 3]) + 0.3 * random_vector(random);
            const auto moved = [&](double by) {
                return Triangle{t[0] + by * away, t[1] + by * away, t[2] + by * away};
            };
            if (!intersects(box, moved(0.0)) || intersects(box, moved(20.0))) continue;
            const auto [meets, misses] =
                oracle::edge_between(0.0, 20.0, [&](double by) { return intersects(box, moved(by)); });
            for (const double by : {meets, misses}) {
                REQUIRE(intersects(box, moved(by)) == oracle_triangle(box, moved(by)));
                ++compared;
            }
        }
        CHECK(compared > 400);
    }

    TEST_CASE("balls that nearly touch a box: as the distance between the bodies says") {
        std::mt19937_64 random(12);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (int trial = 0; trial < 20000; ++trial) {
            Obb box = random_box(random, trial % 2 ? 1.0 : 1e6);
            if (trial % 3 == 0) box.half_extents[trial % 9 / 3] = 0.0f;
            if (trial % 5 == 0) box.axes[1] *= 1.0f + 3e-5f;  // nearly as far from orthonormal as validate lets pass
            Sphere ball{box.center + 3.0 * random_vector(random), 0.0};
            const double away =
                contains(box, ball.center) ? 0.0 : distance(box, Capsule{ball.center, ball.center, 0.0}).distance;
            const double gap = std::pow(10.0, -12.0 * unit(random)) * (1.0 + away);
            if (gap < 1e-9 * glm::length(box.center)) continue;
            ball.radius = away + gap;
            CHECK(intersects(box, ball));
            ball.radius = away - gap;
            if (ball.radius >= 0.0) CHECK_FALSE(intersects(box, ball));
        }
    }

    TEST_CASE("spheres and capsules against a cube, by hand") {
        const Obb box = cube_box({});
        CHECK(intersects(box, Sphere{{2.0, 0.0, 0.0}, 1.0}));
        CHECK_FALSE(intersects(box, Sphere{{2.0, 0.0, 0.0}, 1.0 - 1e-9}));
        CHECK_FALSE(intersects(box, Sphere{{2.0, 2.0, 2.0}, std::sqrt(3.0) - 1e-9}));
        CHECK(intersects(box, Sphere{{2.0, 2.0, 2.0}, std::sqrt(3.0) + 1e-9}));
        CHECK(intersects(box, Sphere{{0.1, 0.2, 0.3}, 0.0}));
        CHECK(intersects(box, Capsule{{-5.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, 0.0}));
        CHECK(intersects(box, Capsule{{-5.0, 1.5, 0.0}, {5.0, 1.5, 0.0}, 0.5}));
        CHECK_FALSE(intersects(box, Capsule{{-5.0, 1.5, 0.0}, {5.0, 1.5, 0.0}, 0.499999}));
        CHECK_FALSE(intersects(box, Capsule{{-5.0, 3.5, 0.0}, {0.0, 0.0, 9.0}, 0.5}));
    }
}
