// SPDX-License-Identifier: MIT
// Which objects have bodies, and where these stand.
#include "body_contacts.hpp"

namespace crofton::world {

std::optional<RigidTransform> pose_of(const Object& object, const Obb& box, const scene::Scene& scene) {
    RigidTransform pose{glm::dmat3(1.0), box.center};
    if (object.kind == BoundKind::none) {
        const Transform& world = scene.world(scene.node_of(object.instance));
        pose = {glm::dmat3(world.linear), world.translation};
    } else if (object.kind != BoundKind::ball) {
        pose.rotation = glm::dmat3(box.axes);
    }
    if (!convex::validate_pose(pose)) return std::nullopt;
    return pose;
}

void BodyContacts::set(std::uint32_t object, const convex::Body* body) {
    if (has(object)) --count_;
    note(object);
    if (body == nullptr) {
        if (object < bodies_.size()) bodies_[object].reset();
        return;
    }
    if (object >= bodies_.size()) bodies_.resize(object + std::size_t{1});
    bodies_[object] = *body;
    ++count_;
}

}  // namespace crofton::world
