// SPDX-License-Identifier: MIT
// Boxes, balls and capsules against one triangle of a surface, in closed form: against the certified bounds of
// `penetration` and `distance`.
#include <doctest/doctest.h>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// Of any form: also slivers, tiny ones, and edges along or nearly along the axes.
Surface one_triangle(RandomBodies& random) {
    const double size = std::pow(10.0, random.number(-3.0, 1.0));
    glm::dvec3 corner[3];
    for (glm::dvec3& p : corner) p = size * random.direction();
    const int form = random.index(5);
    const double skew = std::pow(10.0, random.number(-13.0, -1.0));
    if (form == 1) corner[2] = 0.5 * (corner[0] + corner[1]) + skew * size * random.direction();
    if (form >= 2)
        corner[1] = corner[0] + glm::dvec3(size, 0.0, 0.0) + (form == 2 ? 0.0 : skew * size) * random.direction();
    if (form == 4) corner[2] = corner[0] + glm::dvec3(0.0, 0.0, -size);
    Surface s;
    for (std::uint32_t k = 0; k < 3; ++k) {
        s.mesh.positions.emplace_back(corner[k]);
        s.mesh.indices.push_back(k);
    }
    return s;
}

Body round_or_box(RandomBodies& random) {
    const float r = static_cast<float>(random.number(0.05, 1)), h = static_cast<float>(random.number(0.0, 1));
    switch (random.index(5)) {
        case 0:
            return Body::ball(r).value();
        case 1:
            return Body::capsule(h, r).value();
        case 2:
            return Body::rounded(random.box(), 0.2f * r).value();
        default:
            return random.box();
    }
}

double size_of(const Body& a, const Body& b, const CasePair& place) {
    return a.reach() + b.reach() + b.radius() + glm::length(place.pose_b.translation - place.pose_a.translation);
}

// Calls check(random, surface, triangle) for `count` random triangles: as a mesh's surface, and as a body. Returns how
// many of them are meshes.
template <class Check>
int for_each_triangle(std::uint64_t seed, int count, const Check& check) {
    RandomBodies random(seed);
    int checked = 0;
    for (int i = 0; i < count; ++i) {
        const Surface s = one_triangle(random);
        const Result<mesh::MeshTree> tree = mesh::MeshTree::build(s.mesh);
        if (!tree) continue;
        CAPTURE(i);
        check(random, Body::mesh(*tree).value(), s.triangle(0));
        ++checked;
    }
    return checked;
}

}  // namespace

TEST_SUITE("convex/triangle_touch") {
    TEST_CASE("depth and gap are those of the certified queries, for any triangle, gap and place") {
        Manifolds found;
        int touching = 0, apart = 0;
        const auto check = [&](RandomBodies& random, const Body& surface, const Body& triangle) {
            const Body b = round_or_box(random);
            const double decade = std::pow(10.0, -random.number(0.3, 12.0));
            const double gap = (random.index(2) != 0 ? 1.0 : -1.0) * decade;
            const double offset = random.index(3) == 0 ? 1e7 : random.index(2) == 0 ? 1e3 : 0.0;
            const CasePair place = nearly_touching(random, triangle, b, gap, offset);
            const double margin = random.index(2) == 0 ? 0.0 : 0.05;
            contact_manifolds({surface, place.pose_a}, {b, place.pose_b}, {.margin = margin}, found);
            const Penetration deep = penetration({triangle, place.pose_a}, {b, place.pose_b});
            const Distance away = distance({triangle, place.pose_a}, {b, place.pose_b});
            const double tolerance = 2e-9 * size_of(triangle, b, place);
            if (deep.overlapping) {
                REQUIRE(found.all().size() == 1);
                const Manifold& m = found.all()[0];
                CHECK(m.depth >= deep.lower - tolerance);
                CHECK(m.depth <= deep.upper + tolerance);
                CHECK(glm::length(m.normal) == doctest::Approx(1.0).epsilon(1e-12));
                // No direction is less deep: moving along the normal parts them.
                RigidTransform moved = place.pose_b;
                moved.translation += (m.depth + 4.0 * tolerance) * m.normal;
                CHECK_FALSE(intersects({triangle, place.pose_a}, {b, moved}));
                ++touching;
            } else if (away.distance < margin - tolerance) {
                REQUIRE(found.all().size() == 1);
                CHECK(-found.all()[0].depth >= away.lower - tolerance);
                CHECK(-found.all()[0].depth <= away.upper + tolerance);
                ++apart;
            } else if (away.distance > margin + tolerance) {
                CHECK(found.all().empty());
            }
        };
        CHECK(for_each_triangle(71, 30000, check) > 20000);
        CHECK(touching > 8000);
        CHECK(apart > 4000);
    }

    TEST_CASE("the answers do not change with the rotation of the surface, which is rigid to 1e-6 alone") {
        Manifolds found;
        const auto check = [&](RandomBodies& random, const Body& surface, const Body& triangle) {
            const Body box = random.box();
            CasePair place = nearly_touching(random, triangle, box, -std::pow(10.0, -random.number(1.0, 5.0)), 0.0);
            for (int k = 0; k < 3; ++k) place.pose_b.rotation[k] += 2e-7 * random.direction();
            contact_manifolds({surface, place.pose_a}, {box, place.pose_b}, {}, found);
            const Penetration deep = penetration({triangle, place.pose_a}, {box, place.pose_b});
            if (!deep.overlapping) return;
            REQUIRE(found.all().size() == 1);
            const double tolerance = 2e-9 * size_of(triangle, box, place);
            CHECK(found.all()[0].depth >= deep.lower - tolerance);
            CHECK(found.all()[0].depth <= deep.upper + tolerance);
        };
        CHECK(for_each_triangle(72, 5000, check) > 3000);
    }

    TEST_CASE("points lie on both bodies up to half the depth, whatever the features") {
        Manifolds found;
        const auto check = [&](RandomBodies& random, const Body& surface, const Body& triangle) {
            const Body b = round_or_box(random);
            const CasePair place = nearly_touching(random, triangle, b, -1e-3, 0.0);
            contact_manifolds({surface, place.pose_a}, {b, place.pose_b}, {.margin = 0.01}, found);
            // The plane of a sliver is uncertain.
            const double tolerance = 1e-7 * size_of(triangle, b, place);
            for (const Manifold& m : found.all())
                for (int k = 0; k < m.count; ++k) {
                    const glm::dvec3 &p = m.points[k].position, half = 0.5 * m.points[k].depth * m.normal;
                    CHECK(closest_point({triangle, place.pose_a}, p + half).distance < tolerance);
                    CHECK(closest_point({b, place.pose_b}, p - half).distance < tolerance);
                }
        };
        CHECK(for_each_triangle(73, 5000, check) > 3000);
    }
}
