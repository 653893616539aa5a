// SPDX-License-Identifier: MIT
#include "object_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/same_bits.hpp>
#include <crofton/scene/transformed_box.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "rigid.hpp"

namespace crofton::world {
namespace {

constexpr double kGrowth = 1.0 + 1e-3;    // of margins: axes are unit vectors within 1e-4
constexpr double kSlack = 1.0 + 0x1p-40;  // outweighs what bounds of shapes are rounded by

// As validate_pose tells; what is clearly a rotation is told without its words.
bool is_rigid(const glm::dmat3& linear) {
    return is_clearly_rotation(linear) || convex::validate_pose({linear, glm::dvec3(0.0)}).has_value();
}

bool has_nothing(const glm::dmat3& linear) {
    return linear[0] == glm::dvec3(0.0) && linear[1] == glm::dvec3(0.0) && linear[2] == glm::dvec3(0.0);
}

// From and to these coordinates along the axes from the box's centre, with its axes.
Obb spanning(const Obb& box, const glm::dvec3& from, const glm::dvec3& to) {
    Obb result = box;
    result.center = box.center + glm::dmat3(box.axes) * (0.5 * (from + to));
    const glm::dvec3 size = glm::abs(result.center);
    result.half_extents = rounded_up(0.5 * (to - from), 0x1p-50 * (size.x + size.y + size.z));
    return result;
}

}  // namespace

glm::vec3 rounded_up(const glm::dvec3& half, double rounding) {
    return glm::vec3(half * (1.0 + 0x1p-22) + (rounding * (1.0 + 0x1p-22) + 0x1p-149));
}

RigidTransform frame_of(BoundKind kind, const Obb& box) {
    RigidTransform frame{glm::dmat3(1.0), box.center};
    if (kind == BoundKind::sphere || is_rigid(glm::dmat3(box.axes))) {
        if (kind != BoundKind::sphere) frame.rotation = glm::dmat3(box.axes);
        return frame;
    }
    // Axes of boxes may be off by more than those of poses, or left-handed.
    glm::dmat3 axes(box.axes);
    axes[0] = glm::normalize(axes[0]);
    axes[1] = glm::normalize(axes[1] - glm::dot(axes[0], axes[1]) * axes[0]);
    axes[2] = glm::cross(axes[0], axes[1]);
    frame.rotation = axes;
    return frame;
}

Obb box_with_margin(const Obb& box, const convex::Shape& shape, const RigidTransform& pose, double margin) {
    const glm::dvec3 given(box.half_extents), tight = shape.bounds().half_extents() * (1.0 + 1e-5) + 1e-3 * margin;
    if (!(given.x <= tight.x && given.y <= tight.y && given.z <= tight.z)) return box_around(box, shape, pose, margin);
    const glm::dvec3 grown = given + margin * kGrowth;
    return spanning(box, -grown, grown);
}

Obb box_around(const Obb& box, const convex::Shape& shape, const RigidTransform& pose, double margin) {
    const glm::dmat3 axes(box.axes), to_box = glm::inverse(axes), turn = to_box * pose.rotation;
    const glm::dvec3 origin = to_box * (pose.translation - box.center), given(box.half_extents);
    const double grown_by = margin * kGrowth;
    glm::dvec3 low(0.0), high(0.0);
    const auto covers = [&] {
        for (int k = 0; k < 3; ++k)
            if (!(-low[k] <= given[k] * kSlack && high[k] <= given[k] * kSlack)) return false;
        return true;
    };
    const Aabb& bounds = shape.bounds();
    const glm::dvec3 middle = origin + turn * bounds.center(), half = bounds.half_extents();
    glm::dvec3 needed(grown_by);
    for (int k = 0; k < 3; ++k) needed += half[k] * glm::abs(turn[k]);
    low = middle - needed;
    high = middle + needed;
    if (covers()) return box;
    if (shape.is_convex()) {
        // As far as the shape itself reaches along each of the box's coordinates.
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 along(turn[0][k], turn[1][k], turn[2][k]);
            const double rounding = 0x1p-48 * glm::length(along) * (shape.core_radius() + shape.radius());
            high[k] = origin[k] + glm::dot(along, convex::support_point(shape, along)) + rounding + grown_by;
            low[k] = origin[k] + glm::dot(along, convex::support_point(shape, -along)) - rounding - grown_by;
        }
        if (covers()) return box;
    }
    return spanning(box, glm::min(-given, low), glm::max(given, high));
}

// The axes are the pose's but for their rounding to float, which tilts the shape a little in the box.
Obb box_around(const convex::Shape& shape, const RigidTransform& pose) {
    const glm::dvec3 middle = shape.bounds().center(), half = shape.bounds().half_extents();
    Obb box{pose.rotation * middle + pose.translation, glm::mat3(pose.rotation), glm::vec3(0.0f)};
    const glm::dmat3 tilt = glm::transpose(pose.rotation) * (glm::dmat3(box.axes) - pose.rotation);
    glm::dvec3 needed = half * kSlack;
    for (int k = 0; k < 3; ++k) needed += (1.0 + 1e-5) * half[k] * glm::abs(tilt[k]);
    const glm::dvec3 size = glm::abs(middle) + glm::abs(pose.translation);
    box.half_extents = rounded_up(needed, 0x1p-49 * (size.x + size.y + size.z));
    return box;
}

void ObjectShapes::list_unbounded(std::uint32_t object) {
    const auto place = std::lower_bound(unbounded_.begin(), unbounded_.end(), object);
    const bool listed = place != unbounded_.end() && *place == object;
    if (listed == is_unbounded(object)) return;
    if (listed)
        unbounded_.erase(place);
    else
        unbounded_.insert(place, object);
}

void ObjectShapes::set(std::uint32_t object, const convex::Shape* shape) {
    if (shape == nullptr && !has(object)) return;
    if (object >= entries_.size()) entries_.resize(object + std::size_t{1});
    if (!entries_[object]) entries_[object] = Owner<Entry>::make();
    Entry& entry = *entries_[object];
    count_ -= entry.own ? 1 : 0;
    count_ += shape != nullptr ? 1 : 0;
    entry.own.reset();
    if (shape != nullptr) entry.own = *shape;
    entry.scaled.reset();
    entry.nowhere = false;
    entry.mesh_revision = 0;
    fresh_.push_back(object);
    list_unbounded(object);
}

void ObjectShapes::forget(std::uint32_t object) {
    if (!is_known(object)) return;
    count_ -= entries_[object]->own ? 1 : 0;
    entries_[object] = {};
    list_unbounded(object);
}

PlacedShape ObjectShapes::take(std::uint32_t object) {
    Entry& entry = *entries_[object];
    PlacedShape taken{std::move(entry.own), std::move(entry.scaled), std::nullopt};
    forget(object);
    return taken;
}

std::optional<RigidTransform> ObjectShapes::pose_of(std::uint32_t id, const Object& object, const Obb& box,
                                                    const scene::Scene& scene) const {
    const Entry& entry = *entries_[id];
    if (object.instance == kNoIndex) {
        if (entry.given.kind != BoundKind::none) return frame_of(entry.given.kind, entry.given.box);
        return frame_of(object.kind, box);
    }
    const Transform& world = scene.world(scene.node_of(object.instance));
    if (entry.nowhere || has_nothing(world.linear)) return std::nullopt;
    if (entry.scaled) return RigidTransform{entry.map.rotation, world.translation};
    return RigidTransform{world.linear, world.translation};
}

glm::vec3 ObjectShapes::least_half_extents(std::uint32_t object) const {
    if (!has(object) || !shape(object).is_bounded()) return glm::vec3(-1.0f);
    const Aabb& bounds = shape(object).bounds();
    const glm::dvec3 reach = glm::max(glm::abs(bounds.min), glm::abs(bounds.max)) / kSlack;
    glm::vec3 least(reach);
    for (int k = 0; k < 3; ++k)
        if (static_cast<double>(least[k]) < reach[k]) least[k] = std::nextafter(least[k], HUGE_VALF);
    return least;
}

bool ObjectShapes::fits(std::uint32_t object, const Bound& bound) const {
    const convex::Shape& of = shape(object);
    if (!of.is_bounded()) return true;
    if (bound.kind == BoundKind::sphere) return of.core_radius() + of.radius() <= bound.radius * kSlack;
    if (!is_rigid(glm::dmat3(bound.box.axes))) return false;
    const glm::vec3 least = least_half_extents(object), &half = bound.box.half_extents;
    return half.x >= least.x && half.y >= least.y && half.z >= least.z;
}

Result<void> ObjectShapes::scale(std::uint32_t object, const glm::dmat3& linear) {
    Entry& entry = *entries_[object];
    entry.nowhere = false;
    if (is_rigid(linear) || has_nothing(linear)) {
        entry.scaled.reset();
        return {};
    }
    SplitMap map = split(linear);
    const auto same = [&] {
        double most = 0.0, size = 0.0;
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i) {
                most = std::max(most, std::abs(map.rest[k][i] - entry.map.rest[k][i]));
                size = std::max(size, std::abs(map.rest[k][i]));
            }
        return most <= 1e-12 * size;
    };
    if (entry.scaled && same()) {
        entry.map.rotation = map.rotation;
        return {};
    }
    auto scaled = ScaledShape::make(*entry.own, map, object);
    entry.scaled.reset();
    entry.nowhere = !scaled;
    if (!scaled) return scaled.error();
    entry.map = map;
    entry.scaled = std::move(*scaled);
    return {};
}

Result<void> ObjectShapes::check(const convex::Shape& shape, const glm::dmat3& linear, std::uint64_t item) {
    if (is_rigid(linear) || has_nothing(linear)) return {};
    const auto scaled = ScaledShape::make(shape, split(linear), item);
    if (!scaled) return scaled.error();
    return {};
}

Bound ObjectShapes::cover(std::uint32_t object, const Bound& bound) {
    Entry& entry = *entries_[object];
    entry.given = {};
    if (!entry.own || fits(object, bound) || !shape(object).is_bounded()) return bound;
    if (bound.kind != BoundKind::sphere && is_rigid(glm::dmat3(bound.box.axes))) {  // as in frame_of
        const glm::dvec3 given(bound.box.half_extents);
        const Aabb& bounds = shape(object).bounds();
        entry.given = bound;
        return Bound(spanning(bound.box, glm::min(-given, bounds.min * kSlack), glm::max(given, bounds.max * kSlack)));
    }
    const Obb box = box_around(bound.box, shape(object), frame_of(bound.kind, bound.box), 0.0);
    // A sphere stands for itself in pairs: what is in its cube alone would be missed.
    if (bound.kind != BoundKind::sphere && have_same_bits(box, bound.box)) return bound;
    entry.given = bound;
    return Bound(box);
}

// The scene's box holds the image of all that the mesh's box holds. So a rigid transform needs a look at the shape only
// where the shape or the mesh is another.
Obb ObjectShapes::cover(std::uint32_t object, scene::InstanceId instance, const scene::Scene& scene, bool alone) {
    Entry& entry = *entries_[object];
    const Obb& box = scene.world_boxes()[instance];
    const Transform& world = scene.world(scene.node_of(instance));
    if (entry.nowhere || has_nothing(world.linear) || !shape(object).is_bounded()) return box;
    if (alone) {
        const glm::dmat3& rotation = entry.scaled ? entry.map.rotation : world.linear;
        return box_around(shape(object), {rotation, world.translation});
    }
    if (entry.scaled) return box_around(box, shape(object), {entry.map.rotation, world.translation}, 0.0);
    const scene::MeshId mesh = scene.mesh_of(instance);
    if (entry.mesh_revision != scene.mesh_revision(mesh)) {
        entry.mesh_revision = scene.mesh_revision(mesh);
        entry.around_mesh = box_around(scene.mesh_box(mesh), *entry.own, {}, 0.0);
        entry.exceeds_mesh = !have_same_bits(entry.around_mesh, scene.mesh_box(mesh));
    }
    if (!entry.exceeds_mesh) return box;
    const auto around = scene::transformed_box(world, entry.around_mesh, measure::minimal_perimeter());
    return around ? *around : box_around(box, *entry.own, {world.linear, world.translation}, 0.0);
}

Obb ObjectShapes::collider_box(std::uint32_t id, const Object& object, const Obb& box, const scene::Scene& scene,
                               double margin) const {
    if (margin == 0.0 || !has(id)) return box;
    const auto pose = pose_of(id, object, box, scene);
    return pose && shape(id).is_bounded() ? box_with_margin(box, shape(id), *pose, margin) : box;
}

}  // namespace crofton::world
