// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/convex/query.hpp>
#include <error_of.hpp>
#include <limits>
#include <numbers>

#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

Motion flying(const glm::dvec3& velocity, const glm::dvec3& spin = glm::dvec3(0.0)) {
    return {velocity, spin, glm::dvec3(0.0)};
}

}  // namespace

TEST_SUITE("convex/cast") {
    TEST_CASE("bad motions and options are named errors") {
        const Shape box = Shape::box({1, 1, 1}).value(), floor = Shape::half_space({{0, -1, 0}, 0}).value();
        const RigidTransform here = at({}), there = at({5, 5, 5});
        const auto code = [&](const Motion& m, const CastOptions& o) {
            return error_of(cast({box, here}, m, {box, there}, {}, o)).code;
        };
        CHECK(code(flying({NAN, 0, 0}), {}) == ErrorCode::non_finite);
        CHECK(code(flying({}, {1e6, 0, 0}), {}) == ErrorCode::out_of_range);
        CHECK(code({}, {.duration = -1.0}) == ErrorCode::invalid_argument);
        CHECK(code({}, {.tolerance = 0.0}) == ErrorCode::invalid_argument);
        CHECK(code({}, {.max_steps = 0}) == ErrorCode::invalid_argument);
        CHECK(error_of(cast({box, there}, {}, {floor, here}, flying({}, {1, 0, 0}))).item == 1);
    }

    TEST_CASE("a cast of zero length says whether the shapes are within the tolerance now") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const RigidTransform here = at({}), near = at({2.0 + 1e-9, 0, 0}), far = at({2.1, 0, 0});
        CHECK(cast({box, here}, {}, {box, near}, {}).value().result == CastResult::hit);
        CHECK(cast({box, here}, {}, {box, far}, {}).value().result == CastResult::miss);
        CHECK(cast({box, here}, flying({1, 0, 0}), {box, far}, {}, {.duration = 0.0}).value().result ==
              CastResult::miss);
        const Impact inside = cast({box, here}, flying({1, 0, 0}), {box, here}, {}).value();
        CHECK(inside.result == CastResult::hit);
        CHECK(inside.time == 0.0);
    }

    TEST_CASE("times known by hand: boxes, a sphere on the floor, a bar that turns into a wall") {
        const Shape box = Shape::box({1, 1, 1}).value(), sphere = Shape::sphere(1).value();
        const Shape floor = Shape::half_space({{0, -1, 0}, 0}).value(), bar = Shape::box({2, 0.01f, 0.01f}).value();
        const RigidTransform origin = at({}), ten = at({10, 0.5, 0}), high = at({0, 5, 0});
        CHECK(cast({box, origin}, flying({16, 0, 0}), {box, ten}, {}).value().time == doctest::Approx(0.5));
        CHECK(cast({box, origin}, {}, {box, ten}, flying({-16, 0, 0})).value().time == doctest::Approx(0.5));
        CHECK(cast({sphere, high}, flying({0, -8, 0}), {floor, origin}, {}).value().time == doctest::Approx(0.5));
        CHECK(cast({floor, origin}, {}, {sphere, high}, flying({0, -8, 0})).value().time == doctest::Approx(0.5));
        // The bar's end is 2 from the axis and reaches y = 1 at 30 degrees; its upper edge is 0.01 nearer.
        const RigidTransform wall = at({0, 1.5, 0});
        const Shape slab = Shape::box({9, 0.5f, 9}).value();
        const Impact turn = cast({bar, origin}, flying({}, {0, 0, 1}), {slab, wall}, {}).value();
        CHECK(turn.result == CastResult::hit);
        CHECK(turn.time == doctest::Approx(std::asin(1.0 / std::hypot(2.0, 0.01)) - std::atan(0.005)).epsilon(1e-5));
    }

    TEST_CASE("a hit has a normal, also where the last step ends with a touch") {
        const Shape box = Shape::box({0.5f, 0.5f, 0.5f}).value(), small = Shape::box({0.25f, 0.25f, 0.25f}).value();
        for (const double height : {1.49, 2.0, 1.5, 0.3, 7.77}) {
            const RigidTransform low = at({0, height, 0}), high = at({0, height + 3.51, 0});
            const Impact fall = cast({small, high}, flying({0, -10, 0}), {box, low}, {}).value();
            REQUIRE(fall.result == CastResult::hit);
            CHECK(fall.time == doctest::Approx((3.51 - 0.75) / 10.0).epsilon(1e-5));
            CHECK(fall.normal.y == doctest::Approx(-1.0));
        }
    }

    TEST_CASE("no wall is too thin and no bullet too fast or small") {
        const Shape wall = Shape::triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}).value();
        const Shape bullet = Shape::box({1e-4f, 1e-4f, 1e-4f}).value(), point = Shape::sphere(0).value();
        RandomShapes random(1);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 target(random.number(-2, 2), random.number(-2, 2), 0.0);
            const glm::dvec3 way = random.direction() * 1e3;
            if (std::abs(way.z) < 10.0) continue;
            const RigidTransform from = at(target - 0.37 * way), still = at({});
            const Impact hit = cast({bullet, from}, flying(way, 500.0 * random.direction()), {wall, still}, {}).value();
            CHECK(hit.result == CastResult::hit);
            CHECK(hit.time == doctest::Approx(0.37).epsilon(1e-3));
            CHECK(cast({point, from}, flying(way), {wall, still}, {}).value().time == doctest::Approx(0.37));
        }
    }

    TEST_CASE("random spinning shapes: at no sampled time before the impact do they meet, and then they are near") {
        RandomShapes random(2);
        int hits = 0, unresolved = 0;
        for (int i = 0; i < 150; ++i) {
            const Shape a = random.polytope(24),
                        b = i % 5 == 0 ? Shape::cylinder(1, 0.3f).value() : random.polytope(24);
            const RigidTransform pose_a{random.rotation(), glm::dvec3(0.0)};
            const RigidTransform pose_b{random.rotation(), 4.0 * random.direction()};
            const Motion ma{0.5 * random.direction(), random.number(0, 30) * random.direction(),
                            0.2 * random.direction()};
            const Motion mb{-pose_b.translation + 0.8 * random.direction(), random.number(0, 9) * random.direction(),
                            glm::dvec3(0.0)};
            const Impact impact = cast({a, pose_a}, ma, {b, pose_b}, mb, {.duration = 2.0}).value();
            unresolved += impact.result == CastResult::unresolved;
            const int samples = 1000;
            for (int k = 0; k < samples; ++k) {
                const double t = impact.time * (k + 0.5) / samples;
                const RigidTransform now_a = moved(pose_a, ma, t), now_b = moved(pose_b, mb, t);
                if (intersects({a, now_a}, {b, now_b})) {
                    CHECK(t >= impact.time * (1.0 - 1e-9));
                    break;
                }
            }
            if (impact.result != CastResult::hit) continue;
            ++hits;
            const RigidTransform now_a = moved(pose_a, ma, impact.time), now_b = moved(pose_b, mb, impact.time);
            CHECK(distance({a, now_a}, {b, now_b}).distance <= 1e-6);
        }
        CHECK(hits > 30);
        CHECK(unresolved == 0);
    }

    TEST_CASE("a translation's time agrees with bisection on a shape grown along the way") {
        RandomShapes random(3);
        int hits = 0;
        for (int i = 0; i < 100; ++i) {
            const Shape a = random.polytope(24), b = random.polytope(24);
            const RigidTransform pose_a{random.rotation(), glm::dvec3(0.0)};
            const RigidTransform pose_b{random.rotation(), 4.0 * random.direction()};
            const glm::dvec3 way = -2.0 * pose_b.translation + random.direction();
            const Impact impact =
                cast({a, pose_a}, {}, {b, pose_b}, flying(way), {.tolerance = 1e-9, .max_steps = 2000}).value();
            // b swept over [0, t] is the hull of b at 0 and at t: it meets a iff they have met by then.
            const auto met_by = [&](double t) {
                std::vector<glm::vec3> p;
                for (int k = 0; k < b.vertex_count(); ++k) {
                    const glm::dvec3 v = pose_b.rotation * b.vertex(k);
                    p.emplace_back(v);
                    p.emplace_back(v + t * way);
                }
                const auto hull = Hull::build(p);
                if (!hull) return false;
                const RigidTransform place = at(pose_b.translation);
                return intersects({a, pose_a}, {Shape::hull(*hull), place});
            };
            if (impact.result == CastResult::miss) {
                CHECK_FALSE(met_by(1.0 - 1e-6));
                continue;
            }
            ++hits;
            // As many steps are enough. The last one finds the shapes near, and makes none: two less are too few.
            const auto with_steps = [&](int steps) {
                return cast({a, pose_a}, {}, {b, pose_b}, flying(way), {.tolerance = 1e-9, .max_steps = steps}).value();
            };
            REQUIRE(impact.steps >= 1);
            CHECK(with_steps(impact.steps).time == impact.time);
            CHECK(with_steps(impact.steps).result == CastResult::hit);
            if (impact.steps > 2) CHECK(with_steps(impact.steps - 2).result == CastResult::unresolved);
            CHECK_FALSE(met_by(impact.time - 1e-5));
            CHECK(met_by(impact.time + 1e-2));
        }
        CHECK(hits > 20);
    }

    TEST_CASE(
        "far from the origin, or flying fast together, boxes that graze by 1e-10 hit, and those that pass by it miss") {
        // Squares of side 2 whose centres are apart by (x, y) with x + y = 4 − overlap meet at x = y = 2, or nearly.
        const Shape box = Shape::box({1, 1, 1}).value();
        const double far = 1e7, fast = 1e6 + 0.1;
        for (const double overlap : {1e-10, -1e-10})
            for (const double common : {0.0, fast})
                for (int k = 0; k < 64; ++k) {
                    const double ahead = 0.75 + k / 128.0, speed = 2.0 + 3.0 * k / 64.0;
                    const glm::dvec3 corner(common == 0.0 ? far : 0.0, 0, 0), both(common, 0, 0);
                    const RigidTransform here = at(corner),
                                         there = at(corner + glm::dvec3(2.0 + ahead, 2.0 - ahead - overlap, 0));
                    const CastOptions fine{.tolerance = 1e-12, .max_steps = 10000};
                    const Impact impact =
                        cast({box, here}, flying(both), {box, there}, flying(both + glm::dvec3(-speed, speed, 0)), fine)
                            .value();
                    CHECK(impact.result == (overlap > 0.0 ? CastResult::hit : CastResult::miss));
                }
    }

    TEST_CASE("a gap that closes within a rounding of the time is a hit, after few steps") {
        // A turning box's edge, √2 from the axis and at 45 degrees from below, goes down until it reaches the floor.
        const Shape box = Shape::box({1, 1, 1}).value(), floor = Shape::half_space({{0, -1, 0}, 0}).value();
        const RigidTransform low = at({});
        for (int k = 1; k <= 50; ++k) {
            const double height = std::numbers::sqrt2 - 1e-3 * k;
            const RigidTransform high = at({0, height, 0});
            const Motion turn = flying({}, {0, 0, 1});
            const Impact impact = cast({box, high}, turn, {floor, low}, {}, {.tolerance = 1e-16}).value();
            CHECK(impact.result == CastResult::hit);
            CHECK(impact.time == doctest::Approx(std::numbers::pi / 4 - std::acos(height / std::numbers::sqrt2)));
        }
    }

    // Where a point on an arm that turns by about 200 radians is pushed back most by rounding, of 4,000,000 tried.
    TEST_CASE("rounding of an angle causes no miss: a turning point that grazes a box by 1e-14 hits it") {
        using Real = long double;
        struct Turn {
            glm::dvec3 spin, arm;
            double time;
        };
        const Turn turns[] = {{{0x1.0253694168526p+7, -0x1.63191d625fe09p-2, -0x1.fe43117e9fdf4p+3},
                               {-0x1.1497eb079638fp-5, -0x1.ef1ce2463d46fp-1, -0x1.0285b53501b7ep-2},
                               0x1.00d9f6200e35p+0},
                              {{-0x1.7f48e747c1ef8p+6, 0x1.588e55100d26cp+6, -0x1.83f796561d0c8p+1},
                               {0x1.69b088c51800ap-2, 0x1.7344f67705819p-2, -0x1.b9906dd59ee8ep-1},
                               0x1.060353ea1e055p+0}};
        const Shape point = Shape::sphere(0).value(), box = Shape::box({1e-3f, 1e-3f, 1e-3f}).value();
        for (const Turn& turn : turns) {
            const Motion motion{(0.05 / 6.283185307) * turn.spin, turn.spin, -turn.arm};
            // arm · cos + spin × arm · sin + … in long double: where the point is at the end, and where it goes.
            const Real rate = std::sqrt(Real(turn.spin.x) * Real(turn.spin.x) + Real(turn.spin.y) * Real(turn.spin.y) +
                                        Real(turn.spin.z) * Real(turn.spin.z));
            const Real cosine = std::cos(rate * Real(turn.time)), sine = std::sin(rate * Real(turn.time));
            Real u[3], a[3], place[3], way[3], along = 0;
            for (int k = 0; k < 3; ++k)
                u[k] = Real(turn.spin[k]) / rate, a[k] = Real(turn.arm[k]), along += u[k] * a[k];
            for (int k = 0; k < 3; ++k) {
                const int i = (k + 1) % 3, j = (k + 2) % 3;
                const Real across = u[i] * a[j] - u[j] * a[i];
                place[k] = (cosine - 1) * a[k] + sine * across + (1 - cosine) * along * u[k] +
                           Real(motion.velocity[k]) * Real(turn.time);
                way[k] = cosine * across - sine * a[k];
            }
            const glm::dvec3 front = glm::normalize(glm::dvec3(double(way[0]), double(way[1]), double(way[2])));
            const glm::dvec3 side = glm::normalize(glm::cross(front, glm::dvec3(0.3, 0.5, 0.7)));
            RigidTransform pose{glm::dmat3(front, side, glm::cross(front, side)), {}};
            for (int k = 0; k < 3; ++k) pose.translation[k] = double(place[k] + way[k] * (Real(1e-3f) - Real(1e-15)));
            const CastOptions options{.duration = turn.time, .tolerance = 1e-300, .max_steps = 1000000};
            const Impact impact = cast({point, at({})}, motion, {box, pose}, {}, options).value();
            CHECK(impact.result == CastResult::hit);
            CHECK(impact.time == doctest::Approx(turn.time));
        }
    }

    // For such a needle an algorithm in floating point alone finds a gap of 0.5 where there is none.
    TEST_CASE("a needle a million times as long as wide is hit at once where a box overlaps it, else before") {
        const Shape needle = Shape::box({632832.0f, 0.75f, 1.0f}).value(),
                    box = Shape::box({2.375f, 1.75f, 2.75f}).value();
        const RigidTransform lying{{{0.470588237f, 0.41522491f, -0.778546691f},
                                    {-0.286168516f, 0.906480849f, 0.310483485f},
                                    {0.834658206f, 0.0766856819f, 0.54540354f}},
                                   {4.25, -1.7462298274040222e-10, 5.125}};
        const RigidTransform there = at({2.5153967513469979, 0.67383012239588425, 1.8703839550144039});
        REQUIRE(intersects({needle, lying}, {box, there}));
        const glm::dvec3 away(0.875, -6.25, -15.75);
        const auto now =
            cast({needle, lying}, {}, {box, there}, flying(away), {.duration = 2.0, .tolerance = 1e-4}).value();
        CHECK(now.result == CastResult::hit);
        CHECK(now.time == 0.0);
        int hits = 0;
        for (int i = 0; i < 200; ++i) {
            const double back = 0.5 + 0.01 * i;
            const RigidTransform start = at(there.translation + back * away);
            const auto met =
                cast({needle, lying}, {}, {box, start}, flying(-away), {.duration = 4.0, .tolerance = 1e-4});
            REQUIRE(met.has_value());
            REQUIRE(met->result != CastResult::miss);
            hits += met->result == CastResult::hit;
            CHECK(met->time <= back);
            for (int k = 0; k < 8; ++k) {
                const RigidTransform before = at(start.translation - met->time * k / 8.0 * away);
                CHECK((met->time == 0.0 || !intersects({needle, lying}, {box, before})));
            }
        }
        CHECK(hits == 200);
    }

    TEST_CASE("a cone without width does not hit a needle that it has not reached") {
        const glm::vec3 corners[] = {{-1.64845915e-12f, -1.64845915e-12f, -1.64845915e-12f},
                                     {-237568.0f, -0.124838918f, 0.0f},
                                     {-0.125f, -0.125f, -0.124838918f},
                                     {0.0f, -0.125f, 0.125f}};
        const Hull hull = Hull::build(corners).value();
        const Shape needle = Shape::hull(hull), cone = Shape::cone(2.0f, 0.0f).value();
        const RigidTransform a{{{-0.55526853944677645, 0.64040469271337863, -0.53062103110537095},
                                {-0.53062103110537095, 0.2184910128080938, 0.81896458938757943},
                                {0.64040469271337863, 0.73630395005919702, 0.2184910128080938}},
                               {-9.0, -7.25, -1.6484591469634324e-12}},
            b{{{-1.0000000000000004, 0.0, 0.0},
               {0.0, -2.2204460492503131e-16, 1.0000000000000002},
               {0.0, 1.0000000000000002, -2.2204460492503131e-16}},
              {1.6807887671119808, 3.1757186480358079, 8.5616808734836152}};
        const Motion motion_a{{10.625, 10.625, 10.625}, {}, glm::dvec3(-0.125)},
            motion_b{glm::dvec3(-0.125), {0, 0, 3.8125}, {}};
        const CastOptions options{.duration = 3.46875, .tolerance = 0.015625};
        const auto impact = cast({needle, a}, motion_a, {cone, b}, motion_b, options).value();
        REQUIRE(impact.result == CastResult::hit);
        const RigidTransform now_a = moved(a, motion_a, impact.time), now_b = moved(b, motion_b, impact.time);
        CHECK(distance({needle, now_a}, {cone, now_b}).lower <= options.tolerance);
    }
}
