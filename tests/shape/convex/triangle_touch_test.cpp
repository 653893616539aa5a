// SPDX-License-Identifier: MIT
// Boxes, spheres and capsules against one triangle of a surface, in closed form: against the certified bounds of
// `penetration` and `distance`.
#include <doctest/doctest.h>
#include <optional>
#include <oracle/edges.hpp>

#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

Surface triangle_of(const glm::dvec3 (&corner)[3]) {
    Surface s;
    for (std::uint32_t k = 0; k < 3; ++k) {
        s.mesh.positions.emplace_back(corner[k]);
        s.mesh.indices.push_back(k);
    }
    return s;
}

// A triangle of any form: also a sliver, a tiny one, and one with edges along or nearly along the axes.
Surface one_triangle(RandomShapes& random) {
    const double size = std::pow(10.0, random.number(-3.0, 1.0));
    glm::dvec3 corner[3];
    for (glm::dvec3& p : corner) p = size * random.direction();
    const int form = random.index(5);
    const double skew = std::pow(10.0, random.number(-13.0, -1.0));
    if (form == 1) corner[2] = 0.5 * (corner[0] + corner[1]) + skew * size * random.direction();
    if (form >= 2)
        corner[1] = corner[0] + glm::dvec3(size, 0.0, 0.0) + (form == 2 ? 0.0 : skew * size) * random.direction();
    if (form == 4) corner[2] = corner[0] + glm::dvec3(0.0, 0.0, -size);
    return triangle_of(corner);
}

Shape round_or_box(RandomShapes& random) {
    const float r = static_cast<float>(random.number(0.05, 1)), h = static_cast<float>(random.number(0.0, 1));
    switch (random.index(5)) {
        case 0:
            return Shape::sphere(r).value();
        case 1:
            return Shape::capsule(h, r).value();
        case 2:
            return Shape::rounded(random.box(), 0.2f * r).value();
        default:
            return random.box();
    }
}

double size_of(const Shape& a, const Shape& b, const CasePair& place) {
    return a.core_radius() + b.core_radius() + b.radius() +
           glm::length(place.pose_b.translation - place.pose_a.translation);
}

// Calls check(random, surface, triangle) for `count` random triangles: as a mesh's surface, and as a shape. Returns how
// many of them are meshes.
template <class Check>
int for_each_triangle(std::uint64_t seed, int count, const Check& check) {
    RandomShapes random(seed);
    int checked = 0;
    for (int i = 0; i < count; ++i) {
        const Surface s = one_triangle(random);
        const Result<mesh::MeshTree> tree = mesh::MeshTree::build(s.mesh);
        if (!tree) continue;
        CAPTURE(i);
        check(random, Shape::mesh(*tree).value(), s.triangle(0));
        ++checked;
    }
    return checked;
}

// Poses of b along a direction, as close as numbers are: at one it meets a, at the next not.
struct Brink {
    RigidTransform meet, apart;
};
std::optional<Brink> brink(const ShapeAtPose& a, const Shape& b, const RigidTransform& about,
                           const glm::dvec3& direction) {
    const auto moved = [&](double t) { return RigidTransform{about.rotation, about.translation + t * direction}; };
    const auto meets = [&](double t) { return intersects(a, {b, moved(t)}); };
    if (!meets(-1e-9) || meets(1e-9)) return std::nullopt;
    const auto [in, out] = oracle::edge_between(-1e-9, 1e-9, meets);
    return Brink{moved(in), moved(out)};
}

}  // namespace

TEST_SUITE("convex/triangle_touch") {
    TEST_CASE("depth and gap are those of the certified queries, for any triangle, gap and place") {
        Manifolds found;
        int touching = 0, apart = 0;
        const auto check = [&](RandomShapes& random, const Shape& surface, const Shape& triangle) {
            const Shape b = round_or_box(random);
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
        const auto check = [&](RandomShapes& random, const Shape& surface, const Shape& triangle) {
            const Shape box = random.box();
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

    // The rounded normal of a sliver is not quite across its edges. Its corners differ along it by up to 1e-10 of the
    // size.
    TEST_CASE("a box's corner on a sliver has a point iff they meet, to the last bit") {
        RandomShapes random(74);
        Manifolds found;
        int tried = 0;
        for (int i = 0; i < 1500; ++i) {
            glm::dvec3 corner[3] = {random.direction(), random.direction(), {}};
            const double width = std::pow(10.0, random.number(-4.5, -3.0));
            corner[2] = glm::mix(corner[0], corner[1], random.number(0.0, 1.0)) + width * random.direction();
            Surface s = triangle_of(corner);
            s.build();
            const Shape surface = s.shape(), box = random.box();
            const RigidTransform at{random.rotation(), {}}, turned{random.rotation(), {}};
            const auto place = [&](std::uint32_t k) { return at.rotation * glm::dvec3(s.mesh.positions[k]); };
            const glm::dvec3 u = place(1) - place(0), v = place(2) - place(0), n = glm::normalize(glm::cross(u, v));
            const double share = random.number(0.0, 1.0), rest = random.number(0.0, 1.0 - share);
            const glm::dvec3 own = convex::support_point(box, glm::transpose(turned.rotation) * -n);
            const RigidTransform about{turned.rotation, place(0) + share * u + rest * v - turned.rotation * own};
            const std::optional<Brink> poses = brink({surface, at}, box, about, n);
            if (!poses) continue;
            CAPTURE(i);
            contact_manifolds({surface, at}, {box, poses->meet}, {}, found);
            CHECK(found.all().size() == 1);
            contact_manifolds({surface, at}, {box, poses->apart}, {}, found);
            CHECK(found.all().empty());
            ++tried;
        }
        CHECK(tried > 1200);
    }

    // Where a sliver's rounded normal leans by as much as the sliver is wide, its face parts nothing.
    TEST_CASE("a box's corner just above the middle of a thin sliver has no point") {
        RandomShapes random(76);
        Manifolds found;
        for (int i = 0; i < 3000; ++i) {
            const double width = std::pow(10.0, random.number(-8.5, -7.0));
            Surface s = triangle_of({{-1, 0, 0}, {1, 0, 0}, {random.number(-0.9, 0.9), width, 0}});
            s.build();
            const Shape surface = s.shape(), box = random.box();
            const RigidTransform at{random.rotation(), {}}, turned{random.rotation(), {}};
            const double height = random.number(0.01, 0.15) * width;
            const glm::dvec3 up = at.rotation[2], middle = glm::dvec3(s.mesh.positions[2]) / 3.0,
                             own = convex::support_point(box, glm::transpose(turned.rotation) * -up);
            const RigidTransform above{turned.rotation, at.rotation * middle - turned.rotation * own + height * up};
            if (intersects({surface, at}, {box, above})) continue;
            CAPTURE(i);
            contact_manifolds({surface, at}, {box, above}, {}, found);
            CHECK(found.all().empty());
        }
    }

    // The axis across edges so nearly parallel is not asked: its neighbours look up to 1e-10 of the size deeper.
    TEST_CASE("a box above a triangle's edge, nearly parallel to its own, has points iff they meet") {
        RandomShapes random(75);
        Manifolds found;
        Surface s;
        s.mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0.25f}};
        s.mesh.indices = {0, 1, 2};
        s.build();
        const Shape surface = s.shape(), box = Shape::box({1.0f, 0.5f, 0.5f}).value();
        for (int i = 0; i < 400; ++i) {
            const double angle = std::pow(10.0, random.number(-12.0, -9.0)), slope = random.number(0.2, 1.3);
            const glm::dmat3 turned =
                glm::mat3_cast(glm::angleAxis(angle, glm::dvec3(0, 1, 0)) * glm::angleAxis(slope, glm::dvec3(1, 0, 0)));
            glm::dvec3 own = convex::support_point(box, glm::transpose(turned) * glm::dvec3(0, -1, 0));
            own.x = random.number(-0.5, 0.5);
            const glm::dvec3 touch(random.number(-0.5, 0.5), 0, 0), up(0, 1, 0);
            const std::optional<Brink> poses = brink({surface, at({})}, box, {turned, touch - turned * own}, up);
            REQUIRE(poses.has_value());
            CAPTURE(i);
            for (const double height : {0.0, 1e-12, 1e-11}) {
                const RigidTransform below{turned, poses->meet.translation - height * up},
                    above{turned, poses->apart.translation + height * up};
                contact_manifolds({surface, at({})}, {box, below}, {}, found);
                CHECK_FALSE(found.all().empty());
                contact_manifolds({surface, at({})}, {box, above}, {}, found);
                CHECK(found.all().empty());
            }
        }
    }

    TEST_CASE("points lie on both shapes up to half the depth, whatever the features") {
        Manifolds found;
        const auto check = [&](RandomShapes& random, const Shape& surface, const Shape& triangle) {
            const Shape b = round_or_box(random);
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
