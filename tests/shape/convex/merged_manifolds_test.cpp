// SPDX-License-Identifier: MIT
// Which parts of a shape share a manifold.
#include <doctest/doctest.h>
#include <algorithm>
#include <map>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

const double kFiveDegrees = std::cos(5.0 * M_PI / 180.0);

// Triangles that face up, each tilted, whose middles are around the origin and which share nothing.
Surface tilted_triangles(RandomShapes& random, int count, double degrees) {
    Surface s;
    for (int i = 0; i < count; ++i) {
        const double tilt = random.number(0.0, degrees) * M_PI / 180.0, turn = random.number(0.0, 6.2);
        const glm::dvec3 u(std::cos(turn) * std::cos(tilt), std::sin(tilt), std::sin(turn) * std::cos(tilt)),
            v(-std::sin(turn), 0.0, std::cos(turn));
        const glm::dvec3 middle(random.number(-0.3, 0.3), random.number(-0.02, 0.0), random.number(-0.3, 0.3));
        for (int k = 0; k < 3; ++k) {
            const double angle = -2.0943951 * k;
            s.mesh.positions.emplace_back(middle + 0.4 * (std::cos(angle) * u + std::sin(angle) * v));
            s.mesh.indices.push_back(static_cast<std::uint32_t>(3 * i + k));
        }
    }
    s.build();
    return s;
}

struct Own {  // what a part gives alone
    Manifold manifold;
    std::size_t order;
};

}  // namespace

TEST_SUITE("convex/merged_manifolds") {
    TEST_CASE("two faces 4 degrees apart share a manifold, 6, 9 and 18 degrees apart each has its own") {
        for (const double degrees : {4.0, 6.0, 9.0, 18.0})
            for (const double deeper : {-1e-4, 1e-4}) {  // whichever of the two is deeper
                CAPTURE(degrees);
                const double half = 0.5 * degrees * M_PI / 180.0;
                Surface s;
                for (const double side : {-1.0, 1.0}) {
                    const double y = side > 0.0 ? deeper : 0.0, rise = std::tan(half);
                    const glm::dvec3 in(side * 0.01, y + 0.01 * rise, 0.0), out(side * 3.0, y + 3.0 * rise, 0.0);
                    const glm::dvec3 corner[3] = {in + glm::dvec3(0, 0, 2), in - glm::dvec3(0, 0, 2), out};
                    for (const int k : {0, side > 0.0 ? 2 : 1, side > 0.0 ? 1 : 2}) {
                        s.mesh.indices.push_back(static_cast<std::uint32_t>(s.mesh.positions.size()));
                        s.mesh.positions.emplace_back(corner[k]);
                    }
                }
                s.build();
                const Shape sphere = Shape::sphere(1.0).value();
                Manifolds found;
                contact_manifolds({s.shape(), at({})}, {sphere, at({0, 0.99, 0})}, {}, found);
                CHECK(found.all().size() == (degrees < 5.0 ? 1 : 2));
                if (degrees < 5.0) continue;
                const double between = glm::dot(found.all()[0].normal, found.all()[1].normal);
                CHECK(between == doctest::Approx(std::cos(2.0 * half)).epsilon(1e-4));
            }
    }

    TEST_CASE("a point's own normal is within 5 degrees of its manifold's, and no two manifolds are") {
        RandomShapes random(51);
        Manifolds found;
        int shared = 0, several = 0;
        for (int round = 0; round < 2000; ++round) {
            CAPTURE(round);
            const Surface s = tilted_triangles(random, 2 + random.index(8), round % 2 == 0 ? 12.0 : 30.0);
            const Shape surface = s.shape(), shape = round % 3 == 0   ? Shape::sphere(0.5).value()
                                                     : round % 3 == 1 ? Shape::box({0.3f, 0.5f, 0.3f}).value()
                                                                      : Shape::capsule(0.2f, 0.3f).value();
            const RigidTransform pose{random.rotation(), random.direction()};
            const RigidTransform above{pose.rotation, pose.translation + pose.rotation * glm::dvec3(0, 0.49, 0)};
            const ManifoldOptions options{.margin = 0.02, .max_points = 8};
            std::map<std::uint32_t, Own> own;
            for (std::size_t t = 0; t < s.size(); ++t) {
                const Manifold m = contact_manifold({s.triangle(t), pose}, {shape, above}, options);
                if (m.count > 0) own[static_cast<std::uint32_t>(t)] = {m, t};
            }
            const bool flip = round % 5 == 0;
            if (flip)
                contact_manifolds({shape, above}, {surface, pose}, options, found);
            else
                contact_manifolds({surface, pose}, {shape, above}, options, found);
            const double side = flip ? -1.0 : 1.0;
            std::size_t parts = 0;
            for (const Manifold& m : found.all()) {
                const auto part_of = [&](const ContactPoint& p) {
                    return flip ? p.part_b.triangle : p.part_a.triangle;
                };
                const ContactPoint* deepest = m.points;
                for (int i = 0; i < m.count; ++i) {
                    const ContactPoint& p = m.points[i];
                    REQUIRE(own.count(part_of(p)) == 1);
                    const Manifold& alone = own[part_of(p)].manifold;
                    CHECK(side * glm::dot(m.normal, alone.normal) >= kFiveDegrees - 1e-9);
                    // One of the part's own points: the same place, depth and features.
                    CHECK(std::any_of(alone.points, alone.points + alone.count, [&](const ContactPoint& q) {
                        return glm::distance(p.position, q.position) <= 1e-8 && std::abs(p.depth - q.depth) <= 1e-8;
                    }));
                    if (p.depth > deepest->depth) deepest = &p;
                    parts += i == 0 || part_of(p) != part_of(m.points[i - 1]) ? 1 : 0;
                }
                CHECK(m.depth == deepest->depth);
                const glm::dvec3 expected = side * own[part_of(*deepest)].manifold.normal;
                CHECK(glm::distance(m.normal, expected) <= 1e-6);
                for (const Manifold& n : found.all())
                    if (&n != &m) CHECK(glm::dot(m.normal, n.normal) < kFiveDegrees + 1e-9);
            }
            // Each part's normal is near some manifold's.
            for (const auto& part : own)
                CHECK(std::any_of(found.all().begin(), found.all().end(), [&](const Manifold& m) {
                    return side * glm::dot(m.normal, part.second.manifold.normal) >= kFiveDegrees - 1e-9;
                }));
            shared += parts > found.all().size() ? 1 : 0;
            several += found.all().size() > 1 ? 1 : 0;
        }
        CHECK(shared > 300);
        CHECK(several > 300);
    }
}
