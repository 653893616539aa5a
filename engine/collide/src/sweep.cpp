// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace crofton::collide {
namespace {

// The largest speed that rotation gives any point of the body.
double spin_speed(const ConvexShape& body, const ConstantMotion& motion) {
    double reach = 0.0;
    for (int i = 0; i < body.point_count; ++i) reach = std::max(reach, glm::length(body.points[i] - motion.pivot));
    return glm::length(motion.spin) * (reach + body.radius);
}

// How far the bodies are apart along a unit vector from a to b; not above their distance. Negative: not along this one.
double gap_along(const ConvexShape& a, const ConvexShape& b, const glm::dvec3& direction) {
    double far_a = -HUGE_VAL, near_b = HUGE_VAL;
    for (int i = 0; i < a.point_count; ++i) far_a = std::max(far_a, glm::dot(a.points[i], direction));
    for (int i = 0; i < b.point_count; ++i) near_b = std::min(near_b, glm::dot(b.points[i], direction));
    return near_b - far_a - a.radius - b.radius;
}

// Two bodies that no slab along the line of their nearest points parts: of bodies that are a million times as long as
// they are wide `distance` may find one where there is none. Then the separating axes decide.
void take_widest_slab(const ConvexShape& a, const ConvexShape& b, double tolerance, double& gap,
                      glm::dvec3& direction) {
    const double along = gap_along(a, b, direction);
    if (along >= gap - 0.25 * tolerance) return;
    const Penetration axes = penetration(a, b);
    const double across = gap_along(a, b, axes.axis);
    if (across > along) direction = axes.axis;
    gap = std::max(along, across);
}

}  // namespace

ConvexShape moved(const ConvexShape& body, const ConstantMotion& motion, double time) {
    ConvexShape result = body;
    const double rate = glm::length(motion.spin);
    const glm::dmat3 turn =
        rate > 0.0 ? glm::mat3_cast(glm::angleAxis(rate * time, motion.spin / rate)) : glm::dmat3(1.0);
    for (int i = 0; i < body.point_count; ++i)
        result.points[i] = motion.pivot + turn * (body.points[i] - motion.pivot) + time * motion.velocity;
    for (int i = 0; i < body.edge_count; ++i) result.edges[i] = turn * body.edges[i];
    for (int i = 0; i < body.normal_count; ++i) result.normals[i] = turn * body.normals[i];
    return result;
}

std::optional<Impact> time_of_impact(const ConvexShape& a, const ConstantMotion& motion_a, const ConvexShape& b,
                                     const ConstantMotion& motion_b, double duration, double tolerance) {
    const double spins = spin_speed(a, motion_a) + spin_speed(b, motion_b);
    const glm::dvec3 approach = motion_a.velocity - motion_b.velocity;
    double time = 0.0;
    // Each round gains at least tolerance / (2 · speed) of time, or ends.
    const double speed = glm::length(approach) + spins;
    const double rounds = speed > 0.0 ? 4.0 + 2.0 * duration * speed / tolerance : 1.0;
    for (double round = 0.0; round < rounds; round += 1.0) {
        const ConvexShape now_a = moved(a, motion_a, time), now_b = moved(b, motion_b, time);
        const Distance now = distance(now_a, now_b);
        if (now.distance < tolerance) return Impact{time, now};
        // Along the line of nearest points the gap closes no faster than this. The slab between the bodies only shrinks
        // by the motion of the two along its normal.
        glm::dvec3 direction = (now.on_b - now.on_a) / now.distance;
        double gap = now.distance;
        take_widest_slab(now_a, now_b, tolerance, gap, direction);
        if (gap < tolerance) return Impact{time, {std::max(0.0, gap), now.on_a, now.on_b}};
        const double closing = glm::dot(approach, direction) + spins;
        if (!(closing > 0.0)) return std::nullopt;
        time += (gap - 0.5 * tolerance) / closing;
        if (!(time <= duration)) return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace crofton::collide
