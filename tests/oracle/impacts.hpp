// SPDX-License-Identifier: MIT
// Oracle: what an Impact says, checked by formulas of each kind of shape. No search: a pair of points and a direction
// prove by themselves that they are the nearest.
#pragma once
#include <algorithm>
#include <cmath>
#include <crofton/convex/query.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

namespace crofton::oracle {

// How far the shape reaches along a unit vector, in its frame.
inline double extent_along(const convex::Shape& shape, const glm::dvec3& d) {
    using convex::Kind;
    const glm::dvec3& h = shape.half_extents();
    const double across = std::hypot(d.x, d.z);
    switch (shape.kind()) {
        case Kind::cylinder:
            return h.x * across + h.y * std::abs(d.y) + shape.radius();
        case Kind::cone:
            return std::max(h.y * d.y, h.x * across - h.y * d.y) + shape.radius();
        case Kind::half_space: {
            const Plane& plane = shape.plane();
            const double length = glm::length(plane.normal);
            const bool outward = glm::dot(d, plane.normal) < -0.999999 * length;
            return outward ? plane.offset / length : HUGE_VAL;
        }
        default: {
            double most = -HUGE_VAL;
            for (int i = 0; i < shape.vertex_count(); ++i) most = std::max(most, glm::dot(d, shape.vertex(i)));
            return most + shape.radius();
        }
    }
}

inline double extent_along(const convex::ShapeAtPose& placed, const glm::dvec3& d) {
    const glm::dvec3 local = glm::transpose(placed.pose.rotation) * d;
    const double length = glm::length(local);
    return length * extent_along(placed.shape, local / length) + glm::dot(placed.pose.translation, d);
}

inline double distance_to_segment(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 way = to - from;
    const double length2 = glm::dot(way, way);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(p - from, way) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(p, from + t * way);
}

inline double distance_to_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double edges =
        std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
    const bool above = glm::dot(glm::cross(b - a, p - a), n) >= 0.0 && glm::dot(glm::cross(c - b, p - b), n) >= 0.0 &&
                       glm::dot(glm::cross(a - c, p - c), n) >= 0.0;
    return above && glm::length(n) > 0.0 ? std::abs(glm::dot(p - a, n)) / glm::length(n) : edges;
}

// How far a point is outside the core, at least as far as it is from a face. The point is in the shape's frame.
inline double outside_core(const convex::Shape& shape, const glm::dvec3& p) {
    using convex::Kind;
    const glm::dvec3& h = shape.half_extents();
    const double across = std::hypot(p.x, p.z);
    switch (shape.kind()) {
        case Kind::sphere:
            return glm::length(p);
        case Kind::capsule:
            return distance_to_segment(p, shape.vertex(0), shape.vertex(1));
        case Kind::cylinder:
            return glm::length(glm::max(glm::dvec3(across - h.x, std::abs(p.y) - h.y, 0.0), 0.0));
        case Kind::cone:
            // The section through the axis and the point: a triangle.
            return distance_to_triangle({across, p.y, 0.0}, {0.0, h.y, 0.0}, {0.0, -h.y, 0.0}, {h.x, -h.y, 0.0});
        case Kind::box:
            return glm::length(glm::max(glm::abs(p) - h, 0.0));
        case Kind::triangle:
            return distance_to_triangle(p, shape.vertex(0), shape.vertex(1), shape.vertex(2));
        case Kind::half_space:
            return std::max(0.0, -(glm::dot(shape.plane().normal, p) + shape.plane().offset)) /
                   glm::length(shape.plane().normal);
        default: {
            // By the planes of the triangles, each turned outward by a vertex that is off it.
            double most = 0.0;
            const auto indices = shape.hull()->triangles();
            for (std::size_t i = 0; i < indices.size(); i += 3) {
                const glm::dvec3 a = shape.vertex(indices[i]);
                const glm::dvec3 n = glm::cross(shape.vertex(indices[i + 1]) - a, shape.vertex(indices[i + 2]) - a);
                if (glm::length(n) > 1e-9) most = std::max(most, glm::dot(p - a, n) / glm::length(n));
            }
            return most;
        }
    }
}

inline double outside(const convex::ShapeAtPose& placed, const glm::dvec3& point) {
    const glm::dvec3 local = glm::inverse(placed.pose.rotation) * (point - placed.pose.translation);
    return std::max(0.0, outside_core(placed.shape, local) - placed.shape.radius());
}

// What is wrong with the points, the normal and the distance of an impact of convex shapes, where they stand at its
// time; empty: nothing. `slack` is a length. Points that are on their shapes, farthest along the normal, and apart
// along it by the distance, prove that they are the nearest points, or that they are deepest along that direction.
inline std::string fault_of_contact(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b,
                                    const convex::Impact& impact, double slack) {
    const glm::dvec3& n = impact.normal;
    const auto tell = [](const char* what, double by) {
        return std::string(what) + ", by " + std::to_string(1e9 * by) + "e-9";
    };
    if (!(std::abs(glm::length(n) - 1.0) <= 1e-9)) return "the normal is not of length 1";
    const double apart = glm::distance(impact.on_b - impact.on_a, impact.distance * n);
    if (!(apart <= slack)) return tell("the points are not apart by distance · normal", apart);
    if (!(outside(a, impact.on_a) <= slack)) return tell("on_a is not on a", outside(a, impact.on_a));
    if (!(outside(b, impact.on_b) <= slack)) return tell("on_b is not on b", outside(b, impact.on_b));
    const double beyond_a = extent_along(a, n) - glm::dot(n, impact.on_a);
    if (!(beyond_a <= slack)) return tell("a reaches farther along the normal than on_a", beyond_a);
    const double beyond_b = extent_along(b, -n) + glm::dot(n, impact.on_b);
    if (!(beyond_b <= slack)) return tell("b reaches farther against the normal than on_b", beyond_b);
    return {};
}

// The nearest or deepest direction from a shape to a sphere's center outside its core, by formula; 0 of kinds without
// one.
inline glm::dvec3 direction_to_point(const convex::ShapeAtPose& placed, const glm::dvec3& point) {
    using convex::Kind;
    const glm::dvec3 p = glm::inverse(placed.pose.rotation) * (point - placed.pose.translation);
    const glm::dvec3& h = placed.shape.half_extents();
    glm::dvec3 nearest = p;
    const double across = std::hypot(p.x, p.z);
    const glm::dvec3 out = across > 0.0 ? glm::dvec3(p.x / across, 0.0, p.z / across) : glm::dvec3(1, 0, 0);
    switch (placed.shape.kind()) {
        case Kind::sphere:
            nearest = glm::dvec3(0.0);
            break;
        case Kind::capsule:
            nearest = {0.0, std::clamp(p.y, -std::abs(placed.shape.vertex(0).y), std::abs(placed.shape.vertex(0).y)),
                       0.0};
            break;
        case Kind::box:
            nearest = glm::clamp(p, -h, h);
            break;
        case Kind::cylinder:
            nearest = std::min(across, h.x) * out + glm::dvec3(0.0, std::clamp(p.y, -h.y, h.y), 0.0);
            break;
        case Kind::cone: {
            // On the side's line from the rim to the apex, or on the disc.
            const glm::dvec3 rim = h.x * out - glm::dvec3(0.0, h.y, 0.0), apex(0.0, h.y, 0.0), side = apex - rim;
            const double t = std::clamp(glm::dot(p - rim, side) / glm::dot(side, side), 0.0, 1.0);
            const glm::dvec3 on_side = rim + t * side,
                             on_disc = std::min(across, h.x) * out - glm::dvec3(0.0, h.y, 0.0);
            nearest = glm::distance(p, on_side) < glm::distance(p, on_disc) ? on_side : on_disc;
            break;
        }
        default:
            return glm::dvec3(0.0);
    }
    const glm::dvec3 way = placed.pose.rotation * (p - nearest);
    return glm::length(way) > 0.0 ? glm::normalize(way) : way;
}

}  // namespace crofton::oracle
