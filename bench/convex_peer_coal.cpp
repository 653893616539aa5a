// SPDX-License-Identifier: MIT
#include <coal/collision.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include <memory>
#include <vector>

#include "convex_peers.hpp"

namespace crofton::bench {
namespace {

std::unique_ptr<coal::ShapeBase> coal_shape(const convex::Shape& shape) {
    if (shape.kind() == convex::Kind::box) {
        const glm::dvec3 h = shape.half_extents();
        return std::make_unique<coal::Box>(2 * h.x, 2 * h.y, 2 * h.z);
    }
    auto vertices = std::make_shared<std::vector<coal::Vec3s>>();
    for (const glm::vec3& v : shape.hull()->vertices()) vertices->emplace_back(v.x, v.y, v.z);
    auto triangles = std::make_shared<std::vector<coal::Triangle>>();
    const auto t = shape.hull()->triangles();
    for (std::size_t k = 0; k < t.size(); k += 3) triangles->emplace_back(t[k], t[k + 1], t[k + 2]);
    return std::make_unique<coal::Convex<coal::Triangle>>(vertices, unsigned(vertices->size()), triangles,
                                                          unsigned(triangles->size()));
}

coal::Transform3s coal_pose(const RigidTransform& pose) {
    coal::Matrix3s rotation;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) rotation(r, c) = pose.rotation[c][r];
    return {rotation, coal::Vec3s(pose.translation.x, pose.translation.y, pose.translation.z)};
}

}  // namespace

bool coal_meets(const convex::ShapeAtPose& a, const convex::ShapeAtPose& b) {
    const auto shape_a = coal_shape(a.shape), shape_b = coal_shape(b.shape);
    coal::CollisionRequest request;
    request.gjk_tolerance = request.epa_tolerance = 1e-14;  // its own are 1e-6
    coal::CollisionResult result;
    return coal::collide(shape_a.get(), coal_pose(a.pose), shape_b.get(), coal_pose(b.pose), request, result) > 0;
}

}  // namespace crofton::bench
