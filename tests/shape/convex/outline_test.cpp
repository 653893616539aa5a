// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "random_shapes.hpp"
#include "surfaces.hpp"

using namespace crofton;
using namespace crofton::convex;
using namespace crofton::testing;

namespace {

struct OutlineLine {
    glm::dvec3 from, to;
};

std::vector<OutlineLine> outline_lines(const Shape& shape, const RigidTransform& pose) {
    std::vector<OutlineLine> lines;
    outline({shape, pose}, [&](const glm::dvec3& from, const glm::dvec3& to) { lines.push_back({from, to}); });
    return lines;
}

}  // namespace

TEST_SUITE("convex/outline") {
    TEST_CASE("a box has twelve lines, a triangle three, a hull its edges, and all corners are reached") {
        RandomShapes random(1);
        for (int i = 0; i < 50; ++i) {
            const Shape shape = random.polytope(20);
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            const std::vector<OutlineLine> lines = outline_lines(shape, pose);
            if (shape.kind() == Kind::box) CHECK(lines.size() == 12);
            if (shape.kind() == Kind::triangle) CHECK(lines.size() == 3);
            if (shape.hull() != nullptr) CHECK(lines.size() == shape.hull()->edges().size());
            for (int v = 0; v < shape.vertex_count(); ++v) {
                const glm::dvec3 corner = pose.rotation * shape.vertex(v) + pose.translation;
                int ends = 0;
                for (const OutlineLine& line : lines)
                    ends += (glm::distance(line.from, corner) < 1e-12) + (glm::distance(line.to, corner) < 1e-12);
                // A vertex within a nearly flat face of a hull may have no edge.
                if (shape.kind() == Kind::box) CHECK(ends == 3);
                if (shape.kind() == Kind::triangle) CHECK(ends == 2);
            }
        }
    }

    TEST_CASE("ends of lines lie on the surface: within no shape that is a little smaller, outside none") {
        const std::vector<Shape> shapes{Shape::sphere(1).value(),
                                        Shape::capsule(1, 0.5f).value(),
                                        Shape::cylinder(1, 0.5f).value(),
                                        Shape::cone(1, 0.5f).value(),
                                        Shape::rounded(Shape::box({1, 0.5f, 0.25f}).value(), 0.25f).value(),
                                        Shape::rounded(Shape::cylinder(1, 0.5f).value(), 0.25f).value()};
        RandomShapes random(2);
        for (const Shape& shape : shapes) {
            const RigidTransform pose{random.rotation(), 5.0 * random.direction()};
            const Shape point = Shape::sphere(0).value();
            const std::vector<OutlineLine> lines = outline_lines(shape, pose);
            CHECK(lines.size() >= 12);
            for (const OutlineLine& line : lines)
                for (const glm::dvec3& end : {line.from, line.to}) {
                    CHECK(closest_point({shape, pose}, end).distance < 1e-9);
                    const Penetration p = penetration({shape, pose}, {point, at(end)});
                    CHECK(p.depth < 1e-4);
                }
        }
    }

    TEST_CASE("a rounded triangle that is a segment or a point draws finite lines") {
        const glm::vec3 a(1, 2, 3), b(4, 2, 3);
        for (const Shape& flat : {Shape::triangle(a, b, a).value(), Shape::triangle(a, a, a).value()}) {
            const std::vector<OutlineLine> lines = outline_lines(Shape::rounded(flat, 0.5).value(), at({}));
            CHECK_FALSE(lines.empty());
            for (const OutlineLine& line : lines)
                for (const glm::dvec3& end : {line.from, line.to}) CHECK(glm::length(end) < 10.0);
        }
    }

    TEST_CASE("a compound and a height field draw their parts, a half-space its square, contacts their normals") {
        const Shape box = Shape::box({1, 1, 1}).value();
        const Compound pair =
            Compound::build(std::vector<CompoundChild>{{box, at({-5, 0, 0})}, {box, at({5, 0, 0})}}).value();
        CHECK(outline_lines(Shape::compound(pair), at({1e6, 0, 0})).size() == 24);
        const std::vector<float> heights(12, 0.0f);
        const HeightField field = HeightField::build({.columns = 4, .rows = 3, .heights = heights}).value();
        CHECK(outline_lines(Shape::height_field(field), at({})).size() == 3 * 12);
        CHECK(outline_lines(Shape::half_space({{0, 3, 0}, 6}).value(), at({})).size() == 5);
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
