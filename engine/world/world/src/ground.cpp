// SPDX-License-Identifier: MIT
#include "ground.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "contact_list.hpp"
#include "pair_order.hpp"
#include "world_state.hpp"

namespace crofton {
namespace world {
namespace {

constexpr double kFar = 4e30;  // beyond all boxes

double height_of(const Plane& plane, const glm::dvec3& point) {
    return glm::dot(plane.normal, point) + plane.offset;
}

Aabb bounds_of(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 half = shape.bounds().half_extents();
    glm::dvec3 size(0.0);
    for (int k = 0; k < 3; ++k) size += half[k] * glm::abs(pose.rotation[k]);
    const glm::dvec3 center = pose.rotation * shape.bounds().center() + pose.translation;
    size = size * (1.0 + 1e-9) + 1e-12 * glm::abs(center);
    return {center - size, center + size};
}

}  // namespace

void GroundShape::add(const convex::Shape& shape, const RigidTransform& pose) {
    if (shape.is_bounded()) return rest.include(bounds_of(shape, pose));
    if (shape.kind() == convex::Kind::half_space) {
        const glm::dvec3 normal = glm::transpose(glm::inverse(pose.rotation)) * shape.plane().normal;
        const double length = glm::length(normal);
        const glm::dvec3 unit = normal / length;
        planes.push_back({unit, shape.plane().offset / length - glm::dot(unit, pose.translation)});
        return;
    }
    for (const convex::CompoundChild& child : shape.compound()->children())
        add(child.shape,
            {pose.rotation * child.pose.rotation, pose.rotation * child.pose.translation + pose.translation});
}

bool GroundShape::is_near(const Obb& box, double margin) const {
    for (const Plane& plane : planes) {
        double reach = margin * (1.0 + 1e-9);
        for (int k = 0; k < 3; ++k)
            reach +=
                static_cast<double>(box.half_extents[k]) * std::abs(glm::dot(plane.normal, glm::dvec3(box.axes[k])));
        const glm::dvec3 c = glm::abs(box.center);
        const double rounding = 1e-14 * (c.x + c.y + c.z + std::abs(plane.offset) + reach);
        if (height_of(plane, box.center) >= -reach - rounding) return true;
    }
    if (rest.min.x > rest.max.x) return false;
    const Aabb bounds = aabb_of(box);
    for (int k = 0; k < 3; ++k)
        if (bounds.min[k] > rest.max[k] + margin || bounds.max[k] < rest.min[k] - margin) return false;
    return true;
}

Aabb GroundShape::around(const Plane& plane) {
    Aabb bounds{glm::dvec3(-kFar), glm::dvec3(kFar)};
    for (int k = 0; k < 3; ++k) {
        if (plane.normal[(k + 1) % 3] != 0.0 || plane.normal[(k + 2) % 3] != 0.0) continue;
        const double level = -plane.offset / plane.normal[k], slack = 1e-14 * std::abs(level);
        if (plane.normal[k] < 0.0)
            bounds.max[k] = level + slack;
        else
            bounds.min[k] = level - slack;
    }
    return bounds;
}

void Ground::start() {
    before_.clear();
    for (const Touching& touch : touching_) before_.push_back(touch.pair);
    pairs_.clear();
    touching_.clear();
    points_.clear();
}

void Ground::merge_pairs(std::span<const ObjectPair> found) {
    std::sort(pairs_.begin(), pairs_.end(), is_before);
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end(), are_same), pairs_.end());
    all_pairs_.resize(found.size() + pairs_.size());
    std::merge(found.begin(), found.end(), pairs_.begin(), pairs_.end(), all_pairs_.begin(), is_before);
}

void Ground::add_contact(const ObjectPair& pair, const ShapeTouch& touch) {
    Touching& touching = touching_.emplace_back();
    touching.pair = pair;
    touching.first_point = static_cast<std::uint32_t>(points_.size());
    touch.write_to(touching, points_);
    touching.point_count = static_cast<std::uint32_t>(points_.size()) - touching.first_point;
}

void Ground::merge_contacts(std::span<const Contact> found) {
    Vector<Contact> own;
    std::size_t old = 0;
    const auto add_ended = [&](const ObjectPair& pair) {
        Contact& contact = own.emplace_back();
        contact.first = pair.first;
        contact.second = pair.second;
        contact.phase = ContactPhase::ended;
    };
    for (const Touching& touch : touching_) {
        for (; old < before_.size() && is_before(before_[old], touch.pair); ++old) add_ended(before_[old]);
        const bool met = old < before_.size() && !is_before(touch.pair, before_[old]);
        const bool stayed = met && are_same(before_[old], touch.pair);
        if (met && !stayed) add_ended(before_[old]);
        old += met ? 1 : 0;
        Contact& contact = own.emplace_back();
        contact.first = touch.pair.first;
        contact.second = touch.pair.second;
        contact.phase = stayed ? ContactPhase::stayed : ContactPhase::began;
        contact.normal = touch.normal;
        contact.depth = touch.depth;
        contact.inside = touch.inside;
        contact.points = {points_.data() + touch.first_point, touch.point_count};
    }
    for (; old < before_.size(); ++old) add_ended(before_[old]);
    world::merge_contacts(found, own, all_contacts_);
}

void Ground::stay() {
    std::size_t kept = 0;
    for (Contact& contact : all_contacts_) {
        if (contact.phase == ContactPhase::ended) continue;
        contact.phase = ContactPhase::stayed;
        all_contacts_[kept++] = contact;
    }
    all_contacts_.resize(kept);
}

}  // namespace world

world::GroundShape World::State::ground_shape(std::uint32_t id) const {
    world::GroundShape own;
    if (const auto pose = object_shapes.pose_of(id, table.objects[id], index.box(id), scene))
        own.add(object_shapes.shape(id), *pose);
    return own;
}

bool World::State::is_ground(std::uint32_t id, std::uint32_t layers) const {
    return table.objects[id].alive && index.is_placed(id) && (index.layers(id) & layers) != 0;
}

// The pairs of ground with all that it may meet, and contacts with what has no shape.
void World::State::update_ground() {
    ground.start();
    const double margin = options.contact_margin;
    for (const std::uint32_t id : object_shapes.unbounded()) {
        const world::Object& object = table.objects[id];
        if (!is_ground(id, ~0u) || object.collides_with == 0) continue;
        const world::GroundShape own = ground_shape(id);
        const auto add = [&](std::uint32_t other) {
            if ((index.layers(id) & table.objects[other].collides_with) == 0 ||
                (index.layers(other) & object.collides_with) == 0)
                return;
            ground.add({table.ref(std::min(id, other)), table.ref(std::max(id, other))});
        };
        for (const std::uint32_t other : object_shapes.unbounded())
            if (other > id && is_ground(other, ~0u)) add(other);
        const auto visit = [&](std::uint32_t other) {
            if (own.is_near(index.box(other), object_shapes.has(other) ? margin : 0.0)) add(other);
            return margin;
        };
        for (const Plane& plane : own.planes) visit_bounded_near(world::GroundShape::around(plane), margin, ~0u, visit);
        if (own.rest.min.x <= own.rest.max.x) visit_bounded_near(own.rest, margin, ~0u, visit);
    }
    ground.merge_pairs(finder.pairs());
}

void World::State::update_ground_contacts() {
    for (const ObjectPair& pair : ground.own_pairs()) {
        const std::uint32_t a = pair.first.object.index, b = pair.second.object.index;
        if (object_shapes.has(a) && object_shapes.has(b)) continue;
        touch_shape({a, b}, ground.shape_touch);
        if (ground.shape_touch.hit()) ground.add_contact(pair, ground.shape_touch);
    }
    ground.merge_contacts(finder.contacts());
}

}  // namespace crofton
