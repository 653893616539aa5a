// SPDX-License-Identifier: MIT
// What is asked between updates.
#include <algorithm>
#include <cmath>
#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "ray_ball.hpp"
#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {
namespace {

Aabb bounds_of(const Obb& box) {
    return aabb_of(box);
}
// Sums round by 2^-53 of themselves.
Aabb bounds_of(const Sphere& ball) {
    const glm::dvec3 half_size = ball.radius + 0x1p-50 * (glm::abs(ball.center) + ball.radius);
    return {ball.center - half_size, ball.center + half_size};
}
Aabb bounds_of(const collide::Capsule& capsule) {
    Aabb bounds = bounds_of(Sphere{capsule.begin, capsule.radius});
    bounds.include(bounds_of(Sphere{capsule.end, capsule.radius}));
    return bounds;
}

bool is_valid(const Obb& box) {
    return validate(box).has_value();
}
bool is_valid(const Sphere& ball) {
    return is_in_range(ball);
}
bool is_valid(const collide::Capsule& capsule) {
    return is_in_range(capsule.begin) && is_in_range(Sphere{capsule.end, capsule.radius});
}

bool meets_ball(const Obb& shape, const Sphere& ball) {
    return collide::intersects(shape, ball);
}
bool meets_ball(const Sphere& shape, const Sphere& ball) {
    return glm::length(shape.center - ball.center) <= shape.radius + ball.radius;
}
bool meets_ball(const collide::Capsule& shape, const Sphere& ball) {
    return collide::distance(shape, ball).distance <= 0.0;
}

// From the shape to an object's bound.
collide::Distance gap_to(const Obb& shape, const world::Object& object, const Obb& box) {
    if (object.kind != BoundKind::ball) return collide::distance(shape, box);
    return collide::distance(shape, collide::Capsule{box.center, box.center, object.radius});
}
collide::Distance gap_to(const collide::Capsule& shape, const world::Object& object, const Obb& box) {
    if (object.kind == BoundKind::ball) return collide::distance(shape, world::ball_of(object, box));
    collide::Distance gap = collide::distance(box, shape);
    std::swap(gap.on_a, gap.on_b);
    return gap;
}

// Whether a matrix can be inverted. A product of rotations and a flat scale may keep a determinant of rounding: 2^-52
// of the product of its columns' lengths. The inverse of one that passes is off by a thousandth of the mesh's size at
// most, and by rounding where nothing is nearly flat.
bool is_invertible(const glm::dmat3& m) {
    double sizes = 1.0;
    for (int k = 0; k < 3; ++k) sizes *= std::abs(m[k].x) + std::abs(m[k].y) + std::abs(m[k].z);
    return std::abs(glm::determinant(m)) > 1e-12 * sizes;
}

// No further than rounding tells: boxes apart by less are near. Axes deviate by 1e-4 each (kMaxAxisDeviation), which
// lengthens a diagonal by 1.5e-4.
double gap_between(const Aabb& a, const Obb& box) {
    const glm::dvec3 radius(glm::length(glm::dvec3(box.half_extents)) * (1.0 + 2e-4));
    const glm::dvec3 gap = glm::max(glm::max(box.center - radius - a.max, a.min - box.center - radius), 0.0);
    return std::max({gap.x, gap.y, gap.z});
}

}  // namespace

Result<void> World::view(const Camera& camera, VisibleObjects& visible, const cull::CullOptions& options,
                         Executor& executor) const {
    const auto frustum = frustum_of(camera);
    if (!frustum) return tl::unexpected(frustum.error());
    view(cull::View{.frustum = *frustum}, visible, options, executor);
    return {};
}

std::span<const std::uint64_t> World::State::among_and_changed(std::span<const std::uint64_t> among,
                                                               Vector<std::uint64_t>& both) const {
    const std::span<const std::uint64_t> changed = index.changed();
    if (changed.empty()) return among;
    both.assign(among.begin(), among.end());
    for (std::size_t w = 0; w < std::min(both.size(), changed.size()); ++w) both[w] |= changed[w];
    return both;
}

void World::view(const cull::View& view, VisibleObjects& visible, const cull::CullOptions& options,
                 Executor& executor) const {
    const world::TraceZone zone(state_->options.trace, "World::view");
    visible.names_ = &state_->table.names;
    visible.hides_ = false;
    cull::CullOptions how = options;
    how.among = state_->among_and_changed(options.among, visible.among_);
    cull::find_visible(state_->index.tree(), state_->index.moving(), view, visible.set_, how, executor);
    world::trace_count(state_->options.trace, "objects in view", visible.set_.size());
}

void World::view(std::span<const cull::View> views, VisibleInViews& visible, cull::CullMode mode) const {
    const world::TraceZone zone(state_->options.trace, "World::view of many");
    visible.names_ = &state_->table.names;
    visible.hides_ = false;
    cull::find_visible(state_->index.tree(), state_->index.moving(), views, visible.set_, mode);
}

void World::State::visit_along(const Ray& ray, std::uint32_t layers, collide::RayVisitor visit) const {
    Ray rest = ray;
    const auto visit_living = [&](std::uint32_t object, double t) {
        if (table.objects[object].alive) rest.max_t = visit(object, t);
        return rest.max_t;
    };
    collide::visit_along(ray, index.tree(), visit_living, layers);
    const cull::MovingBoxes& moving = index.moving();
    index.visit_movers_along(rest, [&](std::size_t i) {
        if (rest.max_t < 0.0) return false;
        if ((index.layers(moving.items()[i]) & layers) == 0) return true;
        if (const auto t = mesh::raycast(rest, moving.boxes()[i])) visit_living(moving.items()[i], *t);
        return true;
    });
}

std::optional<ObjectHit> World::State::shape_hit(const Ray& ray, std::uint32_t id, double box_t) const {
    const world::Object& object = table.objects[id];
    ObjectHit hit{table.handle(id), table.names.users[id], box_t, {}, kNoTriangle};
    if (const mesh::MeshTree* tree = bodies.mesh_tree_of(object)) {
        const scene::Transform& world = scene.world(scene.node_of(object.instance));
        if (is_invertible(world.linear)) {
            const glm::dmat3 inverse = glm::inverse(world.linear);
            const auto on_mesh = mesh::raycast(
                Ray{inverse * (ray.origin - world.translation), inverse * ray.direction, ray.max_t}, *tree);
            if (!on_mesh) return std::nullopt;
            hit.t = on_mesh->t;
            hit.triangle = on_mesh->triangle;
        }
    } else if (object.kind == BoundKind::ball) {
        const auto t = world::raycast(ray, {index.box(id).center, object.radius});
        if (!t) return std::nullopt;
        hit.t = *t;
    }
    hit.point = ray.origin + hit.t * ray.direction;
    return hit;
}

std::optional<ObjectHit> World::raycast(const Ray& ray, std::uint32_t layers) const {
    std::optional<ObjectHit> nearest;
    Ray rest = ray;
    state_->visit_along(ray, layers, [&](std::uint32_t object, double t) {
        const auto hit = state_->shape_hit(rest, object, t);
        if (hit && (!nearest || hit->t < nearest->t || object < nearest->object.index)) {
            nearest = hit;
            rest.max_t = hit->t;
        }
        return rest.max_t;
    });
    return nearest;
}

bool World::raycast_any(const Ray& ray, std::uint32_t layers) const {
    bool any = false;
    state_->visit_along(ray, layers, [&](std::uint32_t object, double t) {
        any = any || state_->shape_hit(ray, object, t).has_value();
        return any ? -1.0 : ray.max_t;
    });
    return any;
}

void World::raycast_all(const Ray& ray, Vector<ObjectHit>& hits, std::uint32_t layers) const {
    hits.clear();
    state_->visit_along(ray, layers, [&](std::uint32_t object, double t) {
        if (const auto hit = state_->shape_hit(ray, object, t)) hits.push_back(*hit);
        return ray.max_t;
    });
    std::sort(hits.begin(), hits.end(), [](const ObjectHit& a, const ObjectHit& b) {
        return a.t != b.t ? a.t < b.t : a.object.index < b.object.index;
    });
}

void World::State::visit_near(const Aabb& bounds, double distance, std::uint32_t layers,
                              collide::NearVisitor visit) const {
    const auto visit_living = [&](std::uint32_t object) {
        if (table.objects[object].alive) distance = visit(object);
        return distance;
    };
    collide::visit_near(bounds, distance, index.tree(), visit_living, layers);
    const cull::MovingBoxes& moving = index.moving();
    index.visit_movers_near(bounds, distance, [&](std::size_t i) {
        if ((index.layers(moving.items()[i]) & layers) != 0 && gap_between(bounds, moving.boxes()[i]) <= distance)
            visit_living(moving.items()[i]);
        return true;
    });
}

template <class Shape>
void World::State::overlap(const Shape& shape, Vector<ObjectRef>& found, std::uint32_t layers) const {
    found.clear();
    if (!is_valid(shape)) return;
    visit_near(bounds_of(shape), 0.0, layers, [&](std::uint32_t id) {
        const world::Object& object = table.objects[id];
        const Obb& box = index.box(id);
        const bool meets = object.kind == BoundKind::ball ? meets_ball(shape, Sphere{box.center, object.radius})
                                                          : collide::intersects(box, shape);
        if (meets) found.push_back(table.ref(id));
        return 0.0;
    });
    std::sort(found.begin(), found.end(),
              [](const ObjectRef& a, const ObjectRef& b) { return a.object.index < b.object.index; });
}

void World::overlap(const Obb& shape, Vector<ObjectRef>& found, std::uint32_t layers) const {
    state_->overlap(shape, found, layers);
}
void World::overlap(const Sphere& shape, Vector<ObjectRef>& found, std::uint32_t layers) const {
    state_->overlap(shape, found, layers);
}
void World::overlap(const collide::Capsule& shape, Vector<ObjectRef>& found, std::uint32_t layers) const {
    state_->overlap(shape, found, layers);
}

// A limit that is rounded to 0 grows too; one without end is beyond all that boxes and shapes may be.
constexpr double kLeastGrowth = 1e-300, kFarthest = 1e300;

// Within a small distance first: the tree is entered in no order of nearness.
std::optional<ClosestObject> World::State::closest(const Aabb& bounds, double max_distance, std::uint32_t layers,
                                                   GapTo gap_to_object) const {
    std::optional<ClosestObject> nearest;
    if (!(max_distance >= 0.0)) return nearest;
    max_distance = std::min(max_distance, kFarthest);
    for (double limit = max_distance * 0x1p-12;; limit = std::min(std::max(8.0 * limit, kLeastGrowth), max_distance)) {
        double rest = limit;
        visit_near(bounds, limit, layers, [&](std::uint32_t id) {
            const collide::Distance gap = gap_to_object(id);
            const bool nearer = !nearest || gap.distance < nearest->distance ||
                                (gap.distance == nearest->distance && id < nearest->object.index);
            if (gap.distance > rest || !nearer) return rest;
            nearest = ClosestObject{table.handle(id), table.names.users[id], gap.distance, gap.on_a, gap.on_b};
            return rest = gap.distance;
        });
        if (nearest || limit == max_distance) return nearest;
    }
}

template <class Shape>
std::optional<ClosestObject> World::State::closest(const Shape& shape, double max_distance,
                                                   std::uint32_t layers) const {
    if (!is_valid(shape)) return std::nullopt;
    return closest(bounds_of(shape), max_distance, layers,
                   [&](std::uint32_t id) { return gap_to(shape, table.objects[id], index.box(id)); });
}

std::optional<ClosestObject> World::closest(const Sphere& shape, double max_distance, std::uint32_t layers) const {
    return state_->closest(collide::Capsule{shape.center, shape.center, shape.radius}, max_distance, layers);
}
std::optional<ClosestObject> World::closest(const Obb& shape, double max_distance, std::uint32_t layers) const {
    return state_->closest(shape, max_distance, layers);
}
std::optional<ClosestObject> World::closest(const collide::Capsule& shape, double max_distance,
                                            std::uint32_t layers) const {
    return state_->closest(shape, max_distance, layers);
}

}  // namespace crofton
