// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <vector>

#include "flat_floors.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

RigidTransform turned(double angle, const glm::dvec3& p) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {glm::dmat3(c, 0, -s, 0, 1, 0, s, 0, c), p};
}

// Winds some triangles the other way, none, or all.
void turn_some_over(RandomShapes& random, Surface& s) {
    const int one_in = std::array{1, 2, 5, 1 << 30}[static_cast<std::size_t>(random.index(4))];
    for (std::size_t t = 0; t < s.mesh.indices.size(); t += 3)
        if (random.index(one_in) == 0) std::swap(s.mesh.indices[t], s.mesh.indices[t + 1]);
    s.build();
}

// Which triangles of a surface a ball touches by the rule for inner edges, told one by one.
struct BallContact {
    std::uint32_t triangle;
    double depth;
    glm::dvec3 normal, position;
};
glm::dvec3 nearest_on_triangle(const std::array<glm::dvec3, 3>& t, const glm::dvec3& q) {
    const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    bool inside = true;
    glm::dvec3 best(0.0);
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &p = t[k], edge = t[(k + 1) % 3] - p;
        inside = inside && glm::dot(glm::cross(edge, q - p), n) >= 0.0;
        const glm::dvec3 on = p + std::clamp(glm::dot(q - p, edge) / glm::dot(edge, edge), 0.0, 1.0) * edge;
        if (glm::distance(on, q) < least) least = glm::distance(on, q), best = on;
    }
    return inside ? q - glm::dot(q - t[0], n) / glm::dot(n, n) * n : best;
}
// Nothing where an angle or a distance is too close to a limit to say.
std::optional<std::vector<BallContact>> ball_contacts(const Surface& s, const glm::dvec3& center, double radius,
                                                      double margin) {
    const auto corners = [&](std::size_t i) {
        const Shape t = s.triangle(i);
        return std::array<glm::dvec3, 3>{t.vertex(0), t.vertex(1), t.vertex(2)};
    };
    bool is_close = false;
    const auto exceeds = [&](double value, double limit) {
        is_close = is_close || std::abs(value - limit) <= 1e-6 * limit;
        return value > limit;
    };
    std::vector<BallContact> result;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const auto own = corners(i);
        const glm::dvec3 on = nearest_on_triangle(own, center), way = center - on;
        const double distance = glm::length(way);
        if (exceeds(distance, radius + margin)) continue;
        if (distance < 1e-4 * radius || std::abs(distance - radius) < 1e-4 * radius) return std::nullopt;
        const glm::dvec3 n = way / distance, face = glm::normalize(glm::cross(own[1] - own[0], own[2] - own[0]));
        if (glm::dot(n, face) <= 1e-6) return std::nullopt;  // from behind
        // Whether `to` is above `from` by more than the angle that counts as flat.
        const auto is_above = [&](const glm::dvec3& to, const glm::dvec3& from) {
            return to != from && exceeds(glm::dot(n, to - from) / glm::distance(to, from), 1e-3);
        };
        bool valid = !exceeds(glm::length(glm::cross(n, face)), 1e-3);
        if (!valid) {
            auto falling = own;
            std::sort(falling.begin(), falling.end(),
                      [&](const glm::dvec3& p, const glm::dvec3& q) { return glm::dot(n, p - q) > 0.0; });
            std::vector<glm::dvec3> stand;
            for (const glm::dvec3& p : falling)
                if (std::none_of(stand.begin(), stand.end(), [&](const glm::dvec3& q) { return is_above(q, p); }))
                    stand.push_back(p);
            valid = true;
            for (std::size_t j = 0; j < s.size() && stand.size() < 3; ++j) {
                const auto other = corners(j);
                const bool shares = std::all_of(stand.begin(), stand.end(), [&](const glm::dvec3& p) {
                    return std::find(other.begin(), other.end(), p) != other.end();
                });
                for (const glm::dvec3& p : other)
                    for (const glm::dvec3& q : stand) valid = valid && !(shares && is_above(p, q));
            }
        }
        const double depth = radius - distance;
        if (valid) result.push_back({static_cast<std::uint32_t>(i), depth, n, on - 0.5 * depth * n});
    }
    if (is_close) return std::nullopt;
    return result;
}

}  // namespace

TEST_SUITE("convex/surface_contact") {
    TEST_CASE("triangles that share nothing have the manifolds of single triangles") {
        RandomShapes random(1);
        int touching = 0;
        Manifolds found;
        for (int round = 0; round < 200; ++round) {
            const Surface s = soup(random, 60, 2.0, 0.5);
            const Shape b = any_shape(random, 0.7), shape = s.shape();
            const RigidTransform pose{random.rotation(), {}}, pose_b{random.rotation(), random.direction()};
            const ManifoldOptions options{.margin = 0.05, .max_points = 8};
            double deepest = -1.0;
            std::set<std::uint32_t> touched;
            for (std::size_t t = 0; t < s.size(); ++t) {
                const Manifold m = contact_manifold({s.triangle(t), pose}, {b, pose_b}, options);
                if (m.count == 0) continue;
                deepest = std::max(deepest, m.depth);
                touched.insert(static_cast<std::uint32_t>(t));
            }
            contact_manifolds({shape, pose}, {b, pose_b}, options, found);
            double told = -1.0;
            std::set<std::uint32_t> parts;
            for (const Manifold& m : found.all()) {
                told = std::max(told, m.depth);
                CHECK(glm::length(m.normal) == doctest::Approx(1.0));
                for (int i = 0; i < m.count; ++i) parts.insert(m.points[i].part_a.triangle);
            }
            CHECK(told == doctest::Approx(deepest));
            // Where the normals of parts agree, the points that matter are kept.
            CHECK(std::includes(touched.begin(), touched.end(), parts.begin(), parts.end()));
            if (found.all().size() == touched.size()) CHECK(parts == touched);
            touching += touched.empty() ? 0 : 1;
            contact_manifolds({b, pose_b}, {shape, pose}, options, found);
            double reversed = -1.0;
            for (const Manifold& m : found.all()) reversed = std::max(reversed, m.depth);
            CHECK(reversed == doctest::Approx(deepest));
        }
        CHECK(touching > 100);
    }

    TEST_CASE("a polytope has contact points iff it meets a surface, also where edges and vertices are shared") {
        RandomShapes random(8);
        int meeting = 0, apart = 0;
        for (int round = 0; round < 100; ++round) {
            const Surface s = tangle(random, 6, 4);
            const Shape shape = s.shape();
            for (int i = 0; i < 200; ++i) {
                const Shape b = random.polytope(12, 0.3);
                const RigidTransform pose{random.rotation(), (i % 3 == 0 ? 1e3 : 0.0) * random.direction()};
                const double gap = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, -random.number(4, 14));
                const RigidTransform pose_b = next_to(random, s, pose, b, gap);
                const bool truth = intersects({shape, pose}, {b, pose_b});
                CHECK((contact_manifold({shape, pose}, {b, pose_b}).count > 0) == truth);
                CHECK((contact_manifold({b, pose_b}, {shape, pose}).count > 0) == truth);
                (truth ? meeting : apart) += 1;
            }
        }
        CHECK(meeting > 3000);
        CHECK(apart > 3000);
    }

    TEST_CASE("shapes that slide over a triangulated floor meet no inner edge, whatever the floor's place") {
        RandomShapes random(2);
        const Shape shapes[] = {Shape::box({0.5f, 0.5f, 0.5f}).value(),
                                Shape::box({0.05f, 0.5f, 0.05f}).value(),
                                Shape::box({3.0f, 0.5f, 2.0f}).value(),
                                Shape::sphere(0.5f).value(),
                                Shape::capsule(0.2f, 0.3f).value(),
                                Shape::cylinder(0.5f, 0.4f).value(),
                                Shape::rounded(Shape::box({0.3f, 0.4f, 0.3f}).value(), 0.1f).value()};
        Manifolds found;
        for (const double offset : {0.0, 1e6}) {
            const Surface s = ground(random, 24, 0.5, [](double, double) { return 0.0; });
            for (const Sides sides : {Sides::front, Sides::both}) {
                const Shape floor = s.shape(sides);
                const RigidTransform place = at(offset * glm::dvec3(1.0, 0.5, -0.3));
                for (int i = 0; i < 2000; ++i) {
                    const Shape& b = shapes[i % 7];
                    const double depth = std::pow(10.0, -random.number(1.4, 6.0));
                    const RigidTransform pose =
                        turned(random.number(0, 6.2),
                               place.translation + glm::dvec3(random.number(-2, 2), 0.5 - depth, random.number(-2, 2)));
                    contact_manifolds({floor, place}, {b, pose}, {.margin = 0.01}, found);
                    REQUIRE(found.all().size() == 1);
                    const Manifold& m = found.all()[0];
                    CHECK(m.normal.y >= 1.0 - 1e-9);
                    CHECK(m.depth == doctest::Approx(depth).epsilon(1e-3));
                    CHECK(m.count <= 4);
                    if (b.kind() == Kind::box) CHECK(m.count >= 3);
                }
            }
        }
    }

    TEST_CASE("normals over flat and ridged meshes and fields are those of the surface, on a seam or near it") {
        RandomShapes random(9600);
        const Sliders sliders(random);
        Manifolds found;
        int touching = 0;
        for (int round = 0; round < 240; ++round) {
            const double slope = round % 3 == 2 ? -std::pow(10.0, random.number(-1.3, 1.3)) : 0.0;  // right of x = 0
            const auto height = [&](double x, double) { return std::min(0.0, slope * x); };
            Surface s = ground(random, 16, 0.5, height, slope == 0.0 ? random.index(2) * 0.25 : 0.0);
            std::vector<float> heights;
            for (int i = 0; i < 17 * 17; ++i) heights.push_back(static_cast<float>(height(0.5 * (i % 17) - 4.0, 0.0)));
            const HeightField field =
                HeightField::build({.columns = 17, .rows = 17, .heights = heights, .spacing = {0.5, 0.5}}).value();
            const Sides sides = random.index(2) == 0 ? Sides::front : Sides::both;
            const bool is_field = round % 2 == 0;
            if (!is_field && sides == Sides::both) turn_some_over(random, s);
            const Shape floor = is_field ? Shape::height_field(field, sides) : s.shape(sides);
            const glm::dmat3 tilt = random.index(3) == 0 ? glm::dmat3(1.0) : random.rotation();
            const glm::dvec3 direction = random.direction();
            const RigidTransform frame{tilt, std::exp2(random.number(0.0, 8.0)) * direction};
            const RigidTransform place = is_field ? placed_in(frame, at({-4, 0, -4})) : frame;
            for (int i = 0; i < 220; ++i) {
                const Shape& shape = sliders.shapes[static_cast<std::size_t>(i % 11)];
                const bool lattice = random.index(3) == 0;
                const glm::dmat3 turn = random.index(2) == 0 ? around_y(random.number(0, 6)) : random.rotation();
                const double depth =
                    std::array{0.001, 0.005, 0.02, 0.0, 1e-9}[static_cast<std::size_t>(random.index(5))];
                const double z = random.number(-2, 2), x = random.number(-1, 1);
                glm::dvec3 at_x((slope < 0.0 ? 0.5 : 2.0) * x, 0.0, z);
                if (lattice) at_x = glm::round(at_x * 4.0) / 4.0;
                at_x.y = below(shape, turn) - depth;
                const RigidTransform pose = placed_in(frame, {turn, at_x});
                const bool shape_first = random.index(2) == 0;
                if (shape_first)
                    contact_manifolds({shape, pose}, {floor, place}, {}, found);
                else
                    contact_manifolds({floor, place}, {shape, pose}, {}, found);
                CAPTURE(round);
                CAPTURE(i);
                CAPTURE(depth);
                if (intersects({shape, pose}, {floor, place})) {
                    ++touching;
                    CHECK(!found.all().empty());
                }
                for (const Manifold& m : found.all()) {
                    const glm::dvec3 n = glm::transpose(frame.rotation) * (shape_first ? -m.normal : m.normal);
                    // Between the normals of the two faces.
                    CHECK(n.y > 0.0);
                    CHECK(std::abs(n.z) < 2e-3);
                    CHECK(n.x > -2e-3);
                    CHECK(n.x < -slope * n.y + 2e-3);
                    for (int k = 0; k < m.count; ++k) {
                        const ContactPoint& p = m.points[k];
                        if (slope == 0.0) CHECK(p.depth <= depth + 1e-6);
                        if (i % 4 != 0) continue;
                        CHECK(closest_point({shape, pose}, p.position).distance <= 0.5 * p.depth + 1e-5);
                        CHECK(closest_point({floor, place}, p.position).distance <= 0.5 * p.depth + 1e-5);
                    }
                }
            }
        }
        CHECK(touching > 40000);
    }

    TEST_CASE(
        "a shape along a large triangle has an equally deep point at either end, from the front and from behind") {
        Surface s;
        s.mesh.positions = {{-9, 0, -9}, {0, 0, 9}, {9, 0, -9}};
        s.mesh.indices = {0, 1, 2};
        s.build();
        const Shape surface = s.shape(), capsule = Shape::capsule(0.75f, 0.25f).value(),
                    cylinder = Shape::cylinder(0.75f, 0.25f).value();
        const RigidTransform still = at({});
        Manifolds found;
        for (const Shape* shape : {&capsule, &cylinder})
            for (const double side : {1.0, -1.0}) {
                CAPTURE(static_cast<int>(shape->kind()));
                RigidTransform pose = at({0.5, side * 0.24, -1.0});
                pose.rotation = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
                contact_manifolds({surface, still}, {*shape, pose}, {}, found);
                REQUIRE(found.all().size() == 1);
                const Manifold& m = found.all()[0];
                CHECK(m.normal.y == doctest::Approx(side));
                REQUIRE(m.count == 2);
                for (int i = 0; i < 2; ++i) {
                    CHECK(m.points[i].depth == doctest::Approx(0.01));
                    CHECK(std::abs(m.points[i].position.x - 0.5) == doctest::Approx(0.75));
                    CHECK(m.points[i].position.y == doctest::Approx(-0.005 * side));
                    CHECK(m.points[i].position.z == doctest::Approx(-1.0));
                }
                CHECK(m.points[0].position.x + m.points[1].position.x == doctest::Approx(1.0));
            }
    }

    TEST_CASE("a box tilted on the floor is held by its lowest corner or edge, straight up") {
        RandomShapes random(3);
        const Surface s = ground(random, 24, 0.5, [](double, double) { return 0.0; });
        const Shape floor = s.shape(Sides::front), box = Shape::box({0.5f, 0.5f, 0.5f}).value();
        Manifolds found;
        for (int i = 0; i < 500; ++i) {
            RigidTransform pose{random.rotation(), {random.number(-2, 2), 0.0, random.number(-2, 2)}};
            double lowest = HUGE_VAL;
            for (int k = 0; k < 8; ++k) lowest = std::min(lowest, (pose.rotation * box.vertex(k)).y);
            const double depth = random.number(1e-4, 0.02);
            pose.translation.y = -lowest - depth;
            contact_manifolds({floor, at({})}, {box, pose}, {}, found);
            REQUIRE(found.all().size() == 1);
            CHECK(found.all()[0].normal.y >= 1.0 - 1e-9);
            CHECK(found.all()[0].depth == doctest::Approx(depth).epsilon(1e-6));
        }
    }

    TEST_CASE("a ridge pushes to both sides, a valley along its faces, and a step's edge outward") {
        RandomShapes random(4);
        const auto roof = ground(
            random, 16, 0.5, [](double x, double) { return x < 1e-3 ? x : -x; }, 0.0);
        Manifolds found;
        const Shape sphere = Shape::sphere(0.25f).value(), box = Shape::box({0.25f, 0.25f, 0.25f}).value();
        contact_manifolds({roof.shape(Sides::front), at({})}, {sphere, at({0, 0.2, 0.1})}, {}, found);
        REQUIRE(found.all().size() == 1);
        CHECK(found.all()[0].normal.y == doctest::Approx(1.0));  // between the two faces' normals
        CHECK(found.all()[0].depth == doctest::Approx(0.05));
        contact_manifolds({roof.shape(Sides::front), at({})}, {box, at({0, 0.2, 0.1})}, {}, found);
        for (const Manifold& m : found.all()) CHECK(m.normal.y > 0.7);
        const auto valley = ground(
            random, 16, 0.5, [](double x, double) { return std::abs(x); }, 0.0);
        contact_manifolds({valley.shape(Sides::front), at({})}, {sphere, at({0, 0.34, 0.1})}, {}, found);
        REQUIRE(found.all().size() == 2);
        for (const Manifold& m : found.all()) {
            CHECK(m.normal.y == doctest::Approx(std::sqrt(0.5)));
            CHECK(m.depth == doctest::Approx(0.25 - 0.34 * std::sqrt(0.5)));
        }
    }

    TEST_CASE(
        "front sides only: a shape that has sunk in is pushed up, one below is left alone, both sides push down") {
        RandomShapes random(5);
        const Surface s = ground(random, 16, 0.5, [](double, double) { return 0.0; });
        const Shape box = Shape::box({0.5f, 0.5f, 0.5f}).value(), sphere = Shape::sphere(0.5f).value();
        Manifolds found;
        for (const Shape& b : {box, sphere}) {
            contact_manifolds({s.shape(Sides::front), at({})}, {b, at({0.1, 0.1, 0.2})}, {}, found);
            REQUIRE_FALSE(found.all().empty());
            for (const Manifold& m : found.all()) CHECK(m.normal.y == doctest::Approx(1.0));
            CHECK(found.all()[0].depth == doctest::Approx(0.4));
            contact_manifolds({s.shape(Sides::front), at({})}, {b, at({0.1, -0.4, 0.2})}, {}, found);
            CHECK(found.all().empty());
            contact_manifolds({s.shape(Sides::both), at({})}, {b, at({0.1, -0.4, 0.2})}, {}, found);
            REQUIRE_FALSE(found.all().empty());
            CHECK(found.all()[0].normal.y == doctest::Approx(-1.0));
            CHECK(found.all()[0].depth == doctest::Approx(0.1));
        }
        CHECK(contact_manifold({s.shape(), at({})}, {box, at({0.1, 0.45, 0.2})}).depth == doctest::Approx(0.05));
    }

    TEST_CASE("a single sheet of two sides pushes the shorter way, a surface of two sides to the shape's side of it") {
        RandomShapes random(14);
        Surface sheet;
        sheet.mesh.positions = {{-9, 0, -9}, {0, 0, 9}, {9, 0, -9}};
        sheet.mesh.indices = {0, 1, 2};
        sheet.build();
        const Shape plank = Shape::box({4.0f, 0.05f, 0.2f}).value();
        Manifolds found;
        for (const double y : {0.04, 0.01, -0.01, -0.04}) {
            contact_manifolds({sheet.shape(), at({})}, {plank, at({0, y, 0})}, {}, found);
            REQUIRE(found.all().size() == 1);
            CHECK(found.all()[0].normal.y == doctest::Approx(y > 0.0 ? 1.0 : -1.0));
            CHECK(found.all()[0].depth == doctest::Approx(0.05 - std::abs(y)));
        }
        // A plank on a roof's flat top, whose end sticks out over the gentle slope and below which its middle would be.
        for (int i = 0; i < 500; ++i) {
            const double slope = random.number(0.02, 0.2), out = random.number(0.0, 1.0);
            Surface roof = ground(
                random, 24, 0.5, [&](double x, double) { return std::min(0.0, -slope * x); }, 0.0);
            turn_some_over(random, roof);
            const double depth = random.number(0.001, 0.02);
            for (const double side : {1.0, -1.0}) {  // also from below, hung up
                const glm::dmat3 turn{{1, 0, 0}, {0, side, 0}, {0, 0, side}};
                const RigidTransform place{turn, {0, 0, 0}};
                contact_manifolds({roof.shape(), place}, {plank, at({out - 4.0, side * (0.05 - depth), 0.1})}, {},
                                  found);
                REQUIRE(!found.all().empty());
                for (const Manifold& m : found.all()) {
                    CHECK(side * m.normal.y > 0.9);
                    CHECK(m.normal.x > -1e-9);
                    CHECK(m.normal.x < slope + 1e-9);
                    CHECK(m.depth <= depth + 1e-9);
                }
            }
        }
    }

    // Ground of slopes from 1e-4, where the rule takes edges for flat, to 5.
    TEST_CASE(
        "a sphere on many triangles has contacts with exactly the triangles that the rule for inner edges keeps") {
        RandomShapes random(21);
        Manifolds found;
        int asked = 0, contacts = 0, over_edges = 0, all_listed = 0;
        for (int round = 0; round < 60; ++round) {
            const double steep = std::pow(10.0, random.number(-4.0, 0.7));
            const Surface s = ground(random, 12, 1.0, [&](double, double) { return steep * random.number(-1, 1); });
            const Shape shape = s.shape(round % 3 == 0 ? Sides::both : Sides::front);
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            for (int i = 0; i < 60; ++i) {
                const double radius = random.number(0.2, 4.0), margin = random.index(2) == 0 ? 0.0 : 0.1 * radius;
                const glm::dvec3 center(random.number(-3, 3), radius + random.number(-0.3, 0.1) * radius,
                                        random.number(-3, 3));
                const auto expected = ball_contacts(s, center, radius, margin);
                if (!expected) continue;
                ++asked;
                CAPTURE(round);
                CAPTURE(i);
                const double tolerance = 1e-9 * (radius + 20.0);
                const Shape ball = Shape::sphere(radius).value();
                const RigidTransform at_ball{random.rotation(), pose.rotation * center + pose.translation};
                contact_manifolds({shape, pose}, {ball, at_ball}, {.margin = margin, .max_points = 8}, found);
                const double same = std::cos(glm::radians(5.0)) - 1e-9;
                std::set<std::uint32_t> listed;
                bool are_all_kept = true;
                for (const Manifold& m : found.all()) {
                    are_all_kept = are_all_kept && m.count < 8;
                    for (int k = 0; k < m.count; ++k) {
                        const ContactPoint& p = m.points[k];
                        const auto c = std::find_if(expected->begin(), expected->end(), [&](const BallContact& e) {
                            return e.triangle == p.part_a.triangle;
                        });
                        CHECK(c != expected->end());
                        if (c == expected->end()) continue;
                        CHECK(listed.insert(c->triangle).second);
                        CHECK(std::abs(c->depth - p.depth) <= tolerance);
                        CHECK(glm::distance(pose.rotation * c->position + pose.translation, p.position) <= tolerance);
                        CHECK(glm::dot(pose.rotation * c->normal, m.normal) >= same);
                        over_edges += p.on_a.kind != FeatureKind::face;
                    }
                }
                double deepest = -HUGE_VAL, wanted = -HUGE_VAL;
                for (const Manifold& m : found.all()) deepest = std::max(deepest, m.depth);
                for (const BallContact& c : *expected) {
                    wanted = std::max(wanted, c.depth);
                    CHECK(std::any_of(found.all().begin(), found.all().end(), [&](const Manifold& m) {
                        return glm::dot(m.normal, pose.rotation * c.normal) >= same;
                    }));
                    if (are_all_kept) CHECK(listed.count(c.triangle) == 1);
                    ++contacts;
                }
                all_listed += are_all_kept ? 1 : 0;
                // No triangle rises above the surface's nearest point, so one is left at least.
                CHECK(found.all().empty() == expected->empty());
                if (!expected->empty()) CHECK(std::abs(deepest - wanted) <= tolerance);
            }
        }
        MESSAGE(asked << " asked, " << all_listed << " with all contacts, " << contacts << " contacts, " << over_edges
                      << " points over edges");
        CHECK(asked > 1000);
        CHECK(contacts > 3000);
        CHECK(all_listed > 1000);
    }

    TEST_CASE("ids stay while a box rests and trembles on triangles") {
        RandomShapes random(6);
        const Surface s = ground(random, 16, 0.9, [](double, double) { return 0.0; });
        const Shape floor = s.shape(Sides::front), box = Shape::box({0.5f, 0.5f, 0.5f}).value();
        Manifolds found;
        int kept = 0, all = 0;
        std::set<std::pair<PartId, std::uint16_t>> before;
        for (int frame = 0; frame < 300; ++frame) {
            const glm::dvec3 tremble = 1e-5 * random.direction();
            contact_manifolds({floor, at({})}, {box, turned(0.3 + tremble.x, glm::dvec3(0.2, 0.499, 0.1) + tremble)},
                              {.margin = 0.01}, found);
            std::set<std::pair<PartId, std::uint16_t>> now;
            for (const Manifold& m : found.all())
                for (int i = 0; i < m.count; ++i) now.insert({m.points[i].part_a, m.points[i].on_b.index});
            for (const auto& id : before) kept += static_cast<int>(now.count(id));
            all += static_cast<int>(before.size());
            before = now;
        }
        CHECK(kept >= 0.99 * all);
    }

    TEST_CASE("tracked points keep the caller's numbers while their ids stay, and those that go are counted") {
        const Shape floor = Shape::box({9, 1, 9}).value(), box = Shape::box({0.5f, 0.5f, 0.5f}).value();
        const RigidTransform still = at({});
        Manifolds found;
        PairCache cache;
        Vector<TrackedPoint> points;
        const auto step = [&](const RigidTransform& pose) {
            contact_manifolds({floor, still}, {box, pose}, {}, found, &cache);
            return track(found.all(), points);
        };
        CHECK(step(at({0, 1.49, 0})) == 0);
        REQUIRE(points.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(points[i].began);
            CHECK(points[i].memory[0] == 0.0f);
            points[i].memory[0] = static_cast<float>(points[i].contact.on_b.index) + 1.0f;
        }
        CHECK(step(at({0.3, 1.495, -0.1})) == 0);
        REQUIRE(points.size() == 4);
        for (const TrackedPoint& p : points) {
            CHECK_FALSE(p.began);
            CHECK(p.memory[0] == static_cast<float>(p.contact.on_b.index) + 1.0f);
        }
        // Over the floor's edge two corners leave it: their points end, and new ones begin on the edge.
        CHECK(step(at({9.0, 1.49, 0})) == 2);
        REQUIRE(points.size() == 4);
        CHECK(std::count_if(points.begin(), points.end(), [](const TrackedPoint& p) { return p.began; }) == 2);
        CHECK(step(at({0, 5, 0})) == 4);
        CHECK(points.empty());
    }

    TEST_CASE("compounds slide over a floor of triangles and meet no inner edge, whichever of the two comes first") {
        RandomShapes random(12);
        const Surface s = ground(random, 24, 0.5, [](double, double) { return 0.0; });
        const CompoundChild children[2] = {{Shape::box({0.5f, 0.5f, 0.2f}).value(), at({0, 0, -0.3})},
                                           {Shape::box({0.5f, 0.5f, 0.2f}).value(), at({0, 0, 0.3})}};
        const Compound compound = Compound::build(children).value();
        // A mesh far away makes the whole one that has surfaces as well.
        const CompoundChild mixed[2] = {children[0], {s.shape(), at({0, 50, 0})}};
        const Compound mixture = Compound::build(mixed).value();
        Manifolds found;
        for (const Sides sides : {Sides::front, Sides::both})
            for (int i = 0; i < 1000; ++i) {
                const Shape floor = s.shape(sides), shape = Shape::compound(i % 2 != 0 ? compound : mixture);
                const RigidTransform pose =
                    turned(random.number(0, 6.2), {random.number(-2, 2), 0.49, random.number(-2, 2)});
                for (const double side : {1.0, -1.0}) {
                    if (side > 0.0)
                        contact_manifolds({floor, at({})}, {shape, pose}, {.margin = 0.01}, found);
                    else
                        contact_manifolds({shape, pose}, {floor, at({})}, {.margin = 0.01}, found);
                    REQUIRE(found.all().size() == 1);
                    CHECK(side * found.all()[0].normal.y >= 1.0 - 1e-9);
                    CHECK(found.all()[0].depth == doctest::Approx(0.01));
                    const ContactPoint& p = found.all()[0].points[0];
                    CHECK((side > 0.0 ? p.part_b : p.part_a).child < 2);
                }
            }
    }

    TEST_CASE("front sides alone: a compound or a mesh that is below is left alone, whichever comes first") {
        RandomShapes random(13);
        const Surface s = ground(random, 16, 0.5, [](double, double) { return 0.0; });
        const Shape floor = s.shape(Sides::front);
        const CompoundChild child{Shape::box({0.5f, 0.5f, 0.5f}).value(), at({})};
        const Compound compound = Compound::build({&child, 1}).value();
        Surface tooth;
        tooth.mesh.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0, 0.05f, 0.3f}};
        tooth.mesh.indices = {0, 1, 2};
        tooth.build();
        Manifolds found;
        for (const Shape& b : {Shape::compound(compound), tooth.shape(), tooth.shape(Sides::front)}) {
            const double y = b.kind() == Kind::compound ? -0.45 : 0.0;
            for (int i = 0; i < 50; ++i) {
                const RigidTransform pose =
                    turned(random.number(0, 6.2), {random.number(-2, 2), y, random.number(-2, 2)});
                contact_manifolds({floor, at({})}, {b, pose}, {}, found);
                for (const Manifold& m : found.all()) CHECK(m.normal.y > 0.0);
                contact_manifolds({b, pose}, {floor, at({})}, {}, found);
                for (const Manifold& m : found.all()) CHECK(m.normal.y < 0.0);
            }
        }
    }

    TEST_CASE("a half-space holds a mesh or field by its deepest corners, along the half-space's normal, anywhere") {
        RandomShapes random(4602);
        Manifolds found;
        int touching = 0;
        for (int i = 0; i < 600; ++i) {
            std::vector<float> heights(16);
            for (float& height : heights) height = static_cast<float>(random.number(-0.5, 0.5));
            const HeightField field = HeightField::build({4, 4, heights, glm::dvec2(0.5)}).value();
            Surface s;
            switch (i % 4) {
                case 0:
                    s = soup(random, 12, 1.0, 0.5);
                    break;
                case 1:
                    s = tangle(random, 8, 20);
                    break;
                case 2:
                    s = ground(random, 4, 0.5, [&](double, double) { return random.number(-0.3, 0.3); });
                    break;
                default:
                    for (std::uint32_t row = 0; row < 4; ++row)
                        for (std::uint32_t column = 0; column < 4; ++column)
                            s.mesh.positions.emplace_back(field.corner(column, row));
            }
            const Shape shape = i % 4 == 3 ? Shape::height_field(field, Sides::both) : s.shape();
            const glm::dvec3 normal = random.direction();
            const Shape half = Shape::half_space({random.number(0.5, 2.0) * normal, random.number(-1.5, 1.5)}).value();
            const RigidTransform pose{random.rotation(), random.number(0.0, 3.0) * random.direction()},
                level{random.rotation(), random.direction()};
            const double length = glm::length(half.plane().normal);
            const glm::dvec3 into = level.rotation * (half.plane().normal / length);
            const auto depth_at = [&](const glm::dvec3& p) {
                return glm::dot(into, p - level.translation) + half.plane().offset / length;
            };
            double deepest = -HUGE_VAL;
            for (const glm::vec3& p : s.mesh.positions)
                deepest = std::max(deepest, depth_at(transform(pose, glm::dvec3(p))));
            const bool flip = i % 8 < 4;
            const ShapeAtPose surface{shape, pose}, solid{half, level};
            const double margin = i % 3 == 0 ? 0.1 : 0.0;
            contact_manifolds(flip ? solid : surface, flip ? surface : solid, {.margin = margin}, found);
            CAPTURE(i);
            if (std::abs(deepest + margin) < 1e-9) continue;
            REQUIRE(found.all().size() == (deepest > -margin ? 1u : 0u));
            if (found.all().empty()) continue;
            ++touching;
            const Manifold& m = found.all()[0];
            CHECK(m.depth == doctest::Approx(deepest).epsilon(1e-9));
            CHECK(glm::distance(m.normal, flip ? -into : into) < 1e-9);
            for (int k = 0; k < m.count; ++k) {
                const ContactPoint& point = m.points[k];
                const glm::dvec3 corner = point.position + 0.5 * point.depth * into;
                CHECK(std::abs(depth_at(corner) - point.depth) < 1e-9);
                double nearest = HUGE_VAL;
                for (const glm::vec3& p : s.mesh.positions)
                    nearest = std::min(nearest, glm::distance(corner, transform(pose, glm::dvec3(p))));
                CHECK(nearest < 1e-9);
            }
        }
        CHECK(touching > 300);
    }
}
