// SPDX-License-Identifier: MIT
// Contact points and deepest points are on both shapes, whatever the shapes' forms.
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <map>
#include <optional>

#include "contact_ids.hpp"
#include "random_shapes.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

// How far a point is from the surface, outside or inside.
double off_surface(const ShapeAtPose& shape, const glm::dvec3& point) {
    static const Shape kPoint = Shape::sphere(0.0f).value();
    const double outside = closest_point(shape, point).distance;
    return outside > 0.0 ? outside : penetration(shape, {kPoint, at(point)}).depth;
}

// How far the ends of a contact point are from the surfaces.
double off_shapes(const ShapeAtPose& a, const ShapeAtPose& b, const Manifold& m, int i) {
    const ContactPoint& p = m.points[i];
    const glm::dvec3 half = 0.5 * p.depth * m.normal;
    return std::max(off_surface(a, p.position + half), off_surface(b, p.position - half));
}

// A vertex of a box or triangle is where its contact is; an edge or face of a box has the point on it.
double off_feature(const Shape& shape, const RigidTransform& pose, const Feature& feature,
                   const glm::dvec3& on_surface) {
    const glm::dvec3 p = glm::inverse(pose.rotation) * (on_surface - pose.translation);
    if (feature.kind == FeatureKind::vertex && shape.is_polytope())
        return glm::distance(p, shape.vertex(feature.index));
    if (shape.kind() != Kind::box || shape.radius() > 0.0) return 0.0;
    const glm::dvec3& half = shape.half_extents();
    if (feature.kind == FeatureKind::face) return std::abs(std::abs(p[feature.index / 2]) - half[feature.index / 2]);
    const int u = (feature.index / 4 + 1) % 3, v = (feature.index / 4 + 2) % 3;
    return std::max(std::abs(std::abs(p[u]) - half[u]), std::abs(std::abs(p[v]) - half[v]));
}

void check_points(const ShapeAtPose& a, const ShapeAtPose& b, const Manifold& m, double tolerance) {
    CHECK(ids(m).size() == static_cast<std::size_t>(m.count));
    double deepest = -HUGE_VAL;
    for (int i = 0; i < m.count; ++i) {
        const ContactPoint& p = m.points[i];
        const glm::dvec3 half = 0.5 * p.depth * m.normal;
        CHECK(off_shapes(a, b, m, i) <= tolerance);
        CHECK(off_feature(a.shape, a.pose, p.on_a, p.position + half) <= tolerance);
        CHECK(off_feature(b.shape, b.pose, p.on_b, p.position - half) <= tolerance);
        deepest = std::max(deepest, p.depth);
    }
    CHECK(deepest == m.depth);
    CHECK(std::abs(glm::length(m.normal) - 1.0) <= 1e-12);
    const Penetration deep = penetration(a, b);
    const double depth = deep.overlapping ? deep.depth : -distance(a, b).distance;
    CHECK(std::abs(m.depth - depth) <= tolerance);
}

// A cone, a prism or a frustum around the y axis whose first vertices come again at the end, `gap` away.
Hull turned_hull(int form, int sides, double gap) {
    std::vector<glm::vec3> points;
    for (int i = 0; i <= sides; ++i)
        for (const double y : {-0.5, 0.5}) {
            if (form == 0 && y > 0.0) continue;
            const double angle = 2.0 * M_PI * i / sides, radius = form == 2 && y > 0.0 ? 0.5 : 1.0;
            const double z = i < sides ? radius * std::sin(angle) : -gap;
            points.emplace_back(static_cast<float>(radius * std::cos(angle)), static_cast<float>(y),
                                static_cast<float>(z));
        }
    if (form == 0) points.emplace_back(0.0f, 0.5f, 0.0f);
    return Hull::build(points).value();
}

Shape thin_box(RandomShapes& random, int zeros) {
    glm::vec3 half(glm::dvec3(random.number(0.1, 1), random.number(0.1, 1), random.number(0.1, 1)));
    const int first = random.index(3);
    for (int k = 0; k < zeros; ++k) half[(first + k) % 3] = 0.0f;
    return Shape::box(half).value();
}

Shape round_or_flat(RandomShapes& random) {
    const float r = static_cast<float>(random.number(0.1, 0.7)), h = static_cast<float>(random.number(0.0, 1));
    switch (random.index(9)) {
        case 0:
            return Shape::sphere(r).value();
        case 1:
            return Shape::capsule(h, r).value();
        case 2:
            return Shape::cylinder(h, r).value();
        case 3:
            return Shape::rounded(random.box(), 0.4f * r).value();
        case 4:
            return Shape::triangle(glm::vec3(random.direction()), glm::vec3(random.direction()),
                                   glm::vec3(random.direction()))
                .value();
        case 5:
            return Shape::capsule(0.0f, r).value();
        case 6:
            return Shape::cylinder(random.index(2) != 0 ? h : 0.0f, random.index(2) != 0 ? 0.0f : r).value();
        case 7:
            return thin_box(random, random.index(4));
        default:
            return random.box();
    }
}

}  // namespace

TEST_SUITE("convex/points_on_shapes") {
    TEST_CASE("a hull whose seam vertices stand twice, or nearly, has its points on both shapes") {
        RandomShapes random(41);
        int manifolds = 0;
        for (int round = 0; round < 60; ++round) {
            const double gap = round % 3 == 0 ? 2.449e-16 : std::pow(10.0, -random.number(1.0, 17.0));
            const Hull hull = turned_hull(round % 3, std::array{4, 5, 8, 16}[static_cast<std::size_t>(round % 4)], gap),
                       second = turned_hull((round + 1) % 3, 4, gap);
            // A face may be uneven by 1e-5 of the size (HullOptions).
            const double tolerance = 4e-5;
            for (int i = 0; i < 150; ++i) {
                CAPTURE(round);
                CAPTURE(i);
                const Shape a = i % 7 == 0 ? Shape::rounded(Shape::hull(hull), 0.1f).value() : Shape::hull(hull);
                const Shape b = i % 5 == 0   ? Shape::hull(second)
                                : i % 5 == 1 ? Shape::capsule(0.5f, 0.2f).value()
                                             : random.box();
                const RigidTransform pose_a{random.rotation(), {}},
                    pose_b{random.rotation(), random.number(0.0, 1.8) * random.direction()};
                const ShapeAtPose pa{a, pose_a}, pb{b, pose_b};
                const Manifold m = contact_manifold(pa, pb, {.max_points = 8}),
                               back = contact_manifold(pb, pa, {.margin = 0.1});
                if (m.count > 0) check_points(pa, pb, m, tolerance);
                if (back.count > 0) check_points(pb, pa, back, tolerance);
                manifolds += m.count > 0 ? 1 : 0;
            }
        }
        CHECK(manifolds > 3000);
    }

    TEST_CASE("the points of a cone whose seam vertex stands twice are those of the cone that has it once") {
        const RigidTransform pose_a{glm::dmat3(0x1.47314b743efe7p-1, -0x1.4454cb3816e01p-1, -0x1.bec22c21b3cep-2,
                                               -0x1.1b3f5be60a2f9p-1, -0x1.8b948e64153d5p-1, 0x1.3ef1498636804p-2,
                                               -0x1.119af810453a4p-1, 0x1.5aae675e45431p-5, -0x1.b03877edec095p-1),
                                    {}};
        const RigidTransform pose_b{glm::dmat3(-0x1.c2ce70e5e0cefp-5, 0x1.fd65c077cf8d9p-1, 0x1.596d2cf09e118p-4,
                                               -0x1.f9c78baecd52bp-1, -0x1.108fcb7003423p-4, 0x1.1f9ed217dd01cp-3,
                                               0x1.29a6bd01eb7f8p-3, -0x1.3592fd20318d4p-4, 0x1.f9155ceb08a78p-1),
                                    {-0x1.a6fa56678e99p-4, -0x1.7a1121ed74ddep-1, 0x1.4dd10a87c8444p-2}};
        const Shape box = Shape::box({0x1.0c7042p-1f, 0x1.3bb962p-1f, 0x1.d9bce8p-1f}).value();
        const Hull cone = turned_hull(0, 4, 2.449e-16);
        const Shape shape = Shape::hull(cone);
        const Manifold m = contact_manifold({shape, pose_a}, {box, pose_b});
        check_points({shape, pose_a}, {box, pose_b}, m, 1e-9);
        const auto deepest =
            std::max_element(m.points, m.points + m.count,
                             [](const ContactPoint& p, const ContactPoint& q) { return p.depth < q.depth; });
        CHECK(glm::distance(deepest->position, glm::dvec3(-0.281529, -0.297363, 0.163273)) <= 1e-6);
    }

    TEST_CASE("boxes without width, length or height, against round shapes and flat ones, have points on both") {
        RandomShapes random(42);
        int manifolds = 0;
        for (int i = 0; i < 40000; ++i) {
            CAPTURE(i);
            const Shape a = thin_box(random, i % 4), b = round_or_flat(random);
            const RigidTransform pose_a{random.rotation(), {}},
                pose_b{random.rotation(), random.number(0.0, 2.2) * random.direction()};
            const ShapeAtPose pa{a, pose_a}, pb{b, pose_b};
            const double margin = std::array{0.0, 0.1, 1.0}[static_cast<std::size_t>(i / 4 % 3)];
            const Manifold m = i % 2 == 0 ? contact_manifold(pa, pb, {.margin = margin, .max_points = 8})
                                          : contact_manifold(pb, pa, {.margin = margin});
            if (m.count == 0) continue;
            ++manifolds;
            for (int k = 0; k < m.count; ++k)
                CHECK(off_shapes(i % 2 == 0 ? pa : pb, i % 2 == 0 ? pb : pa, m, k) <= 1e-4);
        }
        CHECK(manifolds > 15000);
    }

    TEST_CASE("the points of rounded shapes that are tilted are on the surfaces, not inside") {
        RandomShapes random(44);
        std::map<std::pair<Kind, Kind>, int> tilted;
        for (int i = 0; i < 30000; ++i) {
            CAPTURE(i);
            const auto rounded = [&](const Shape& core) {
                return Shape::rounded(core, static_cast<float>(random.number(0.05, 0.5))).value();
            };
            const Shape round[] = {rounded(random.box()), rounded(random.hull(10)), rounded(random.polytope(4)),
                                   Shape::capsule(0.8f, 0.3f).value(), rounded(Shape::cylinder(0.4f, 0.3f).value())};
            const Shape a = round[i % 5], b = i % 3 == 0   ? round[random.index(5)]
                                              : i % 3 == 1 ? random.polytope(12)
                                                           : Shape::half_space({{0, 1, 0}, -0.3}).value();
            const RigidTransform pose_a{random.rotation(), {}},
                pose_b{random.rotation(), random.number(0.3, 2.0) * random.direction()};
            const ShapeAtPose pa{a, pose_a}, pb{b, pose_b};
            const bool back = i % 2 == 0;
            const Manifold m =
                contact_manifold(back ? pb : pa, back ? pa : pb, {.margin = i % 4 < 2 ? 0.0 : 0.1, .max_points = 8});
            for (int k = 0; k < m.count; ++k) {
                CHECK(m.points[k].depth <= m.depth);
                // Round sides within 2 degrees have points midway between them; a hull's faces are flat to 1e-5.
                const bool sides = !a.is_polytope() && !b.is_polytope() && b.is_bounded();
                CHECK(off_shapes(back ? pb : pa, back ? pa : pb, m, k) <= (sides ? 1e-3 : 4e-5));
                tilted[{a.kind(), b.kind()}] += m.points[k].depth < m.depth - 1e-3;
            }
        }
        for (const Kind kind : {Kind::box, Kind::hull, Kind::capsule, Kind::cylinder})
            for (const Kind other : {Kind::box, Kind::hull, Kind::half_space}) CHECK(tilted[{kind, other}] > 100);
    }

    TEST_CASE("the points of tilted round shapes on a triangle of a mesh are on its surface and theirs") {
        RandomShapes random(45);
        int points = 0;
        Manifolds found;
        for (int i = 0; i < 6000; ++i) {
            CAPTURE(i);
            const TriangleMesh mesh{
                .positions = {{-2, 0, -2}, {-2, 0, 2}, {2, 0, 0}}, .indices = {0, 1, 2}, .colors = {}};
            const mesh::MeshTree tree = mesh::MeshTree::build(mesh).value();
            const Shape floor = Shape::mesh(tree).value();
            const Shape a =
                i % 2 == 0 ? Shape::capsule(0.8f, 0.3f).value() : Shape::rounded(random.box(), 0.2f).value();
            const RigidTransform pose{random.rotation(),
                                      {random.number(-1, 1), random.number(0, 1), random.number(-1, 1)}};
            const ShapeAtPose pa{a, pose}, pb{floor, at({})};
            contact_manifolds(pa, pb, {.margin = i % 4 < 2 ? 0.0 : 0.1}, found);
            if (found.all().size() != 1) continue;
            const Manifold& m = found.all()[0];
            for (int k = 0; k < m.count; ++k) {
                CHECK(off_shapes(pa, pb, m, k) <= 1e-6);
                points += m.points[k].depth < m.depth - 1e-3;
            }
        }
        CHECK(points > 500);
    }

    TEST_CASE("a bar without width that lies on a shape has a point at either end of their common stretch") {
        const Shape needle = Shape::box({1, 0, 0}).value(), slab = Shape::box({0.5f, 0.25f, 2}).value(),
                    capsule = Shape::capsule(0.5f, 0.25f).value();
        RigidTransform lying = at({0, 0, 0});
        lying.rotation = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
        const RigidTransform above = at({0.2, 0.24, 0});
        for (const ShapeAtPose& below : {ShapeAtPose{slab, at({})}, ShapeAtPose{capsule, lying}}) {
            const Manifold m = contact_manifold(below, {needle, above});
            REQUIRE(m.count == 2);
            for (int i = 0; i < 2; ++i) {
                CHECK(m.points[i].depth == doctest::Approx(0.01));
                CHECK(std::abs(m.points[i].position.x) == doctest::Approx(0.5));
                CHECK(m.points[i].position.y == doctest::Approx(0.245));
                CHECK(m.points[i].position.z == doctest::Approx(0.0));
            }
        }
    }

    TEST_CASE("deepest points are on both shapes, even if one is 10^6 times as large") {
        RandomShapes random(43);
        int overlapping = 0;
        for (int i = 0; i < 4000; ++i) {
            CAPTURE(i);
            const double large = std::pow(10.0, random.number(0.0, 6.0));
            const glm::vec3 corners[] = {glm::vec3(large * random.direction()), glm::vec3(large * random.direction()),
                                         glm::vec3(large * random.direction())};
            const Shape big =
                i % 3 == 0 ? random.polytope(12, large) : Shape::triangle(corners[0], corners[1], corners[2]).value();
            const Shape small = i % 5 == 0 ? Shape::rounded(random.box(0.1), 0.05f).value() : random.polytope(12, 0.2);
            const CasePair place = nearly_touching(random, big, small, -std::pow(10.0, random.number(-6, -1)), 0.0);
            const ShapeAtPose pa{big, place.pose_a}, pb{small, place.pose_b};
            for (const bool first : {true, false}) {
                const ShapeAtPose &a = first ? pa : pb, &b = first ? pb : pa;
                const Penetration p = penetration(a, b);
                CHECK(p.overlapping == intersects(a, b));
                if (!p.overlapping) continue;
                const double size = a.shape.core_radius() + b.shape.core_radius() +
                                    glm::distance(a.pose.translation, b.pose.translation) + 0.1;
                CHECK(off_surface(a, p.on_a) <= 1e-9 * size);
                CHECK(off_surface(b, p.on_b) <= 1e-9 * size);
                CHECK(glm::distance(p.on_a - p.on_b, p.depth * p.normal) <= 1e-12 * size);
                ++overlapping;
            }
        }
        CHECK(overlapping > 4000);
    }
}
