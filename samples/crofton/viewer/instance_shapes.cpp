// SPDX-License-Identifier: MIT
#include "instance_shapes.hpp"

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

InstanceShapes::InstanceShapes(const scene::Scene& scene) : scene_(&scene), of_mesh_(scene.mesh_count()) {}

InstanceShapes::Placed InstanceShapes::place(scene::InstanceId instance) {
    const Transform& world = scene_->world(scene_->node_of(instance));
    const RigidTransform pose{world.linear, world.translation};
    if (convex::validate_pose(pose)) return {&of_mesh_[scene_->mesh_of(instance)], pose};
    TreeAndHull& own = own_[instance];
    if (own.linear != world.linear) own = {.linear = world.linear};
    return {&own, {glm::dmat3(1.0), world.translation}};
}

TriangleMesh InstanceShapes::posed_mesh(scene::InstanceId instance, const TreeAndHull& entry) const {
    TriangleMesh mesh = scene_->mesh(scene_->mesh_of(instance));
    if (entry.linear != glm::dmat3(1.0))
        for (glm::vec3& p : mesh.positions) p = glm::vec3(entry.linear * glm::dvec3(p));
    return mesh;
}

const mesh::MeshTree* InstanceShapes::tree_of(scene::InstanceId instance, TreeAndHull& entry) const {
    if (!std::exchange(entry.tree_made, true))
        if (auto tree = mesh::MeshTree::build(posed_mesh(instance, entry))) entry.tree = std::move(*tree);
    return entry.tree ? &*entry.tree : nullptr;
}

const convex::Hull* InstanceShapes::hull_of(scene::InstanceId instance, TreeAndHull& entry) const {
    if (!std::exchange(entry.hull_made, true))
        if (auto hull = convex::Hull::build(posed_mesh(instance, entry).positions, {.max_vertices = kHullVertices}))
            entry.hull = std::move(*hull);
    return entry.hull ? &*entry.hull : nullptr;
}

std::optional<mesh::TriangleHit> raycast_placed(const Ray& ray, const mesh::MeshTree& tree, const Transform& world) {
    const glm::dmat3 inverse = glm::inverse(world.linear);
    for (int k = 0; k < 9; ++k)
        if (!std::isfinite(inverse[k / 3][k % 3])) return std::nullopt;
    return mesh::raycast(Ray{inverse * (ray.origin - world.translation), inverse * ray.direction, ray.max_t}, tree);
}

std::optional<mesh::TriangleHit> InstanceShapes::raycast(const Ray& ray, scene::InstanceId instance) {
    const mesh::MeshTree* tree = tree_of(instance, of_mesh_[scene_->mesh_of(instance)]);
    if (tree == nullptr) return std::nullopt;
    return raycast_placed(ray, *tree, scene_->world(scene_->node_of(instance)));
}

std::vector<TriangleContacts> InstanceShapes::triangle_contacts(std::span<const InstancePair> pairs) {
    std::vector<TriangleContacts> result;
    Vector<mesh::MeshContact> found;
    for (const auto& [first, second] : pairs) {
        const Placed a = place(first), b = place(second);
        const mesh::MeshTree *tree_a = tree_of(first, *a.entry), *tree_b = tree_of(second, *b.entry);
        if (tree_a == nullptr || tree_b == nullptr) continue;
        mesh::contacts(*tree_a, *tree_b, relative(a.pose, b.pose), found);
        if (found.empty()) continue;
        TriangleContacts& contacts = result.emplace_back();
        contacts.first = first, contacts.second = second;
        for (const mesh::MeshContact& contact : found) contacts.triangles.push_back(moved(contact, a.pose));
    }
    return result;
}

std::vector<HullContacts> InstanceShapes::hull_contacts(std::span<const InstancePair> pairs) {
    ++calls_;
    std::vector<HullContacts> result;
    for (const auto& [first, second] : pairs) {
        const Placed a = place(first), b = place(second);
        const convex::Hull *hull_a = hull_of(first, *a.entry), *hull_b = hull_of(second, *b.entry);
        if (hull_a == nullptr || hull_b == nullptr) continue;
        const convex::Shape shape_a = convex::Shape::hull(*hull_a), shape_b = convex::Shape::hull(*hull_b);
        Kept& kept = kept_[{first, second}];
        kept.call = calls_;
        const convex::Manifold manifold =
            convex::contact_manifold({shape_a, a.pose}, {shape_b, b.pose}, {}, &kept.cache);
        const std::size_t manifolds = manifold.count > 0 ? 1 : 0;
        convex::track(std::span(&manifold, manifolds), kept.points);
        if (manifolds > 0) result.push_back({first, second, kept.points});
    }
    std::erase_if(kept_, [&](const auto& entry) { return entry.second.call != calls_; });
    return result;
}

bool InstanceShapes::outline(scene::InstanceId instance, convex::LineVisitor line) {
    const Placed placed = place(instance);
    const convex::Hull* hull = hull_of(instance, *placed.entry);
    if (hull == nullptr) return false;
    const convex::Shape shape = convex::Shape::hull(*hull);
    convex::outline({shape, placed.pose}, line);
    return true;
}

}  // namespace crofton::viewer
