// SPDX-License-Identifier: MIT
#include <crofton/capi/crofton.h>
#include <crofton/mesh/mesh_query.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include <crofton/capi/numbers.hpp>
#include "bodies.hpp"
#include "collider.hpp"
#include "found.hpp"
#include "growing.hpp"
#include "queries.hpp"
#include "world.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(sizeof(crofton_object_ref) == sizeof(ObjectRef) &&
              offsetof(crofton_object_ref, user) == offsetof(ObjectRef, user));
static_assert(sizeof(crofton_object_pair) == sizeof(ObjectPair) &&
              offsetof(crofton_object_pair, second) == offsetof(ObjectPair, second));
static_assert(sizeof(crofton_object_hit) == sizeof(ObjectHit) &&
              offsetof(crofton_object_hit, user) == offsetof(ObjectHit, user) &&
              offsetof(crofton_object_hit, t) == offsetof(ObjectHit, t) &&
              offsetof(crofton_object_hit, point) == offsetof(ObjectHit, point) &&
              offsetof(crofton_object_hit, triangle) == offsetof(ObjectHit, triangle) &&
              offsetof(crofton_object_hit, child) == offsetof(ObjectHit, child) &&
              offsetof(crofton_object_hit, normal) == offsetof(ObjectHit, normal) &&
              offsetof(crofton_object_hit, started_inside) == offsetof(ObjectHit, started_inside) && sizeof(bool) == 1);
static_assert(sizeof(crofton_contact_point) == sizeof(collide::ContactPoint) &&
              offsetof(crofton_contact_point, depth) == offsetof(collide::ContactPoint, depth));
static_assert(sizeof(crofton_mesh_contact) == sizeof(mesh::MeshContact) &&
              offsetof(crofton_mesh_contact, begin) == offsetof(mesh::MeshContact, segment) &&
              offsetof(crofton_mesh_contact, normal) == offsetof(mesh::MeshContact, normal));
static_assert(CROFTON_CONTACT_ENDED == static_cast<int>(ContactPhase::ended) &&
              CROFTON_CONTACT_STAYED == static_cast<int>(ContactPhase::stayed) && CROFTON_NONE == kNoTriangle);

namespace {

constexpr double kNoDistance = std::numeric_limits<double>::infinity();

crofton_object_hit to_c_hit(const std::optional<ObjectHit>& hit) {
    if (!hit) return {{CROFTON_NONE, 0}, 0, kNoDistance, {}, CROFTON_NONE, 0, {}, 0};
    return {{hit->object.index, hit->object.generation},
            hit->user,
            hit->t,
            {hit->point.x, hit->point.y, hit->point.z},
            hit->triangle,
            hit->child,
            {hit->normal.x, hit->normal.y, hit->normal.z},
            static_cast<std::uint8_t>(hit->started_inside ? 1 : 0)};
}

// Writes what is asked of a world as it is.
template <class Value, class Ask>
crofton_status ask(const crofton_world* world, Value* value, const char* function, Ask answer) {
    const SharedUse use(world, function);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(value, function));
    *value = answer(world->world);
    return CROFTON_OK;
}

crofton_status to_capsule(const double* begin, const double* end, double radius, const char* function,
                          collide::Capsule& capsule) {
    Sphere at_begin, at_end;
    CROFTON_CHECK(to_sphere(begin, radius, function, at_begin));
    CROFTON_CHECK(to_sphere(end, radius, function, at_end));
    capsule = {at_begin.center, at_end.center, radius};
    return CROFTON_OK;
}

crofton_status to_shape(const crofton_box* box, const char* function, Obb& shape) {
    CROFTON_CHECK(check_pointer(box, function));
    shape = to_box(box);
    return status_of(validate(shape), function);
}

template <class Shape>
crofton_status overlap(const crofton_world* world, const Shape& shape, uint32_t layer_mask, crofton_found* found,
                       const char* function) {
    const SharedUse use_world(world, function);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(found, function);
    if (use.failed()) return use.status();
    found->hits.clear();
    world->world.overlap(shape, found->objects, layer_mask);
    return CROFTON_OK;
}

// The shape as arguments that World::closest takes: a shape, or a body and its pose.
template <class... Shape>
crofton_status find_closest(const crofton_world* world, double max_distance, uint32_t layer_mask,
                            crofton_closest_object* closest, const char* function, const Shape&... shape) {
    const SharedUse use(world, function);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_growing(closest, function));
    CROFTON_CHECK(check_limit(max_distance, "max_distance", function));
    crofton_closest_object result{0, {CROFTON_NONE, 0}, 0, kNoDistance, {}, {}};
    if (const auto nearest = world->world.closest(shape..., max_distance, layer_mask)) {
        result.object = {nearest->object.index, nearest->object.generation};
        result.user = nearest->user;
        result.distance = nearest->distance;
        copy_vector(nearest->on_shape, result.on_shape);
        copy_vector(nearest->on_object, result.on_object);
    }
    write_growing(result, closest);
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_world_object_count(const crofton_world* world, size_t* count) {
    return ask(world, count, __func__, [](const World& w) { return w.object_count(); });
}

crofton_status crofton_world_contains(const crofton_world* world, crofton_object object, int* contains) {
    return ask(world, contains, __func__, [&](const World& w) { return w.contains(to_handle(object)) ? 1 : 0; });
}

crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains) {
    return ask(world, contains, __func__, [&](const World& w) { return w.contains(to_handle(node)) ? 1 : 0; });
}

crofton_status crofton_world_contains_mesh(const crofton_world* world, crofton_world_mesh mesh, int* contains) {
    return ask(world, contains, __func__, [&](const World& w) { return w.contains(to_handle(mesh)) ? 1 : 0; });
}

crofton_status crofton_world_get_user(const crofton_world* world, crofton_object object, uint64_t* user) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(user, __func__));
    const auto found = world->world.user_of(to_handle(object));
    if (!found) return report(found.error(), __func__);
    *user = *found;
    return CROFTON_OK;
}

crofton_status crofton_world_get_box(const crofton_world* world, crofton_object object, crofton_box* box) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(box, __func__));
    const auto found = world->world.box_of(to_handle(object));
    if (!found) return report(found.error(), __func__);
    *box = *to_c(&*found);
    return CROFTON_OK;
}

crofton_status crofton_world_get_transform(const crofton_world* world, crofton_object object,
                                           crofton_transform* transform) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(transform, __func__));
    const auto found = world->world.transform_of(to_handle(object));
    if (!found) return report(found.error(), __func__);
    std::memcpy(transform, &*found, sizeof *transform);
    return CROFTON_OK;
}

crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                     uint32_t layer_mask, crofton_object_hit* hits) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(rays, count, __func__));
    CROFTON_CHECK(check_array(hits, count, __func__));
    Ray ray;
    for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(to_ray(rays[i], __func__, i, ray));
    for (std::size_t i = 0; i < count; ++i) {
        ray = {to_vector(rays[i].origin), to_vector(rays[i].direction), rays[i].max_t};
        hits[i] = to_c_hit(world->world.raycast(ray, layer_mask));
    }
    return CROFTON_OK;
}

crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray, uint32_t layer_mask,
                                         int* hit) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(hit, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *hit = world->world.raycast_any(checked, layer_mask) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_found_create(crofton_found** found) {
    CROFTON_CHECK(check_pointer(found, __func__));
    return create(found, __func__);
}

crofton_status crofton_found_destroy(crofton_found* found) {
    return destroy(found, __func__);
}

crofton_status crofton_found_objects(const crofton_found* found, const crofton_object_ref** objects, size_t* count) {
    const SharedUse use(found, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(objects, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *objects = reinterpret_cast<const crofton_object_ref*>(found->objects.data());
    *count = found->objects.size();
    return CROFTON_OK;
}

crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits, size_t* count) {
    const SharedUse use(found, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(hits, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *hits = reinterpret_cast<const crofton_object_hit*>(found->hits.data());
    *count = found->hits.size();
    return CROFTON_OK;
}

crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray, uint32_t layer_mask,
                                         crofton_found* found) {
    const SharedUse use_world(world, __func__);
    if (use_world.failed()) return use_world.status();
    const ExclusiveUse use(found, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(ray, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    found->objects.clear();
    world->world.raycast_all(checked, found->hits, layer_mask);
    return CROFTON_OK;
}

crofton_status crofton_world_overlap_box(const crofton_world* world, const crofton_box* box, uint32_t layer_mask,
                                         crofton_found* found) {
    Obb shape;
    CROFTON_CHECK(to_shape(box, __func__, shape));
    return overlap(world, shape, layer_mask, found, __func__);
}

crofton_status crofton_world_overlap_sphere(const crofton_world* world, const double center[3], double radius,
                                            uint32_t layer_mask, crofton_found* found) {
    Sphere shape;
    CROFTON_CHECK(to_sphere(center, radius, __func__, shape));
    return overlap(world, shape, layer_mask, found, __func__);
}

crofton_status crofton_world_overlap_capsule(const crofton_world* world, const double begin[3], const double end[3],
                                             double radius, uint32_t layer_mask, crofton_found* found) {
    collide::Capsule shape;
    CROFTON_CHECK(to_capsule(begin, end, radius, __func__, shape));
    return overlap(world, shape, layer_mask, found, __func__);
}

crofton_status crofton_world_closest_to_box(const crofton_world* world, const crofton_box* box, double max_distance,
                                            uint32_t layer_mask, crofton_closest_object* closest) {
    Obb shape;
    CROFTON_CHECK(to_shape(box, __func__, shape));
    return find_closest(world, max_distance, layer_mask, closest, __func__, shape);
}

crofton_status crofton_world_closest_to_sphere(const crofton_world* world, const double center[3], double radius,
                                               double max_distance, uint32_t layer_mask,
                                               crofton_closest_object* closest) {
    Sphere shape;
    CROFTON_CHECK(to_sphere(center, radius, __func__, shape));
    return find_closest(world, max_distance, layer_mask, closest, __func__, shape);
}

crofton_status crofton_world_closest_to_capsule(const crofton_world* world, const double begin[3], const double end[3],
                                                double radius, double max_distance, uint32_t layer_mask,
                                                crofton_closest_object* closest) {
    collide::Capsule shape;
    CROFTON_CHECK(to_capsule(begin, end, radius, __func__, shape));
    return find_closest(world, max_distance, layer_mask, closest, __func__, shape);
}

crofton_status crofton_world_closest_to_body(const crofton_world* world, const crofton_placed* shape,
                                             double max_distance, uint32_t layer_mask,
                                             crofton_closest_object* closest) {
    const PlacedBody placed(shape, __func__);
    CROFTON_CHECK(placed.status());
    if (placed.body().kind() == convex::Kind::half_space)
        return report(CROFTON_UNSUPPORTED, __func__, "a half-space is near nearly all; ask with a bounded body");
    return find_closest(world, max_distance, layer_mask, closest, __func__, placed.body(), placed.pose());
}

crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs, size_t* count) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(pairs, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    *pairs = reinterpret_cast<const crofton_object_pair*>(world->world.pairs().data());
    *count = world->world.pairs().size();
    return CROFTON_OK;
}

crofton_status crofton_world_contact_count(const crofton_world* world, size_t* count) {
    return ask(world, count, __func__, [](const World& w) { return w.contacts().size(); });
}

crofton_status crofton_world_contact(const crofton_world* world, size_t contact, crofton_object_contact* result) {
    const SharedUse use(world, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_growing(result, __func__));
    if (contact >= world->world.contacts().size())
        return report(CROFTON_OUT_OF_RANGE, __func__, "there are not so many contacts", contact);
    const Contact& found = world->world.contacts()[contact];
    crofton_object_contact written{};
    written.first = to_c_ref(found.first);
    written.second = to_c_ref(found.second);
    written.phase = static_cast<std::uint32_t>(found.phase);
    written.inside = static_cast<std::uint32_t>(found.inside);
    copy_vector(found.normal, written.normal);
    written.depth = found.depth;
    written.points = reinterpret_cast<const crofton_contact_point*>(found.points.data());
    written.triangles = reinterpret_cast<const crofton_mesh_contact*>(found.triangles.data());
    written.point_count = found.points.size();
    written.triangle_count = found.triangles.size();
    write_growing(written, result);
    return CROFTON_OK;
}
