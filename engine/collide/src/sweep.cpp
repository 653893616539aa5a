// SPDX-License-Identifier: MIT
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
        const Distance now = distance(moved(a, motion_a, time), moved(b, motion_b, time));
        if (now.distance < tolerance) return Impact{time, now};
        // Along the line of nearest points the gap closes no faster than this: the slab between the bodies only shrinks
        // by the motion of the two along its normal.
        const glm::dvec3 direction = (now.on_b - now.on_a) / now.distance;
        const double closing = glm::dot(approach, direction) + spins;
        if (!(closing > 0.0)) return std::nullopt;
        time += (now.distance - 0.5 * tolerance) / closing;
        if (!(time <= duration)) return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace crofton::collide
