// SPDX-License-Identifier: MIT
#include <box3d/collision.h>
#include <box3d/math_functions.h>

#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "convex_peers.hpp"

namespace crofton::bench {
namespace {

std::vector<b3Vec3> box3d_points(const convex::Shape& shape) {
    std::vector<b3Vec3> points;
    if (shape.kind() == convex::Kind::box) {
        const glm::vec3 h(shape.half_extents());
        for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? h.x : -h.x, k & 2 ? h.y : -h.y, k & 4 ? h.z : -h.z});
        return points;
    }
    for (const glm::vec3& v : shape.hull()->vertices()) points.push_back({v.x, v.y, v.z});
    return points;
}

}  // namespace

bool box3d_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b) {
    const std::vector<b3Vec3> points_a = box3d_points(a.shape), points_b = box3d_points(b.shape);
    const glm::dmat3 to_a = glm::transpose(a.pose.rotation);
    const glm::vec3 p(to_a * (b.pose.translation - a.pose.translation));
    const glm::quat q(glm::quat_cast(to_a * b.pose.rotation));
    b3DistanceInput input{};
    input.proxyA = {points_a.data(), int(points_a.size()), 0.0f};
    input.proxyB = {points_b.data(), int(points_b.size()), 0.0f};
    input.transform = {{p.x, p.y, p.z}, {{q.x, q.y, q.z}, q.w}};
    b3SimplexCache cache{};
    return b3ShapeDistance(&input, &cache, nullptr, 0).distance <= 0;
}

}  // namespace crofton::bench
