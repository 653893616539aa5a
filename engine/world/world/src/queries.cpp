// SPDX-License-Identifier: MIT
// World's queries between updates.
#include <algorithm>
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
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

#include "ray_normal.hpp"
#include "ray_sphere.hpp"
#include "rigid.hpp"
#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {
namespace {

Aabb bounds_of(const Obb& box) {
    return aabb_of(box);
}
// Sums round by 2^-53 of themselves.
Aabb bounds_of(const Sphere& sphere) {
    const glm::dvec3 half_size = sphere.radius + 0x1p-50 * (glm::abs(sphere.center) + sphere.radius);
    return {sphere.center - half_size, sphere.center + half_size};
}
Aabb bounds_of(const collide::Capsule& capsule) {
    Aabb bounds = bounds_of(Sphere{capsule.begin, capsule.radius});
    bounds.include(bounds_of(Sphere{capsule.end, capsule.radius}));
    return bounds;
}

bool is_valid(const Obb& box) {
    return validate(box).has_value();
}
bool is_valid(const Sphere& sphere) {
    return is_in_range(sphere);
}
bool is_valid(const collide::Capsule& capsule) {
    return is_in_range(capsule.begin) && is_in_range(Sphere{capsule.end, capsule.radius});
}

bool meets_sphere(const Obb& probe, const Sphere& sphere) {
    return collide::intersects(probe, sphere);
}
bool meets_sphere(const Sphere& probe, const Sphere& sphere) {
    return glm::length(probe.center - sphere.center) <= probe.radius + sphere.radius;
}
bool meets_sphere(const collide::Capsule& probe, const Sphere& sphere) {
    return collide::distance(probe, sphere).distance <= 0.0;
}

// From the probe to an object's bound.
collide::Distance gap_to(const Obb& probe, const world::Object& object, const Obb& box) {
    if (object.kind != BoundKind::sphere) return collide::distance(probe, box);
    return collide::distance(probe, collide::Capsule{box.center, box.center, object.radius});
}
collide::Distance gap_to(const collide::Capsule& probe, const world::Object& object, const Obb& box) {
    if (object.kind == BoundKind::sphere) return collide::distance(probe, world::sphere_of(object, box));
    collide::Distance gap = collide::distance(box, probe);
    std::swap(gap.on_a, gap.on_b);
    return gap;
}

// A ray whose direction is far from 1 in size, with one near 1: its parameters are the caller's times `per_t`, a power
// of two. Others, and those that are none, stay as they are.
struct EvenRay {
    Ray ray;
    int exponent = 0;

    explicit EvenRay(const Ray& of) : ray(of) {
        const glm::dvec3 size = glm::abs(of.direction);
        const double most = std::max(size.x, std::max(size.y, size.z));
        if (!(most > 0.0 && std::isfinite(most)) || (most >= 0x1p-100 && most <= 0x1p100)) return;
        exponent = std::ilogb(most);
        for (int k = 0; k < 3; ++k) ray.direction[k] = std::scalbn(of.direction[k], -exponent);
        ray.max_t = std::scalbn(of.max_t, exponent);
    }
    void restore(ObjectHit& hit) const {
        if (exponent != 0) hit.t = std::scalbn(hit.t, -exponent);
    }
};

// No further than rounding tells: boxes apart by less are near. Axes deviate by 1e-4 each (kMaxAxisDeviation), which
// lengthens a diagonal by 1.5e-4.
double gap_between(const Aabb& a, const Obb& box) {
    const glm::dvec3 radius(glm::length(glm::dvec3(box.half_extents)) * (1.0 + 2e-4));
    const glm::dvec3 gap = glm::max(glm::max(box.center - radius - a.max, a.min - box.center - radius), 0.0);
    return glm::length(gap) * (1.0 - 1e-15);
}

// Returns an upper bound of the distance of two points of the boxes.
double farthest(const Aabb& a, const Aabb& b) {
    return glm::length(glm::max(glm::abs(a.max - b.min), glm::abs(b.max - a.min))) * (1.0 + 1e-9);
}

}  // namespace

void World::State::visit_along(const Ray& ray, const QueryFilter& filter, collide::RayVisitor visit) const {
    if (is_updating()) return;
    Ray rest = ray;
    if (!filter.ignored.empty()) {
        const auto visit_wanted = [&](std::uint32_t id, double t) {
            return is_ignored(filter, id) ? rest.max_t : rest.max_t = visit(id, t);
        };
        return visit_along(ray, {filter.layers}, visit_wanted);
    }
    const auto visit_living = [&](std::uint32_t object, double t) {
        if (table.objects[object].alive && !object_shapes.is_unbounded(object)) rest.max_t = visit(object, t);
        return rest.max_t;
    };
    for (const std::uint32_t object : object_shapes.unbounded())
        if (rest.max_t >= 0.0 && is_ground(object, filter.layers)) rest.max_t = visit(object, 0.0);
    if (!(rest.max_t >= 0.0)) return;
    collide::visit_along(rest, index.tree(), visit_living, filter.layers);
    if (!(rest.max_t >= 0.0)) return;
    const cull::MovingBoxes& moving = index.moving();
    index.visit_movers_along(rest, glm::dvec3(0.0), [&](std::uint32_t i) {
        if ((index.layers(moving.items()[i]) & filter.layers) != 0)
            if (const auto t = mesh::raycast(rest, moving.boxes()[i])) visit_living(moving.items()[i], *t);
        return rest.max_t;
    });
    if (!(rest.max_t >= 0.0)) return;
    regions.visit_along(rest, filter.layers, visit);
}

void World::State::visit_swept(const Ray& path, const glm::dvec3& half_size, const QueryFilter& filter,
                               collide::NearVisitor visit) const {
    Ray rest = path;
    const auto visit_living = [&](std::uint32_t object) {
        if (table.objects[object].alive && !object_shapes.is_unbounded(object) && !is_ignored(filter, object))
            rest.max_t = visit(object);
        return rest.max_t;
    };
    for (const std::uint32_t object : object_shapes.unbounded())
        if (rest.max_t >= 0.0 && is_ground(object, filter.layers) && !is_ignored(filter, object))
            rest.max_t = visit(object);
    if (!(rest.max_t >= 0.0)) return;
    collide::visit_swept(rest, half_size, index.tree(), visit_living, filter.layers);
    if (!(rest.max_t >= 0.0)) return;
    const cull::MovingBoxes& moving = index.moving();
    index.visit_movers_along(rest, half_size, [&](std::uint32_t i) {
        if ((index.layers(moving.items()[i]) & filter.layers) != 0) visit_living(moving.items()[i]);
        return rest.max_t;
    });
    if (!(rest.max_t >= 0.0)) return;
    regions.visit_swept(rest, half_size, filter.layers, [&](std::uint32_t object) {
        if (!is_ignored(filter, object)) rest.max_t = visit(object);
        return rest.max_t;
    });
}

std::optional<ObjectHit> World::State::own_shape_hit(const Ray& ray, std::uint32_t id) const {
    const world::QueryShape stand = query_shape_of(id);
    if (!stand.pose) return std::nullopt;
    const auto met = convex::raycast({stand.shape, *stand.pose}, ray);
    if (!met) return std::nullopt;
    const ObjectRef ref = ref_of(id);
    ObjectHit hit{ref.object, ref.user, met->t, met->point};
    hit.normal = met->normal;
    hit.started_inside = met->started_inside;
    hit.child = met->part.child;
    hit.triangle = world::triangle_of(stand.shape, met->part);
    return hit;
}

namespace {

// Tests all triangles of a mesh whose transform flattens it, which no ray in the mesh's frame can meet.
std::optional<mesh::TriangleHit> raycast_flat(const Ray& ray, const world::PlacedMesh& placed) {
    std::optional<mesh::TriangleHit> nearest;
    const std::span<const std::uint32_t> rejected = placed.mesh->tree.rejected();
    for (std::uint32_t i = 0; i < placed.mesh->places.size(); ++i) {
        if (std::binary_search(rejected.begin(), rejected.end(), i)) continue;
        Triangle corners = placed.mesh->triangle(i);
        for (glm::dvec3& corner : corners) corner = *placed.linear * corner + placed.translation;
        const auto t = mesh::raycast(ray, corners);
        if (t && (!nearest || *t < nearest->t)) nearest = mesh::TriangleHit{*t, i};
    }
    return nearest;
}

// Handles an object with a bound, whose box the ray meets at `box_t`.
std::optional<ObjectHit> bound_hit(const Ray& ray, const ObjectRef& ref, const world::Object& object, const Obb& box,
                                   double box_t) {
    ObjectHit hit{ref.object, ref.user, box_t};
    if (object.kind != BoundKind::sphere) {
        hit.normal = world::normal_of(ray, box, box_t);
    } else {
        const Sphere sphere = world::sphere_of(object, box);
        const auto t = world::raycast(ray, sphere);
        if (!t) return std::nullopt;
        hit.t = *t;
        hit.normal = world::normal_of(ray, sphere, *t);
    }
    hit.point = ray.origin + hit.t * ray.direction;
    hit.started_inside = hit.normal == glm::dvec3(0.0);
    return hit;
}

}  // namespace

std::optional<ObjectHit> World::State::shape_hit(const Ray& ray, std::uint32_t id, double box_t) const {
    if (world::is_region_index(id)) {
        const world::Attachment& region = regions.of(id);
        const std::uint32_t item = id - region.first;
        if (region.data().solid(item) == nullptr)
            return bound_hit(ray, region.ref(item), region.object(item), region.box(item), box_t);
    }
    if (has_own_shape(id)) return own_shape_hit(ray, id);
    const ObjectRef ref = ref_of(id);
    const world::PlacedMesh placed = mesh_of_object(id);
    if (placed.mesh == nullptr)
        return world::is_region_index(id) ? bound_hit(ray, ref, regions.object(id), regions.box(id), box_t)
                                          : bound_hit(ray, ref, table.objects[id], index.box(id), box_t);
    const glm::dmat3& linear = *placed.linear;
    std::optional<mesh::TriangleHit> on_mesh;
    if (world::is_invertible(linear)) {
        const glm::dmat3 inverse = glm::inverse(linear);
        on_mesh = mesh::raycast(Ray{inverse * (ray.origin - placed.translation), inverse * ray.direction, ray.max_t},
                                placed.mesh->tree);
    } else {
        on_mesh = raycast_flat(ray, placed);
    }
    if (!on_mesh) return std::nullopt;
    ObjectHit hit{ref.object, ref.user, on_mesh->t, ray.origin + on_mesh->t * ray.direction, on_mesh->triangle};
    hit.normal = world::normal_of(ray, placed.mesh->triangle(on_mesh->triangle), linear);
    return hit;
}

std::optional<ObjectHit> World::raycast(const Ray& ray, const QueryFilter& filter) const {
    std::optional<ObjectHit> nearest;  // but for a box, whose hit is made once it is known to be the nearest
    std::uint32_t nearest_id = kNoIndex;
    double nearest_t = 0.0;
    const EvenRay even(ray);
    Ray rest = even.ray;
    state_->visit_along(even.ray, filter, [&](std::uint32_t object, double t) {
        std::optional<ObjectHit> hit;
        if (!state_->is_box(object)) {
            hit = state_->shape_hit(rest, object, t);
            if (!hit) return rest.max_t;
            t = hit->t;
        }
        if (nearest_id == kNoIndex || t < nearest_t || (t == nearest_t && object < nearest_id)) {
            nearest = hit;
            nearest_id = object;
            nearest_t = t;
            // What lies as far, but for the rounding of t, is asked too: as raycast_all() orders them.
            rest.max_t = std::min(even.ray.max_t, t * (1.0 + 0x1p-40));
        }
        return rest.max_t;
    });
    if (nearest_id == kNoIndex) return std::nullopt;
    if (!nearest) nearest = state_->shape_hit(even.ray, nearest_id, nearest_t);
    even.restore(*nearest);
    return nearest;
}

bool World::raycast_any(const Ray& ray, const QueryFilter& filter) const {
    bool any = false;
    const EvenRay even(ray);
    state_->visit_along(even.ray, filter, [&](std::uint32_t object, double t) {
        any = any || state_->shape_hit(even.ray, object, t).has_value();
        return any ? -1.0 : even.ray.max_t;
    });
    return any;
}

void World::raycast_all(const Ray& ray, Vector<ObjectHit>& hits, const QueryFilter& filter) const {
    hits.clear();
    const EvenRay even(ray);
    state_->visit_along(even.ray, filter, [&](std::uint32_t object, double t) {
        if (const auto hit = state_->shape_hit(even.ray, object, t)) hits.push_back(*hit);
        return even.ray.max_t;
    });
    std::sort(hits.begin(), hits.end(), [](const ObjectHit& a, const ObjectHit& b) {
        return a.t != b.t ? a.t < b.t : a.object.index < b.object.index;
    });
    for (ObjectHit& hit : hits) even.restore(hit);  // the caller's t may be infinite: order is by the point
}

bool World::State::is_ignored(const QueryFilter& filter, std::uint32_t id) const {
    for (const ObjectHandle& ignored : filter.ignored)
        if (ignored.index == id && ignored == ref_of(id).object) return true;
    return false;
}

void World::State::visit_near(const Aabb& bounds, double distance, const QueryFilter& filter,
                              collide::NearVisitor visit) const {
    if (is_updating()) return;
    if (!filter.ignored.empty()) {
        double rest = distance;
        const auto visit_wanted = [&](std::uint32_t id) { return is_ignored(filter, id) ? rest : rest = visit(id); };
        return visit_near(bounds, distance, {filter.layers}, visit_wanted);
    }
    for (const std::uint32_t object : object_shapes.unbounded())
        if (is_ground(object, filter.layers)) distance = visit(object);
    const auto visit_own = [&](std::uint32_t object) { return distance = visit(object); };
    visit_bounded_near(bounds, distance, filter.layers, visit_own);
    regions.visit_near(bounds, distance, filter.layers, visit);
}

void World::State::visit_bounded_near(const Aabb& bounds, double distance, std::uint32_t layers,
                                      collide::NearVisitor visit) const {
    const auto visit_living = [&](std::uint32_t object) {
        if (table.objects[object].alive && !object_shapes.is_unbounded(object)) distance = visit(object);
        return distance;
    };
    collide::visit_near(bounds, distance, index.tree(), visit_living, layers);
    const cull::MovingBoxes& moving = index.moving();
    index.visit_movers_near(bounds, distance, [&](std::uint32_t i) {
        if ((index.layers(moving.items()[i]) & layers) != 0 && gap_between(bounds, moving.boxes()[i]) <= distance)
            visit_living(moving.items()[i]);
        return distance;
    });
}

namespace {

// Whether a probe overlaps an object's sphere or box.
template <class Shape>
bool meets_bound(const Shape& probe, const world::Object& object, const Obb& box) {
    return object.kind == BoundKind::sphere ? meets_sphere(probe, world::sphere_of(object, box))
                                            : collide::intersects(box, probe);
}

}  // namespace

template <class Shape>
void World::State::overlap(const Shape& probe, Vector<ObjectRef>& found, const QueryFilter& filter) const {
    found.clear();
    if (!is_valid(probe)) return;
    const world::QueryShape asked = world::shape_of(probe);
    visit_near(bounds_of(probe), 0.0, filter, [&](std::uint32_t id) {
        const bool meets = has_shape(id)                ? overlaps(asked.placed(), id)
                           : world::is_region_index(id) ? meets_bound(probe, regions.object(id), regions.box(id))
                                                        : meets_bound(probe, table.objects[id], index.box(id));
        if (meets) found.push_back(ref_of(id));
        return 0.0;
    });
    world::sort_by_object(found);
}

void World::overlap(const Obb& probe, Vector<ObjectRef>& found, const QueryFilter& filter) const {
    state_->overlap(probe, found, filter);
}
void World::overlap(const Sphere& probe, Vector<ObjectRef>& found, const QueryFilter& filter) const {
    state_->overlap(probe, found, filter);
}
void World::overlap(const collide::Capsule& probe, Vector<ObjectRef>& found, const QueryFilter& filter) const {
    state_->overlap(probe, found, filter);
}

// One without end is beyond all that boxes and shapes may be.
constexpr double kFarthest = 1e300;

// Meshes take long, so they are asked last, within a distance that one of their boxes keeps to.
std::optional<ClosestObject> World::State::closest(const Aabb& bounds, double max_distance, const QueryFilter& filter,
                                                   GapTo gap_to_object) const {
    std::optional<ClosestObject> nearest;
    if (!(max_distance >= 0.0)) return nearest;
    double rest = std::min(max_distance, kFarthest);
    bool has_meshes = false;
    const auto look_at = [&](std::uint32_t id) {
        const auto [gap, triangle, child] = gap_to_object(id, rest);
        const bool nearer = !nearest || gap.distance < nearest->distance ||
                            (gap.distance == nearest->distance && id < nearest->object.index);
        if (gap.distance > rest || !nearer) return rest;
        const ObjectRef ref = ref_of(id);
        nearest = ClosestObject{ref.object, ref.user, gap.distance, gap.on_a, gap.on_b, triangle, child};
        return rest = gap.distance;
    };
    const auto is_mesh = [&](std::uint32_t id) { return !has_own_shape(id) && mesh_of_object(id).mesh != nullptr; };
    visit_near(bounds, rest, filter, [&](std::uint32_t id) {
        if (!is_mesh(id)) return look_at(id);
        has_meshes = true;
        return rest = std::min(rest, farthest(bounds, aabb_of(box_of_object(id))));
    });
    if (has_meshes)
        visit_near(bounds, rest, filter, [&](std::uint32_t id) { return is_mesh(id) ? look_at(id) : rest; });
    return nearest;
}

template <class Shape>
std::optional<ClosestObject> World::State::closest(const Shape& probe, double max_distance,
                                                   const QueryFilter& filter) const {
    if (!is_valid(probe)) return std::nullopt;
    const world::QueryShape asked = world::shape_of(probe);
    return closest(bounds_of(probe), max_distance, filter, [&](std::uint32_t id, double limit) {
        if (has_shape(id)) return gap_to_shape(asked.placed(), id, limit);
        return world::Gap{world::is_region_index(id) ? gap_to(probe, regions.object(id), regions.box(id))
                                                     : gap_to(probe, table.objects[id], index.box(id))};
    });
}

std::optional<ClosestObject> World::closest(const Sphere& probe, double max_distance, const QueryFilter& filter) const {
    return state_->closest(collide::Capsule{probe.center, probe.center, probe.radius}, max_distance, filter);
}
std::optional<ClosestObject> World::closest(const Obb& probe, double max_distance, const QueryFilter& filter) const {
    return state_->closest(probe, max_distance, filter);
}
std::optional<ClosestObject> World::closest(const collide::Capsule& probe, double max_distance,
                                            const QueryFilter& filter) const {
    return state_->closest(probe, max_distance, filter);
}

}  // namespace crofton
