// SPDX-License-Identifier: MIT
// Floors of parts that lie flush, whose tops are one plane: y = 0 of a common frame.
#pragma once
#include <algorithm>
#include <memory>

#include "surfaces.hpp"

namespace crofton::testing {

[[nodiscard]] inline RigidTransform placed_in(const RigidTransform& outer, const RigidTransform& inner) {
    return {outer.rotation * inner.rotation, outer.rotation * inner.translation + outer.translation};
}

[[nodiscard]] inline glm::dmat3 around_y(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
}

enum class Tiles { boxes, turned_boxes, hulls, prisms, triangles, mixed };

// Parts and what they are views of.
struct Floor {
    std::vector<convex::CompoundChild> parts;
    std::vector<std::unique_ptr<convex::Hull>> hulls;
    double least = 0.0, most = 0.0;  // x and z that it certainly covers

    void add(const convex::Shape& shape, const RigidTransform& pose) { parts.push_back({shape, pose}); }
    void add_hull(const std::vector<glm::vec3>& points, const RigidTransform& pose) {
        hulls.push_back(std::make_unique<convex::Hull>(convex::Hull::build(points).value()));
        add(convex::Shape::hull(*hulls.back()), pose);
    }
    // A polygon of the plane, `thick` down; around its first corner, and so flush but for rounding to float.
    void add_prism(const std::vector<glm::vec2>& corners, float thick) {
        std::vector<glm::vec3> points;
        for (const glm::vec2& p : corners)
            for (const float y : {0.0f, -thick}) points.emplace_back(p.x - corners[0].x, y, p.y - corners[0].y);
        add_hull(points, at({corners[0].x, 0, corners[0].y}));
    }
    void add_rectangle(RandomShapes& random, Tiles tiles, const glm::vec2& low, const glm::vec2& high, float thick) {
        if (tiles == Tiles::mixed) tiles = static_cast<Tiles>(random.index(5));
        const glm::dvec2 size(high - low), middle = 0.5 * (glm::dvec2(low) + glm::dvec2(high));
        const glm::vec3 half(0.5f * (high.x - low.x), 0.5f * thick, 0.5f * (high.y - low.y));
        const glm::dvec3 center(middle.x, -0.5 * static_cast<double>(thick), middle.y);
        if (tiles == Tiles::boxes) return add(convex::Shape::box(half).value(), at(center));
        if (tiles == Tiles::turned_boxes) {  // the same box seen from a frame whose axes are others
            const bool side = random.index(2) != 0;
            const glm::dmat3 turn =
                side ? glm::dmat3{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}} : glm::dmat3{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
            const glm::dvec3 own = glm::transpose(turn) * glm::dvec3(half);
            return add(convex::Shape::box(glm::vec3(own)).value(), {turn, center});
        }
        if (tiles == Tiles::hulls) {
            std::vector<glm::vec3> points;
            for (int k = 0; k < 8; ++k)
                points.push_back(half * glm::vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
            return add_hull(points, at(center));
        }
        const glm::vec2 corner[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
        const int first = random.index(2);
        for (const int k : {first, first + 2}) {
            const glm::vec2 a = corner[k % 4], b = corner[(k + 1) % 4], c = corner[(k + 2) % 4];
            if (tiles == Tiles::prisms)
                add_prism({a, b, c}, thick);
            else
                add(convex::Shape::triangle({a.x, 0, a.y}, {c.x, 0, c.y}, {b.x, 0, b.y}).value(), at({}));
        }
    }
};

// Rows of different widths along one axis, cut at different places: with T-junctions. Sizes are quarters, or any float.
inline Floor strips(RandomShapes& random, Tiles tiles, bool quarters, float thick) {
    Floor floor;
    const auto width = [&](double low, double high) {
        const double w = random.number(low, high);
        return static_cast<float>(quarters ? std::max(0.25, std::floor(4.0 * w) / 4.0) : w);
    };
    const bool along_x = random.index(2) != 0;
    for (float z = -3.0f; z < 3.0f;) {
        const float next_z = z + width(0.3, 1.5);
        for (float x = -3.0f; x < 3.0f;) {
            const float next_x = x + width(0.3, 1.8);
            const glm::vec2 low(x, z), high(next_x, next_z);
            if (along_x)
                floor.add_rectangle(random, tiles, low, high, thick);
            else
                floor.add_rectangle(random, tiles, {z, x}, {next_z, next_x}, thick);
            x = next_x;
        }
        z = next_z;
    }
    floor.least = -3.0;
    floor.most = 3.0;
    return floor;
}

// A grid of prisms over triangles with moved corners.
inline Floor triangulated(RandomShapes& random, float thick, bool flat) {
    Floor floor;
    const Surface s = ground(random, 12, 0.5, [](double, double) { return 0.0; });
    for (std::size_t t = 0; t < s.size(); ++t) {
        glm::vec3 p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = s.mesh.positions[s.mesh.indices[3 * t + k]];
        if (flat)
            floor.add(convex::Shape::triangle(p[0], p[1], p[2]).value(), at({}));
        else
            floor.add_prism({{p[0].x, p[0].z}, {p[1].x, p[1].z}, {p[2].x, p[2].z}}, thick);
    }
    floor.least = -2.5;
    floor.most = 2.5;
    return floor;
}

// Shapes that move over floors, at most 0.5 high and wide.
class Sliders {
  public:
    explicit Sliders(RandomShapes& random) {
        using convex::Shape;
        std::vector<glm::vec3> octagon;
        for (int k = 0; k < 8; ++k)
            for (const float y : {-0.2f, 0.25f})
                octagon.emplace_back(static_cast<float>(0.3 * std::cos(0.7853981633974483 * k)), y,
                                     static_cast<float>(0.3 * std::sin(0.7853981633974483 * k)));
        hulls_.push_back(std::make_unique<convex::Hull>(convex::Hull::build(octagon).value()));
        std::vector<glm::vec3> round;
        for (int k = 0; k < 24; ++k) round.emplace_back(0.35 * random.direction());
        hulls_.push_back(std::make_unique<convex::Hull>(convex::Hull::build(round).value()));
        shapes = {Shape::box({0.3f, 0.3f, 0.3f}).value(),
                  Shape::box({0.3f, 0.2f, 0.05f}).value(),
                  Shape::sphere(0.3).value(),
                  Shape::capsule(0.3f, 0.25f).value(),
                  Shape::cylinder(0.3f, 0.25f).value(),
                  Shape::cone(0.3f, 0.25f).value(),
                  Shape::hull(*hulls_[0]),
                  Shape::hull(*hulls_[1]),
                  Shape::rounded(Shape::box({0.2f, 0.2f, 0.2f}).value(), 0.1).value(),
                  Shape::rounded(Shape::hull(*hulls_[0]), 0.05).value(),
                  Shape::rounded(Shape::cylinder(0.2f, 0.2f).value(), 0.05).value()};
    }
    std::vector<convex::Shape> shapes;

  private:
    std::vector<std::unique_ptr<convex::Hull>> hulls_;
};

// Corners of the tiles in the plane, where cracks are that no rounding to float leaves closed.
[[nodiscard]] inline std::vector<glm::dvec3> corners_of(const Floor& floor) {
    std::vector<glm::dvec3> corners;
    for (const convex::CompoundChild& part : floor.parts)
        for (int k = 0; k < part.shape.vertex_count(); ++k) {
            const glm::dvec3 p = part.pose.rotation * part.shape.vertex(k) + part.pose.translation;
            if (std::abs(p.y) < 1e-6 && std::abs(p.x) < 2.0 && std::abs(p.z) < 2.0) corners.push_back(p);
        }
    return corners;
}

// Where a shape stands whose lowest point comes over a corner of the floor on its way, or beside it by less than 1e-9
// of a line to another.
[[nodiscard]] inline glm::dvec3 over_corner(RandomShapes& random, const std::vector<glm::dvec3>& corners,
                                            const convex::Shape& shape, const glm::dmat3& turn, const glm::dvec3& way) {
    const auto any = [&] { return corners[static_cast<std::size_t>(random.index(static_cast<int>(corners.size())))]; };
    const glm::dvec3 to = any(), from = any();
    const double aside = random.index(2) == 0 ? 0.0 : 1e-9 * random.number(0, 1);
    const double when = random.index(2) == 0 ? 0.0 : 0.99;
    const glm::dvec3 lowest = turn * convex::support_point(shape, glm::transpose(turn) * glm::dvec3(0, -1, 0));
    return to + aside * (from - to) - lowest - when * way;
}

// How far the shape reaches down from its origin under a rotation.
[[nodiscard]] inline double below(const convex::Shape& shape, const glm::dmat3& rotation) {
    const glm::dvec3 down = glm::transpose(rotation) * glm::dvec3(0, -1, 0);
    return glm::dot(convex::support_point(shape, down), down);
}

}  // namespace crofton::testing
