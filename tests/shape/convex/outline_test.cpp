// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "random_bodies.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct OutlineLine {
    glm::dvec3 from, to;
};

std::vector<OutlineLine> outline_lines(const Body& body, const RigidTransform& pose) {
    std::vector<OutlineLine> lines;
    outline({body, pose}, [&](const glm::dvec3& from, const glm::dvec3& to) { lines.push_back({from, to}); });
    return lines;
}

}  // namespace

TEST_SUITE("convex/outline") {
    TEST_CASE("a box has twelve lines, a triangle three, a hull its edges, and all corners are reached") {
        RandomBodies random(1);
        for (int i = 0; i < 50; ++i) {
            const Body body = random.polytope(20);
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            const std::vector<OutlineLine> lines = outline_lines(body, pose);
            if (body.kind() == Kind::box) CHECK(lines.size() == 12);
            if (body.kind() == Kind::triangle) CHECK(lines.size() == 3);
            if (body.hull() != nullptr) CHECK(lines.size() == body.hull()->edges().size());
            for (int v = 0; v < body.vertex_count(); ++v) {
                const glm::dvec3 corner = pose.rotation * body.vertex(v) + pose.translation;
                int ends = 0;
                for (const OutlineLine& line : lines)
                    ends += (glm::distance(line.from, corner) < 1e-12) + (glm::distance(line.to, corner) < 1e-12);
                // A vertex within a nearly flat face of a hull may have no edge.
                if (body.kind() == Kind::box) CHECK(ends == 3);
                if (body.kind() == Kind::triangle) CHECK(ends == 2);
            }
        }
    }

    TEST_CASE("ends of lines lie on the surface: within no body that is a little smaller, outside none") {
        const std::vector<Body> bodies{Body::sphere(1).value(),
                                       Body::capsule(1, 0.5f).value(),
                                       Body::cylinder(1, 0.5f).value(),
                                       Body::cone(1, 0.5f).value(),
                                       Body::rounded(Body::box({1, 0.5f, 0.25f}).value(), 0.25f).value(),
                                       Body::rounded(Body::cylinder(1, 0.5f).value(), 0.25f).value()};
        RandomBodies random(2);
        for (const Body& body : bodies) {
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            const Body point = Body::sphere(0).value();
            const std::vector<OutlineLine> lines = outline_lines(body, pose);
            CHECK(lines.size() >= 12);
            for (const OutlineLine& line : lines)
                for (const glm::dvec3& end : {line.from, line.to}) {
                    CHECK(closest_point({body, pose}, end).distance < 1e-9);
                    const Penetration p = penetration({body, pose}, {point, at(end)});
                    CHECK(p.depth < 1e-4);
                }
        }
    }

    TEST_CASE("a rounded triangle that is a segment or a point draws finite lines") {
        const glm::vec3 a(1, 2, 3), b(4, 2, 3);
        for (const Body& flat : {Body::triangle(a, b, a).value(), Body::triangle(a, a, a).value()}) {
            const std::vector<OutlineLine> lines = outline_lines(Body::rounded(flat, 0.5).value(), at({}));
            CHECK_FALSE(lines.empty());
            for (const OutlineLine& line : lines)
                for (const glm::dvec3& end : {line.from, line.to}) CHECK(glm::length(end) < 10.0);
        }
    }

    TEST_CASE("a compound and a height field draw their parts, a half-space its square, contacts their normals") {
        const Body box = Body::box({1, 1, 1}).value();
        const Compound pair =
            Compound::build(std::vector<CompoundChild>{{box, at({-5, 0, 0})}, {box, at({5, 0, 0})}}).value();
        CHECK(outline_lines(Body::compound(pair), at({1e6, 0, 0})).size() == 24);
        const std::vector<float> heights(12, 0.0f);
        const HeightField field = HeightField::build({.columns = 4, .rows = 3, .heights = heights}).value();
        CHECK(outline_lines(Body::height_field(field), at({})).size() == 3 * 12);
        CHECK(outline_lines(Body::half_space({{0, 3, 0}, 6}).value(), at({})).size() == 5);
        Manifolds found;
        contact_manifolds({box, at({})}, {box, at({0, 1.9, 0})}, {}, found);
        Vector<TrackedPoint> points;
        (void)track(found.all(), points);
        REQUIRE(points.size() == 4);
        int lines = 0, upward = 0;
        outline(points, 0.5, [&](const glm::dvec3& from, const glm::dvec3& to) {
            ++lines;
            upward += glm::distance(to - from, glm::dvec3(0, 0.5, 0)) < 1e-9;
        });
        CHECK(lines == 16);
        CHECK(upward == 4);
    }
}
