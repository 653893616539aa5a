// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/collide/bound_contacts.hpp>
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

bool oracle_half_space(const Obb& box, const Plane& plane) {
    oracle::Rational value(plane.offset);
    value += oracle::dot(oracle::rational(plane.normal), oracle::rational(box.center));
    for (int k = 0; k < 3; ++k)
        value += abs(oracle::dot(oracle::rational(plane.normal), oracle::rational(box.axes[k]))) *
                 oracle::Rational(double(box.half_extents[k]));
    return value >= 0;
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

    TEST_CASE("spheres and capsules beyond the largest coordinate meet nothing") {
        const Obb box{{}, glm::mat3(1.0f), {1, 1, 1}};
        for (const double far : {1.1e30, 1e154, 1e155, 1e200, 1e308}) {
            CAPTURE(far);
            CHECK_FALSE(intersects(box, Sphere{{far, 0, 0}, 1.0}));
            CHECK_FALSE(intersects(box, Capsule{{far, 0, 0}, {far, 1, 0}, 1.0}));
            CHECK_FALSE(intersects(box, Capsule{{1, 2, 3}, {far, 1, 0}, 1.0}));
            CHECK_FALSE(intersects(box, Sphere{{}, far}));
        }
        CHECK_FALSE(intersects(box, Sphere{{kMaxCoordinate, 0, 0}, 1.0}));
        CHECK(intersects(box, Sphere{{kMaxCoordinate, 0, 0}, kMaxCoordinate}));
    }
    TEST_CASE("half-spaces and boxes whose roundings add up to a sixteenth of the filter's bound, and more") {
        // Found by a search for the greatest sum of roundings: 2.6 to 3 half units in the last place of the terms' sum.
        const struct {
            Obb box;
            Plane plane;
        } found[] = {
            {{{-0x1.3760c02ce917ep-3, -0x1.aec6a8a42032cp+0, -0x1.ce6d2c8e15a66p-4},
              glm::mat3(0x1.fb5c52p-6f, -0x1.b6ad7cp-1f, 0x1.078adp-1f, -0x1.0f7cf6p-4f, 0x1.062fe4p-1f, 0x1.b676acp-1f,
                        -0x1.fea0c6p-1f, -0x1.f0bb6p-5f, -0x1.4f4fecp-5f),
              {0x1.2cd55cp-11f, 0x1.9579c6p-14f, 0x1.0d5f82p+1f}},
             {{0x1.22aaae16a3fa1p-1, 0x1.747b5e4096993p-1, 0x1.90ee3485b55d5p-3}, 0x1.fc7c4bce7525ep-6}},
            {{{0x1.05500aa67695ep+1, 0x1.db54d6fb5bca6p-8, 0x1.8e6b618bf02ffp+0},
              glm::mat3(0x1.b123b4p-2f, -0x1.7e94dcp-1f, -0x1.066fc6p-1f, -0x1.dbdda8p-2f, -0x1.543968p-1f,
                        0x1.2ba1dp-1f, -0x1.8e487ep-1f, -0x1.321da2p-7f, -0x1.41b38p-1f),
              {0x1.e62eap-3f, 0x1.b9cd7ep-2f, 0x1.51e2e8p-4f}},
             {{-0x1.2ca427aec7a85p-8, 0x1.fdb1fb4d7bf5ap-1, -0x1.533119e51d892p-2}, -0x1.fecbb5b982884p-9}},
            {{{0x1.ba85cce02970ap+0, 0x1.f69d9d03ed2c7p-2, 0x1.ba65bb60605a1p-2},
              glm::mat3(0x1.b65378p-1f, 0x1.04c02cp-2f, -0x1.cc81a6p-2f, 0x1.075f76p-3f, -0x1.e5437ep-1f,
                        -0x1.2ad9a6p-2f, -0x1.00476ep-1f, 0x1.894098p-3f, -0x1.b03404p-1f),
              {0x1.e169eap+0f, 0x1.a02296p-5f, 0x1.0997eep-6f}},
             {{-0x1.fc3ddae223fd7p-1, -0x1.cf8c058dad0bep-1, 0x1.61d834d295bffp-3}, -0x1.09420e906f4f8p-3}},
            {{{-0x1.45c8677da32fep-1, 0x1.17abbd09f3c85p+0, -0x1.7f64ea01282fap-3},
              glm::mat3(-0x1.b99198p-7f, 0x1.1dc3f4p-1f, -0x1.a8c69cp-1f, 0x1.9fd3dcp-5f, -0x1.a81238p-1f,
                        -0x1.1db6aap-1f, -0x1.ff4b1ep-1f, -0x1.969704p-5f, -0x1.194f04p-6f),
              {0x1.e4d29p-4f, 0x1.078ffep+0f, 0x1.3684d6p-1f}},
             {{0x1.9c32af525b84bp-2, -0x1.22c8fd46ab24dp-2, -0x1.329aa68682f52p-6}, 0x1.2961c6d429019p-5}},
        };
        for (auto [box, plane] : found) {
            REQUIRE(validate(box));
            for (int mirror = 0; mirror < 2; ++mirror) {
                CHECK(intersects(box, plane) == oracle_half_space(box, plane));
                box.center = -box.center;
                plane.normal = -plane.normal;
            }
        }
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
            CHECK(intersects(tilted, plane) == oracle_half_space(tilted, plane));
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

    TEST_CASE("triangles and boxes whose roundings add up to a sixteenth of the filter's bound, and more") {
        // Found by a search for the greatest sum of roundings: 2.1 to 2.3 half units in the last place of the terms'
        // sum. The axis is a cross product of edges for two of them, the triangle's normal for the third.
        const struct {
            Obb box;
            Triangle triangle;
        } found[] = {
            {{{-0x1.05fb6592e6943p-1, 0x1.86a5074f69b7p+0, 0x1.4d5b1cfe8fc4cp-3},
              glm::mat3(0x1.3f10d2p-2f, 0x1.7a1008p-2f, -0x1.c0493ep-1f, 0x1.a4fe4ep-3f, 0x1.bf30dep-1f, 0x1.c40c8ep-2f,
                        0x1.dafd96p-1f, -0x1.4527b6p-2f, 0x1.91ecdp-3f),
              {0x1.258a98p-1f, 0x1.235a12p-3f, 0x1.36ca46p-1f}},
             {glm::dvec3(-0x1.d3f2c3e1eef9dp+0, 0x1.534cb2dedca54p+0, -0x1.7f354787ad82ep+0),
              glm::dvec3(0x1.0629e962d8086p+0, 0x1.ab46ef5373b6fp+0, -0x1.c155ab4f4d6a3p+0),
              glm::dvec3(-0x1.363fc270b3394p+0, 0x1.4f34488eaf91p+0, 0x1.3ea4637a07eb8p-1)}},
            {{{-0x1.58f4b71355db7p-1, -0x1.12dbef2fabf4cp-1, -0x1.652a5013d1897p-1},
              glm::mat3(-0x1.a9b0d6p-3f, 0x1.a0fc3ep-4f, -0x1.f21908p-1f, -0x1.4cf3e6p-4f, 0x1.fa89a4p-1f,
                        0x1.ef305cp-4f, 0x1.f315d2p-1f, 0x1.aad72cp-4f, -0x1.943392p-3f),
              {0x1.acf2ccp-17f, 0x1.0908c4p-4f, 0x1.05442ap-3f}},
             {glm::dvec3(-0x1.1e88b5a065c6cp+0, -0x1.a8eb8f8ef8de8p+0, -0x1.241472d92d16dp-1),
              glm::dvec3(0x1.5e8f3cf757fd6p-3, -0x1.9bf84cc2bec06p-2, -0x1.aedc5f52c23fbp-2),
              glm::dvec3(0x1.aed4802b15d1ep-1, 0x1.fee60d821bb3dp+0, -0x1.1dc573633f828p+0)}},
            {{{0x1.eed09ef269929p-2, -0x1.c3da7bc22d11cp-3, -0x1.e4aa529e779d2p-2},
              glm::mat3(0x1.a7ecaep-1f, -0x1.c926fap-2f, 0x1.5b79fp-2f, -0x1.5f6256p-2f, -0x1.c39204p-1f,
                        -0x1.4ad1f2p-2f, 0x1.c627ccp-2f, 0x1.3559ecp-3f, -0x1.c45362p-1f),
              {0x1.1a9b5ap-3f, 0x1.0410dap-1f, 0x1.f899eap-6f}},
             {glm::dvec3(-0x1.f2a8413323e91p+0, -0x1.b9aad3a7c628dp-1, -0x1.aae527894f8adp-1),
              glm::dvec3(0x1.958995a5132fcp-1, -0x1.4754b7fc3c646p-1, -0x1.774350d6671e4p-1),
              glm::dvec3(0x1.d5a0a2c277931p-1, -0x1.a648de3c762ap+0, 0x1.8e11ef2699b7fp+0)}},
        };
        for (const auto& [box, t] : found) {
            REQUIRE(validate(box));
            CHECK(intersects(box, t) == oracle_triangle(box, t));
            const Obb mirrored{-box.center, box.axes, box.half_extents};
            CHECK(intersects(mirrored, Triangle{-t[0], -t[1], -t[2]}) == oracle_triangle(box, t));
        }
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

    TEST_CASE("spheres that nearly touch a box: as the distance between the shapes says") {
        std::mt19937_64 random(12);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (int trial = 0; trial < 20000; ++trial) {
            Obb box = random_box(random, trial % 2 ? 1.0 : 1e6);
            if (trial % 3 == 0) box.half_extents[trial % 9 / 3] = 0.0f;
            if (trial % 5 == 0) box.axes[1] *= 1.0f + 3e-5f;  // nearly as far from orthonormal as validate lets pass
            Sphere sphere{box.center + 3.0 * random_vector(random), 0.0};
            const double away =
                contains(box, sphere.center) ? 0.0 : distance(box, Capsule{sphere.center, sphere.center, 0.0}).distance;
            const double gap = std::pow(10.0, -12.0 * unit(random)) * (1.0 + away);
            if (gap < 1e-9 * glm::length(box.center)) continue;
            sphere.radius = away + gap;
            CHECK(intersects(box, sphere));
            sphere.radius = away - gap;
            if (sphere.radius >= 0.0) CHECK_FALSE(intersects(box, sphere));
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

    TEST_CASE("a sphere whose center lies in a box leaves it by the depth along the normal, and by no shorter way") {
        std::mt19937_64 random(31);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (int i = 0; i < 20000; ++i) {
            Obb box = random_box(random, i % 3 == 0 ? 1e6 : 1.0);
            if (i % 7 == 0) box.half_extents.y = 1e-4f;
            // Anywhere within, beside a face, an edge or a corner by one in 10^0 to 10^15, and on them.
            glm::dvec3 center = box.center;
            for (int k = 0; k < 3; ++k) {
                double share = 2.0 * unit(random) - 1.0;
                if (random() % 3 == 0) share = std::copysign(1.0 - std::pow(10.0, -15.0 * unit(random)), share);
                if (random() % 40 == 0) share = std::copysign(1.0, share);
                if (random() % 40 == 0) share = 0.0;
                center += share * double(box.half_extents[k]) * glm::dvec3(box.axes[k]);
            }
            const Sphere sphere{center, unit(random)};
            const double size = glm::length(glm::dvec3(box.half_extents)) + sphere.radius,
                         slack = 1e-12 * size + 4e-13 * glm::length(box.center);
            CAPTURE(i);
            const Manifold m = contact_manifold(box, sphere);
            if (!intersects(box, sphere)) {
                CHECK(m.count == 0);
                continue;
            }
            REQUIRE(m.count == 1);
            CHECK(m.points[0].depth == m.depth);
            CHECK(glm::length(m.normal) == doctest::Approx(1.0).epsilon(1e-14));
            CHECK(glm::distance(m.points[0].position, center - (sphere.radius - 0.5 * m.depth) * m.normal) <= slack);
            const auto meets = [&](const glm::dvec3& way) {
                return intersects(box, Sphere{center + way, sphere.radius});
            };
            // On the surface, or within 1e-9 of it, the direction is rounded.
            bool on_surface = false;
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 n =
                    glm::normalize(glm::cross(glm::dvec3(box.axes[(k + 1) % 3]), glm::dvec3(box.axes[(k + 2) % 3])));
                on_surface = on_surface || double(box.half_extents[k]) - std::abs(glm::dot(n, center - box.center)) <
                                               1e-9 * size + slack;
            }
            CHECK_FALSE(meets((m.depth + (on_surface ? 1e-3 * sphere.radius + 1e-8 * size : 0.0) + slack) * m.normal));
            if (m.depth <= slack) continue;
            CHECK(meets((m.depth - slack) * m.normal));
            for (int k = 0; k < 3; ++k)
                for (const double side : {-1.0, 1.0})
                    CHECK(meets(side * (m.depth - slack) *
                                glm::normalize(
                                    glm::cross(glm::dvec3(box.axes[(k + 1) % 3]), glm::dvec3(box.axes[(k + 2) % 3])))));
            CHECK(meets((m.depth - slack) * glm::normalize(random_vector(random))));
        }
    }

    TEST_CASE("a sphere above a box's face, edge or corner touches at the nearest point of the box") {
        std::mt19937_64 random(32);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        int touching = 0;
        for (int i = 0; i < 20000; ++i) {
            const Obb box = random_box(random);
            const glm::dvec3 center = box.center + 1.7 * random_vector(random);
            const Sphere sphere{center, unit(random)};
            // The least of all points of the box's surface, by descent along each face.
            const Distance nearest = distance(box, Capsule{center, center, 0.0});
            const Manifold m = contact_manifold(box, sphere);
            CHECK((m.count == 1) == intersects(box, sphere));
            if (m.count == 0 || !(nearest.distance > 1e-6)) continue;
            const glm::dvec3 n = (center - nearest.on_a) / nearest.distance;
            CHECK(glm::distance(m.normal, n) <= 1e-12 / nearest.distance);
            CHECK(std::abs(m.depth - (sphere.radius - nearest.distance)) <= 1e-12);
            CHECK(glm::distance(m.points[0].position, center - (sphere.radius - 0.5 * m.depth) * n) <=
                  1e-12 / nearest.distance);
            ++touching;
        }
        CHECK(touching > 3000);
    }
}
