// SPDX-License-Identifier: MIT
#include "contact_finder.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/collide/obb_obb.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <glm/geometric.hpp>

namespace crofton::viewer {
namespace {

constexpr std::size_t kMaxTrees = 4096;

// Turning bodies change their stretch by roundings only: those must find their tree again.
double rounded(double value) {
    return std::round(value * 1e9) * 1e-9;
}

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

const mesh::MeshTree* ContactFinder::tree_of(const TriangleMesh& mesh, scene::MeshId id, const Stretch& s) {
    if (trees_.size() >= kMaxTrees) trees_.clear();
    auto& slot = trees_[{id, s}];
    if (slot) return slot.get();
    TriangleMesh stretched = mesh;
    for (glm::vec3& p : stretched.positions)
        p = glm::vec3(s[0] * p.x + s[1] * p.y + s[2] * p.z, s[3] * p.y + s[4] * p.z, s[5] * p.z);
    if (auto built = mesh::MeshTree::build(stretched)) slot = std::make_unique<mesh::MeshTree>(std::move(*built));
    return slot.get();
}

std::optional<ContactFinder::Body> ContactFinder::body_of(const scene::Scene& scene, scene::InstanceId instance) {
    const scene::Transform& world = scene.world(scene.node_of(instance));
    const glm::dvec3 x = world.linear[0], y = world.linear[1], z = world.linear[2];
    // Gram and Schmidt, column by column.
    RigidTransform pose;
    glm::dmat3& q = pose.rotation;
    q[0] = glm::normalize(x);
    q[1] = glm::normalize(y - glm::dot(y, q[0]) * q[0]);
    const glm::dvec3 rest = z - glm::dot(z, q[0]) * q[0] - glm::dot(z, q[1]) * q[1];
    q[2] = glm::normalize(rest - glm::dot(rest, q[1]) * q[1] - glm::dot(rest, q[0]) * q[0]);
    pose.translation = world.translation;
    if (!validate(pose)) return std::nullopt;
    Stretch stretch{glm::dot(q[0], x), glm::dot(q[0], y), glm::dot(q[0], z),
                    glm::dot(q[1], y), glm::dot(q[1], z), glm::dot(q[2], z)};
    for (double& value : stretch) value = rounded(value);
    const scene::MeshId mesh = scene.mesh_of(instance);
    const mesh::MeshTree* tree = tree_of(scene.mesh(mesh), mesh, stretch);
    if (tree == nullptr) return std::nullopt;
    return Body{tree, pose};
}

void ContactFinder::find(const scene::Scene& scene, scene::InstanceId a, scene::InstanceId b,
                         std::vector<Segment>& found) {
    found.clear();
    // Both trees must be there at once.
    if (trees_.size() + 2 > kMaxTrees) trees_.clear();
    const auto body_a = body_of(scene, a), body_b = body_of(scene, b);
    if (!body_a || !body_b) return;
    Vector<mesh::MeshContact> contacts;
    mesh::contacts(*body_a->tree, *body_b->tree, relative(body_a->pose, body_b->pose), contacts);
    for (const mesh::MeshContact& contact : contacts)
        found.push_back({transform(body_a->pose, contact.segment.begin), transform(body_a->pose, contact.segment.end)});
}

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
            const double reach = p.radius + q.radius + std::min(p.radius, q.radius);
            if (glm::distance(p.center, q.center) > reach) continue;
            if (!collide::intersects(boxes[p.instance], boxes[q.instance])) pairs.emplace_back(p.instance, q.instance);
        }
    return pairs;
}

}  // namespace crofton::viewer
