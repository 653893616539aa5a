// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "random_boxes.hpp"

using namespace crofton;
using namespace crofton::collide;
using namespace crofton::testing;

namespace {

// How far a point is outside a box, along its face normals: ≤ 0 inside.
double outside(const Obb& box, const glm::dvec3& p) {
    double worst = -1e300;
    for (int k = 0; k < 3; ++k)
        worst =
            std::max(worst, std::abs(glm::dot(glm::dvec3(box.axes[k]), p - box.center)) - double(box.half_extents[k]));
    return worst;
}

Obb parted(Obb b, const glm::dvec3& motion) {
    b.center += motion;
    return b;
}

}  // namespace

TEST_SUITE("collide/convex_query") {
    TEST_CASE("points on top of each other, shapes without extent and coincident boxes have answers") {
        const Sphere point{{1.0, 2.0, 3.0}, 0.0}, sphere{{1.0, 2.0, 3.0}, 0.5};
        CHECK(distance(Capsule{point.center, point.center, 0.0}, point).distance == 0.0);
        CHECK(contact_manifold(point, point).depth == 0.0);
        CHECK(contact_manifold(sphere, sphere).depth == doctest::Approx(1.0));
        CHECK(contact_manifold(sphere, sphere).count == 1);
        const Obb box = cube_box({});
        CHECK(penetration(box, box).depth == doctest::Approx(2.0));
        CHECK(distance(box, box).distance == 0.0);
        CHECK(contact_manifold(box, box).count >= 1);
        Obb flat = cube_box({}, 0.0f);
        CHECK(contact_manifold(flat, flat).count == 1);
    }

    TEST_CASE("distances known by hand: faces, edges and corners") {
        CHECK(distance(cube_box({}), cube_box({5.0, 0.5, 0.0})).distance == doctest::Approx(3.0));
        CHECK(distance(cube_box({}), cube_box({5.0, 6.0, 0.0})).distance == doctest::Approx(5.0));
        CHECK(distance(cube_box({}), cube_box({4.0, 4.0, 4.0})).distance == doctest::Approx(2.0 * std::sqrt(3.0)));
        const Distance d = distance(cube_box({}), Capsule{{4.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, 1.0});
        CHECK(d.distance == doctest::Approx(2.0));
        CHECK(d.on_a.x == doctest::Approx(1.0));
        CHECK(d.on_b.x == doctest::Approx(3.0));
        CHECK(distance(Capsule{{0, 0, 0}, {0, 0, 9}, 1.0}, Sphere{{5, 0, 4}, 1.5}).distance == doctest::Approx(2.5));
        CHECK(distance(cube_box({}), Capsule{{4, -9, -2}, {4, 9, 2}, 0.5}).distance == doctest::Approx(2.5));
    }

    TEST_CASE(
        "random boxes: nearest points lie on the boxes, the plane between proves the distance, meeting means zero") {
        std::mt19937_64 random(1);
        int apart = 0;
        for (int trial = 0; trial < 5000; ++trial) {
            const Obb a = random_box(random), b = random_box(random, 2.5);
            const Distance d = distance(a, b);
            if (intersects(a, b)) {
                CHECK(d.distance < 1e-9);
                continue;
            }
            ++apart;
            CHECK(outside(a, d.on_a) < 1e-6);  // axes are orthonormal to float only
            CHECK(outside(b, d.on_b) < 1e-6);
            CHECK(glm::distance(d.on_a, d.on_b) == doctest::Approx(d.distance));
            const glm::dvec3 n = (d.on_b - d.on_a) / d.distance;
            const double gap = glm::dot(n, support_point(b, -n)) - glm::dot(n, support_point(a, n));
            CHECK(gap == doctest::Approx(d.distance).epsilon(1e-8));
        }
        CHECK(apart > 1000);
    }

    TEST_CASE("the penetration's motion just ends the overlap, and a little less does not") {
        std::mt19937_64 random(2);
        int meeting = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            const Obb a = random_box(random), b = random_box(random, 1.0);
            const Penetration p = penetration(a, b);
            CHECK((p.depth >= -1e-9) == intersects(a, b));
            CHECK(glm::length(p.axis) == doctest::Approx(1.0));
            if (p.depth < 1e-3) continue;
            ++meeting;
            CHECK_FALSE(intersects(a, parted(b, p.axis * (p.depth * (1.0 + 1e-6) + 1e-6))));
            CHECK(intersects(a, parted(b, p.axis * (p.depth * (1.0 - 1e-6) - 1e-6))));
        }
        CHECK(meeting > 1000);
    }

    TEST_CASE("manifolds known by hand: a face on a face, a corner on a face, an edge across an edge") {
        const Manifold stacked = contact_manifold(cube_box({}), cube_box({0.5, 0.0, 1.9}));
        CHECK(stacked.count == 4);
        CHECK(stacked.normal.z == doctest::Approx(1.0));
        CHECK(stacked.depth == doctest::Approx(0.1));
        for (int i = 0; i < stacked.count; ++i) {
            CHECK(stacked.points[i].depth == doctest::Approx(0.1));
            CHECK(stacked.points[i].position.z == doctest::Approx(0.95));
            CHECK(stacked.points[i].position.x >= -0.5 - 1e-12);
        }
        Obb turned = cube_box({0.0, 0.0, 1.9});
        const float s = float(std::sqrt(0.5));
        turned.axes = glm::mat3(glm::vec3(s, s, 0), glm::vec3(-s, s, 0), glm::vec3(0, 0, 1));
        CHECK(contact_manifold(cube_box({}), turned, ManifoldPoints::all).count == 8);
        CHECK(contact_manifold(cube_box({}), turned).count == 4);
        Obb roof = cube_box({0.0, 0.0, 1.0 + std::sqrt(2.0) - 0.1});
        roof.axes = glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0, s, s), glm::vec3(0, -s, s));
        CHECK(contact_manifold(cube_box({}), roof).count == 2);
        Obb beam_a = roof, beam_b = roof;
        beam_a.center = {};
        beam_b.center = {0.0, 0.0, 2.0 * std::sqrt(2.0) - 0.1};
        beam_b.axes = glm::mat3(glm::vec3(0, 1, 0), glm::vec3(-s, 0, s), glm::vec3(s, 0, s));
        const Manifold crossing = contact_manifold(beam_a, beam_b);
        REQUIRE(crossing.count == 1);
        CHECK(crossing.depth == doctest::Approx(0.1));
        CHECK(crossing.points[0].position.z == doctest::Approx(std::sqrt(2.0) - 0.05));
    }

    TEST_CASE(
        "random manifolds: one to eight points, in both boxes up to the depth, none when apart, symmetric in depth") {
        std::mt19937_64 random(3);
        for (int trial = 0; trial < 4000; ++trial) {
            const auto [a, b] = trial % 2 ? std::pair(random_box(random), random_box(random))
                                          : nearly_touching(random, {.parallel = trial % 4 == 0});
            const Manifold m = contact_manifold(a, b);
            CHECK((m.count > 0) == intersects(a, b));
            CHECK(m.count <= 8);
            for (int i = 0; i < m.count; ++i) {
                CHECK(outside(a, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-5);
                CHECK(outside(b, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-5);
                CHECK(m.points[i].depth >= 0.0);
            }
            if (m.count > 0) CHECK(contact_manifold(b, a).depth == doctest::Approx(m.depth).epsilon(1e-6));
        }
    }

    TEST_CASE("boxes of no thickness touch within both: a plate on a floor, plates that cross, plates in one plane") {
        const Obb floor{{0.0, 0.0, -0.5}, glm::mat3(1.0f), glm::vec3(5.0f, 5.0f, 0.5f)};
        Obb plate{{0.3, 0.2, 0.999}, glm::mat3(1.0f), glm::vec3(1.0f, 1.0f, 0.0f)};
        plate.axes = glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, -1, 0));  // upright
        for (const auto& [a, b] : {std::pair(floor, plate), std::pair(plate, floor)}) {
            const Manifold m = contact_manifold(a, b);
            REQUIRE(m.count == 2);
            for (int i = 0; i < 2; ++i) {
                CHECK(std::abs(m.points[i].position.x - 0.3) == doctest::Approx(1.0));
                CHECK(m.points[i].position.y == doctest::Approx(0.2));
                CHECK(m.points[i].depth == doctest::Approx(0.001));
            }
        }
        std::mt19937_64 random(41);
        int met = 0;
        for (int trial = 0; trial < 4000; ++trial) {
            Obb a = random_box(random), b = random_box(random);
            if (trial % 4 == 3) b.axes = a.axes;
            a.half_extents[trial % 3] = 0.0f;
            if (trial % 2 == 0) b.half_extents[trial / 3 % 3] = 0.0f;
            if (trial % 8 == 0) a.half_extents[(trial + 1) % 3] = 0.0f;
            if (trial % 16 == 3) b.center = a.center + 0.5 * glm::dvec3(a.axes[(trial + 1) % 3]);
            const Manifold m = contact_manifold(a, b);
            REQUIRE((m.count > 0) == intersects(a, b));
            met += m.count > 0;
            for (int i = 0; i < m.count; ++i) {
                CHECK(outside(a, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-6);
                CHECK(outside(b, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-6);
            }
        }
        CHECK(met > 500);
    }

    TEST_CASE("far from the origin contact points lie on the boxes, to the rounding of their coordinates") {
        std::mt19937_64 random(42);
        int met = 0;
        for (const double place : {1e6, 1e7}) {
            for (int trial = 0; trial < 3000; ++trial) {
                auto [a, b] = nearly_touching(random, {.parallel = trial % 3 == 0});
                const glm::dvec3 offset = place * random_vector(random);
                a.center += offset;
                b.center += offset;
                const Manifold m = contact_manifold(a, b);
                REQUIRE((m.count > 0) == intersects(a, b));
                met += m.count > 0;
                for (int i = 0; i < m.count; ++i) {
                    CHECK(outside(a, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-6);
                    CHECK(outside(b, m.points[i].position) <= 0.5 * m.points[i].depth + 1e-6);
                }
            }
        }
        CHECK(met > 1000);
    }

    TEST_CASE("a plate thinner than its coordinates' last place has two points where it stands, and no twins of them") {
        std::mt19937_64 random(45);
        for (int trial = 0; trial < 2000; ++trial) {
            Obb ground{{}, glm::mat3(glm::mat3_cast(random_rotation(random))), {1.0f, 1.0f, 0.5f}};
            Obb plate{{}, ground.axes, {0.3f, 5e-15f, 0.4f}};
            ground.center = std::exp2(8 + trial % 4) * random_vector(random, 0.5);
            plate.center = ground.center + 0.899 * glm::dvec3(ground.axes[2]);
            const Manifold m = contact_manifold(ground, plate, ManifoldPoints::all);
            REQUIRE(m.count == 2);
            CHECK(glm::length(m.points[1].position - m.points[0].position) == doctest::Approx(0.6));
            CHECK(m.depth == doctest::Approx(0.001));
        }
    }

    TEST_CASE("a manifold is as deep as its deepest point, and its four points keep that and most of the area") {
        std::mt19937_64 random(43);
        int reduced = 0;
        for (int trial = 0; trial < 5000; ++trial) {
            auto [a, b] = trial % 2 ? std::pair(random_box(random), random_box(random))
                                    : nearly_touching(random, {.parallel = trial % 4 == 0});
            if (trial % 5 == 0) {  // turned about the axis that a's face looks along: up to eight points
                const double angle = 1.6 * random_vector(random).x;
                b.axes = glm::mat3(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(glm::dvec3(a.axes[2])))) *
                                   glm::dmat3(a.axes));
                b.center = a.center + glm::dvec3(a.axes[2]) * (double(a.half_extents.z + b.half_extents.z) - 0.01);
            }
            const Manifold all = contact_manifold(a, b, ManifoldPoints::all), few = contact_manifold(a, b);
            const auto deepest = [](const Manifold& m) {
                double depth = 0.0;
                for (int i = 0; i < m.count; ++i) depth = std::max(depth, m.points[i].depth);
                return depth;
            };
            REQUIRE(few.count <= 4);
            REQUIRE((few.count == 0) == (all.count == 0));
            CHECK(all.depth == deepest(all));
            CHECK(few.depth == deepest(few));
            CHECK(few.depth == all.depth);
            CHECK(few.normal == all.normal);
            if (all.count <= 4) {
                CHECK(few.count == all.count);
                continue;
            }
            ++reduced;
            const auto area = [](const Manifold& m) {
                glm::dvec3 sum(0.0);
                for (int i = 1; i + 1 < m.count; ++i)
                    sum += glm::cross(m.points[i].position - m.points[0].position,
                                      m.points[i + 1].position - m.points[0].position);
                return 0.5 * std::abs(glm::dot(sum, m.normal));
            };
            CHECK(area(few) >= 0.5 * area(all));
        }
        CHECK(reduced > 300);
    }

    TEST_CASE("distances of boxes are proven to 1e-12 of their size: parallel, flat, touching, tiny and large") {
        std::mt19937_64 random(44);
        int apart = 0, meeting = 0;
        for (int trial = 0; trial < 20000; ++trial) {
            auto [a, b] = trial % 2 ? std::pair(random_box(random), random_box(random, 2.5))
                                    : nearly_touching(random, {.parallel = trial % 4 == 0, .no_gap = trial % 16 == 2});
            if (trial % 5 == 0) a.half_extents[trial % 3] = 0.0f;
            if (trial % 7 == 0) b.half_extents[trial % 3] = 0.0f;
            if (trial % 11 == 0) a.half_extents[(trial + 1) % 3] *= 1e-6f;
            if (trial % 13 == 0) b.half_extents *= 1e-3f;
            if (trial % 17 == 0) b.half_extents *= 1e3f;
            const Distance d = distance(a, b);
            const bool meets = intersects(a, b);
            REQUIRE((d.distance == 0.0) == meets);
            double size = glm::length(b.center - a.center);
            for (int k = 0; k < 3; ++k) size += double(a.half_extents[k]) + double(b.half_extents[k]);
            if (meets) {
                CHECK(d.on_a == d.on_b);
                CHECK(outside(a, d.on_a) <= 1e-6 * size);
                CHECK(outside(b, d.on_a) <= 1e-6 * size);
                ++meeting;
                continue;
            }
            ++apart;
            CHECK(outside(a, d.on_a) <= 2e-6 * size);  // axes are orthonormal to float only
            CHECK(outside(b, d.on_b) <= 2e-6 * size);
            const glm::dvec3 way = d.on_b - d.on_a;
            CHECK(std::abs(glm::length(way) - d.distance) <= 1e-14 * size);
            if (d.distance < 1e-9 * size) continue;  // the way's own rounding is too large to prove anything
            // The gap along any direction is a lower bound of the distance, and the ends are an upper bound. Tried are
            // the way between the ends, the same across each axis, and the fifteen axes of the boxes.
            glm::dvec3 axes[6];
            std::vector<glm::dvec3> directions{way};
            for (int k = 0; k < 6; ++k) {
                axes[k] = glm::dvec3((k < 3 ? a : b).axes[k % 3]);
                glm::dvec3 across = way;
                for (int pass = 0; pass < 3; ++pass)
                    across -= glm::dot(across, axes[k]) / glm::dot(axes[k], axes[k]) * axes[k];
                directions.push_back(across);
            }
            for (int p = 0; p < 6; ++p)
                for (int q = p + 1; q < 6; ++q) {
                    const glm::dvec3 n = glm::cross(axes[p], axes[q]);
                    directions.push_back(glm::dot(n, way) < 0.0 ? -n : n);
                }
            double gap = -1e300;
            for (const glm::dvec3& direction : directions) {
                const double length = glm::length(direction);
                if (!(length > 0.0)) continue;
                const glm::dvec3 n = direction / length;
                double along = glm::dot(n, b.center - a.center);
                for (int k = 0; k < 3; ++k)
                    along -= double(a.half_extents[k]) * std::abs(glm::dot(n, axes[k])) +
                             double(b.half_extents[k]) * std::abs(glm::dot(n, axes[k + 3]));
                gap = std::max(gap, along);
            }
            CHECK(d.distance - gap <= 1e-12 * size);
        }
        CHECK(apart > 5000);
        CHECK(meeting > 2000);
    }

    TEST_CASE("1,000 crates stacked with rounded rotations: every contact is found, and none between crates apart") {
        std::mt19937_64 random(4);
        std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
        int missed = 0, invented = 0;
        for (int stack = 0; stack < 10; ++stack) {
            const glm::dquat frame = random_rotation(random);
            std::vector<Obb> crates;
            for (int i = 0; i < 100; ++i) {
                Obb crate = cube_box({}, 0.5f);
                crate.axes = glm::mat3(glm::mat3_cast(frame * glm::angleAxis(angle(random), glm::dvec3(0, 0, 1))));
                crate.center =
                    glm::mat3_cast(frame) * glm::dvec3(0.0, 0.0, i * (1.0 - 1e-5));  // 1e-5 deep in each other
                crates.push_back(crate);
            }
            for (std::size_t i = 0; i < 100; ++i)
                for (std::size_t j = i + 1; j < 100; ++j) {
                    const bool hit = contact_manifold(crates[i], crates[j]).count > 0;
                    missed += j == i + 1 && !hit;
                    invented += j > i + 1 && hit;
                }
        }
        CHECK(missed == 0);
        CHECK(invented == 0);
    }
}
