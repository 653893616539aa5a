// SPDX-License-Identifier: MIT
#include "instance_bodies.hpp"

#include <cmath>
#include <glm/matrix.hpp>

namespace crofton::viewer {
namespace {

mesh::MeshContact moved(mesh::MeshContact contact, const RigidTransform& pose) {
    contact.segment.begin = transform(pose, contact.segment.begin);
    contact.segment.end = transform(pose, contact.segment.end);
    contact.normal = pose.rotation * contact.normal;
    return contact;
}

}  // namespace

InstanceBodies::InstanceBodies(const scene::Scene& scene) : scene_(&scene), of_mesh_(scene.mesh_count()) {}

InstanceBodies::Placed InstanceBodies::place(scene::InstanceId instance) {
    const Transform& world = scene_->world(scene_->node_of(instance));
    const RigidTransform pose{world.linear, world.translation};
    if (convex::validate_pose(pose)) return {&of_mesh_[scene_->mesh_of(instance)], pose};
    Shape& own = own_[instance];
    if (own.linear != world.linear) own = {.linear = world.linear};
    return {&own, {glm::dmat3(1.0), world.translation}};
}

TriangleMesh InstanceBodies::posed_mesh(scene::InstanceId instance, const Shape& shape) const {
    TriangleMesh mesh = scene_->mesh(scene_->mesh_of(instance));
    if (shape.linear != glm::dmat3(1.0))
        for (glm::vec3& p : mesh.positions) p = glm::vec3(shape.linear * glm::dvec3(p));
    return mesh;
}

const mesh::MeshTree* InstanceBodies::tree_of(scene::InstanceId instance, Shape& shape) const {
    if (!std::exchange(shape.tree_made, true))
        if (auto tree = mesh::MeshTree::build(posed_mesh(instance, shape))) shape.tree = std::move(*tree);
    return shape.tree ? &*shape.tree : nullptr;
}

const convex::Hull* InstanceBodies::hull_of(scene::InstanceId instance, Shape& shape) const {
    if (!std::exchange(shape.hull_made, true))
        if (auto hull = convex::Hull::build(posed_mesh(instance, shape).positions, {.max_vertices = kHullVertices}))
            shape.hull = std::move(*hull);
    return shape.hull ? &*shape.hull : nullptr;
}

std::optional<mesh::RayHit> InstanceBodies::raycast(const Ray& ray, scene::InstanceId instance) {
    const Transform& world = scene_->world(scene_->node_of(instance));
    const glm::dmat3 inverse = glm::inverse(world.linear);
    for (int k = 0; k < 9; ++k)
        if (!std::isfinite(inverse[k / 3][k % 3])) return std::nullopt;
    const mesh::MeshTree* tree = tree_of(instance, of_mesh_[scene_->mesh_of(instance)]);
    if (tree == nullptr) return std::nullopt;
    return mesh::raycast(Ray{inverse * (ray.origin - world.translation), inverse * ray.direction, ray.max_t}, *tree);
}

std::vector<TriangleContacts> InstanceBodies::triangle_contacts(std::span<const InstancePair> pairs) {
    std::vector<TriangleContacts> result;
    Vector<mesh::MeshContact> found;
    for (const auto& [first, second] : pairs) {
        const Placed a = place(first), b = place(second);
        const mesh::MeshTree *tree_a = tree_of(first, *a.shape), *tree_b = tree_of(second, *b.shape);
        if (tree_a == nullptr || tree_b == nullptr) continue;
        mesh::contacts(*tree_a, *tree_b, relative(a.pose, b.pose), found);
        if (found.empty()) continue;
        TriangleContacts& contacts = result.emplace_back();
        contacts.first = first, contacts.second = second;
        for (const mesh::MeshContact& contact : found) contacts.triangles.push_back(moved(contact, a.pose));
    }
    return result;
}

std::vector<HullContacts> InstanceBodies::hull_contacts(std::span<const InstancePair> pairs) {
    ++calls_;
    std::vector<HullContacts> result;
    for (const auto& [first, second] : pairs) {
        const Placed a = place(first), b = place(second);
        const convex::Hull *hull_a = hull_of(first, *a.shape), *hull_b = hull_of(second, *b.shape);
        if (hull_a == nullptr || hull_b == nullptr) continue;
        const convex::Body body_a = convex::Body::hull(*hull_a), body_b = convex::Body::hull(*hull_b);
        Kept& kept = kept_[{first, second}];
        kept.call = calls_;
        const convex::Manifold manifold = convex::contact_manifold({body_a, a.pose}, {body_b, b.pose}, {}, &kept.cache);
        const std::size_t manifolds = manifold.count > 0 ? 1 : 0;
        convex::track(std::span(&manifold, manifolds), kept.points);
        if (manifolds > 0) result.push_back({first, second, kept.points});
    }
    std::erase_if(kept_, [&](const auto& entry) { return entry.second.call != calls_; });
    return result;
}

bool InstanceBodies::outline(scene::InstanceId instance, convex::LineVisitor line) {
    const Placed placed = place(instance);
    const convex::Hull* hull = hull_of(instance, *placed.shape);
    if (hull == nullptr) return false;
    const convex::Body body = convex::Body::hull(*hull);
    convex::outline({body, placed.pose}, line);
    return true;
}

}  // namespace crofton::viewer
