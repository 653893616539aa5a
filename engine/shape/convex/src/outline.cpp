// SPDX-License-Identifier: MIT
// Shapes and contacts as lines, for debug drawing.
#include <algorithm>
#include <crofton/convex/query.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "parts.hpp"

namespace crofton::convex {
namespace {

constexpr int kCirclePieces = 24;

// Two unit vectors across n, and across each other.
void find_across(const glm::dvec3& n, glm::dvec3& u, glm::dvec3& v) {
    const glm::dvec3 a = glm::abs(n);
    const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                             : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                      : glm::dvec3(0, 0, 1);
    u = glm::normalize(glm::cross(n, least));
    v = glm::cross(n, u);
}

// Draws in the shape's frame.
class Pen {
  public:
    Pen(const RigidTransform& pose, LineVisitor line) : pose_(pose), line_(line) {}

    void line(const glm::dvec3& from, const glm::dvec3& to) const {
        line_(pose_.rotation * from + pose_.translation, pose_.rotation * to + pose_.translation);
    }
    // `pieces` of a circle of kCirclePieces around `at`, from u on towards v.
    void arc(const glm::dvec3& at, const glm::dvec3& u, const glm::dvec3& v, int pieces = kCirclePieces) const {
        glm::dvec3 last = at + u;
        for (int i = 1; i <= pieces; ++i) {
            const glm::dvec2 turn = cosine_sine(2.0 * std::numbers::pi * i / kCirclePieces);
            const glm::dvec3 next = at + turn.x * u + turn.y * v;
            line(last, next);
            last = next;
        }
    }

  private:
    const RigidTransform& pose_;
    LineVisitor line_;
};

// A solid of revolution: its outline (radius, height) from below to above, rounded by `round`.
void draw_turned(const Pen& pen, double low_radius, double high_radius, double half, double round) {
    for (const double end : {-half, half}) {
        const double radius = (end < 0.0 ? low_radius : high_radius) + round;
        if (radius > 0.0) pen.arc({0, end, 0}, {radius, 0, 0}, {0, 0, radius});
    }
    for (const glm::dvec3 side :
         {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
        const glm::dvec3 up(0, half, 0);
        pen.line((low_radius + round) * side - up, (high_radius + round) * side + up);
        if (round == 0.0) continue;
        pen.arc(high_radius * side + up, round * side, {0, round, 0}, kCirclePieces / 4);
        pen.arc(low_radius * side - up, round * side, {0, -round, 0}, kCirclePieces / 4);
    }
}

void draw_half_space(const Pen& pen, const Plane& plane) {
    const double length = glm::length(plane.normal);
    const glm::dvec3 n = plane.normal / length, at = -plane.offset / length * n;
    glm::dvec3 u, v;
    find_across(n, u, v);
    const glm::dvec3 corners[] = {at + 10.0 * (u + v), at + 10.0 * (v - u), at - 10.0 * (u + v), at + 10.0 * (u - v)};
    for (int i = 0; i < 4; ++i) pen.line(corners[i], corners[(i + 1) % 4]);
    pen.line(at, at + n);
}

void draw_hull(const Pen& pen, const Hull& hull, double round) {
    const auto at = [&](std::uint16_t v) { return glm::dvec3(hull.vertices()[v]); };
    for (int face = 0; face < hull.face_count(); ++face) {
        const auto loop = hull.face_vertices(face);
        const glm::dvec3 out = round * hull.face_normal(face);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const std::uint16_t from = loop[i], to = loop[(i + 1) % loop.size()];
            // Only one of two faces that share an edge draws it, unless they are apart.
            if (round > 0.0 || from < to) pen.line(at(from) + out, at(to) + out);
        }
    }
}

void draw_box(const Pen& pen, const Shape& shape) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            glm::dvec3 out(0.0);
            out[axis] = side == 1 ? shape.radius() : -shape.radius();
            const int base = side << axis;
            const int loop[] = {base, base | 1 << u, base | 1 << u | 1 << v, base | 1 << v};
            // Two opposite faces have the eight edges across the axis; those along it are others'.
            for (int i = 0; i < 4; ++i)
                if (shape.radius() > 0.0 || i % 2 == 0)
                    pen.line(shape.vertex(loop[i]) + out, shape.vertex(loop[(i + 1) % 4]) + out);
        }
}

void draw_triangle(const Pen& pen, const Shape& shape) {
    const glm::dvec3 a = shape.vertex(0), b = shape.vertex(1), c = shape.vertex(2), n = glm::cross(b - a, c - a);
    const double length = glm::length(n), radius = length > 0.0 ? shape.radius() : 0.0;
    for (const double side : {1.0, -1.0}) {
        const glm::dvec3 out = radius > 0.0 ? side * radius / length * n : glm::dvec3(0.0);
        pen.line(a + out, b + out);
        pen.line(b + out, c + out);
        pen.line(c + out, a + out);
        if (radius == 0.0) break;
    }
}

void draw_convex(const Shape& shape, const RigidTransform& pose, LineVisitor line) {
    const Pen pen(pose, line);
    const glm::dvec3& half = shape.half_extents();
    const double r = shape.radius();
    switch (shape.kind()) {
        case Kind::sphere:
            pen.arc({}, {r, 0, 0}, {0, r, 0});
            pen.arc({}, {0, r, 0}, {0, 0, r});
            return pen.arc({}, {0, 0, r}, {r, 0, 0});
        case Kind::capsule:
            return draw_turned(pen, 0.0, 0.0, shape.vertex(1).y, r);
        case Kind::cylinder:
            return draw_turned(pen, half.x, half.x, half.y, r);
        case Kind::cone:
            return draw_turned(pen, half.x, 0.0, half.y, r);
        case Kind::box:
            return draw_box(pen, shape);
        case Kind::hull:
            return draw_hull(pen, *shape.hull(), r);
        case Kind::half_space:
            return draw_half_space(pen, shape.plane());
        default:
            return draw_triangle(pen, shape);
    }
}

}  // namespace

void outline(const ShapeAtPose& shape, LineVisitor line) {
    if (shape.shape.is_convex()) return draw_convex(shape.shape, shape.pose, line);
    // All parts are near the middle, within the shape's own reach.
    const Result<Shape> point = Shape::sphere(0.0f);
    Vector<Part> parts;
    parts_near(shape, {*point, shape.pose}, std::min(2.0 * shape.shape.core_radius(), kEverything), parts);
    for (const Part& part : parts) draw_convex(part.shape, part.pose, line);
}

void outline(std::span<const TrackedPoint> points, double size, LineVisitor line) {
    for (const TrackedPoint& point : points) {
        const glm::dvec3 &at = point.contact.position, half = 0.5 * point.contact.depth * point.normal;
        line(at - half, at + half);
        if (point.normal == glm::dvec3(0.0)) continue;
        glm::dvec3 u, v;
        find_across(point.normal, u, v);
        line(at - 0.5 * size * u, at + 0.5 * size * u);
        line(at - 0.5 * size * v, at + 0.5 * size * v);
        line(at, at + size * point.normal);
    }
}

}  // namespace crofton::convex
