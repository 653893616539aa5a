// SPDX-License-Identifier: MIT
#include "near_misses.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/collide/narrow_phase.hpp>
#include <glm/geometric.hpp>

namespace crofton::viewer {
namespace {

glm::dvec3 axis_of(const Obb& a, const Obb& b, int axis) {
    if (axis < 3) return glm::dvec3(a.axes[axis]);
    if (axis < 6) return glm::dvec3(b.axes[axis - 3]);
    return glm::cross(glm::dvec3(a.axes[(axis - 6) / 3]), glm::dvec3(b.axes[(axis - 6) % 3]));
}

double radius_along(const Obb& box, const glm::dvec3& axis) {
    double radius = 0.0;
    for (int k = 0; k < 3; ++k)
        radius += static_cast<double>(box.half_extents[k]) * std::fabs(glm::dot(glm::dvec3(box.axes[k]), axis));
    return radius;
}

}  // namespace

std::optional<Segment> separation(const Obb& a, const Obb& b) {
    const int which = collide::separating_axis(a, b);
    if (which == collide::kNotSeparated) return std::nullopt;
    glm::dvec3 axis = axis_of(a, b, which);
    const double length = glm::length(axis);
    if (!(length > 0.0)) return std::nullopt;
    axis /= length;
    const glm::dvec3 between = b.center - a.center;
    if (glm::dot(between, axis) < 0.0) axis = -axis;
    const double distance = glm::dot(between, axis);
    const double leave = radius_along(a, axis), enter = distance - radius_along(b, axis);
    const glm::dvec3 middle = a.center + 0.5 * between;
    return Segment{middle + (leave - 0.5 * distance) * axis, middle + (enter - 0.5 * distance) * axis};
}

std::vector<std::pair<scene::InstanceId, scene::InstanceId>> near_pairs(std::span<const Obb> boxes,
                                                                        std::span<const scene::InstanceId> instances,
                                                                        std::size_t limit) {
    struct Ball {
        glm::dvec3 center;
        double radius;
        scene::InstanceId instance;
    };
    std::vector<Ball> balls;
    double largest = 0.0;
    for (const scene::InstanceId i : instances) {
        balls.push_back({boxes[i].center, glm::length(glm::dvec3(boxes[i].half_extents)), i});
        largest = std::max(largest, balls.back().radius);
    }
    std::sort(balls.begin(), balls.end(), [](const Ball& p, const Ball& q) {
        return p.center.x < q.center.x || (p.center.x == q.center.x && p.instance < q.instance);
    });
    std::vector<std::pair<scene::InstanceId, scene::InstanceId>> pairs;
    for (std::size_t i = 0; i < balls.size(); ++i)
        for (std::size_t j = i + 1; j < balls.size() && pairs.size() < limit; ++j) {
            const Ball &p = balls[i], &q = balls[j];
            if (q.center.x - p.center.x > 2.0 * p.radius + largest) break;
            const double nearby = p.radius + q.radius + std::min(p.radius, q.radius);
            if (glm::distance(p.center, q.center) > nearby) continue;
            if (!collide::intersects(boxes[p.instance], boxes[q.instance])) pairs.emplace_back(p.instance, q.instance);
        }
    return pairs;
}

}  // namespace crofton::viewer
