// SPDX-License-Identifier: MIT
// Reads a World's objects and meshes, and asks its queries, for the C API.
#include <crofton/capi/crofton.h>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/world/world.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include <crofton/capi/call.hpp>
#include <crofton/capi/growing.hpp>
#include <crofton/capi/numbers.hpp>
#include <crofton/capi/queries.hpp>
#include <crofton/capi/query_shapes.hpp>
#include <crofton/capi/shapes.hpp>
#include "clusters.hpp"
#include "found.hpp"
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
// A span is a pointer and a count, in that order: tests/c_api compares each member.
static_assert(sizeof(crofton_object_contact) == sizeof(Contact) &&
              offsetof(crofton_object_contact, phase) == offsetof(Contact, phase) &&
              offsetof(crofton_object_contact, inside) == offsetof(Contact, inside) &&
              offsetof(crofton_object_contact, normal) == offsetof(Contact, normal) &&
              offsetof(crofton_object_contact, depth) == offsetof(Contact, depth) &&
              offsetof(crofton_object_contact, points) == offsetof(Contact, points) &&
              offsetof(crofton_object_contact, triangles) == offsetof(Contact, triangles) &&
              offsetof(crofton_object_contact, shape_points) == offsetof(Contact, shape_points));
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

}  // namespace

crofton_status crofton_world_get_object(const crofton_world* world, crofton_object object, crofton_object_info* info) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_growing(info, __func__));
    const auto user = world->world.user_of(to_handle(object));
    if (!user) return report(user.error(), __func__);
    crofton_object_info result{};
    result.user = *user;
    if (const auto box = world->world.box_of(to_handle(object))) {
        result.has_box = 1;
        result.box = *to_c(&*box);
    }
    if (const auto transform = world->world.transform_of(to_handle(object))) {
        result.has_transform = 1;
        std::memcpy(&result.transform, &*transform, sizeof result.transform);
    }
    write_growing(result, info);
    return CROFTON_OK;
}

crofton_status crofton_world_get_mesh(const crofton_world* world, crofton_world_mesh mesh, crofton_mesh_info* info) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_growing(info, __func__));
    CROFTON_CHECK(check_mesh(*world, mesh, __func__));
    return recover(__func__, [&] {
        const MeshHandle handle = to_handle(mesh);
        crofton_mesh_info result{};
        result.occluder_count = world->world.occluders_of(handle).size();
        if (const depth::ClusteredMesh* const cut = world->world.clusters_of(handle)) {
            const std::lock_guard lock(world->mutex);
            auto& ranges = world->cluster_ranges;
            if (ranges.size() <= handle.index) ranges.resize(handle.index + std::size_t{1});
            result.clusters = to_c_clusters(*cut, ranges[handle.index]);
        }
        write_growing(result, info);
        return CROFTON_OK;
    });
}

crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains) {
    CROFTON_READ(world);
    CROFTON_CHECK(check_pointer(contains, __func__));
    *contains = world->world.contains(to_handle(node)) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                     const crofton_query_filter* filter, crofton_object_hit* hits) {
    CROFTON_READ(world);
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    return answer_rays(rays, count, hits, __func__,
                       [&](const Ray& ray) { return to_c_hit(world->world.raycast(ray, accepted)); });
}

crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray,
                                         const crofton_query_filter* filter, int* hit) {
    CROFTON_READ(world);
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(hit, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *hit = world->world.raycast_any(checked, accepted) ? 1 : 0;
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
    CROFTON_READ(found);
    return give_list(found->objects, objects, count, __func__);
}

crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits, size_t* count) {
    CROFTON_READ(found);
    return give_list(found->hits, hits, count, __func__);
}

crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray,
                                         const crofton_query_filter* filter, crofton_found* found) {
    CROFTON_READ(world);
    CROFTON_CHANGE(found);
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    CROFTON_CHECK(check_pointer(ray, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    found->clear();
    world->world.raycast_all(checked, found->hits, accepted);
    return CROFTON_OK;
}

crofton_status crofton_world_overlap(const crofton_world* world, const crofton_query_shape* shape,
                                     const crofton_query_filter* filter, crofton_found* found) {
    CROFTON_READ(world);
    CROFTON_CHANGE(found);
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    return visit_shape(shape, __func__, [&](const auto&... asked) {
        found->clear();
        world->world.overlap(asked..., found->objects, accepted);
        return CROFTON_OK;
    });
}

crofton_status crofton_world_closest(const crofton_world* world, const crofton_query_shape* shape, double max_distance,
                                     const crofton_query_filter* filter, crofton_closest_object* closest) {
    CROFTON_READ(world);
    QueryFilter accepted;
    CROFTON_CHECK(to_filter(filter, __func__, accepted));
    CROFTON_CHECK(check_growing(closest, __func__));
    CROFTON_CHECK(check_limit(max_distance, "max_distance", __func__));
    return visit_shape(shape, __func__, [&](const auto&... asked) {
        crofton_closest_object result{0, {CROFTON_NONE, 0}, 0, kNoDistance, {}, {}, CROFTON_NONE, 0};
        if (const auto nearest = world->world.closest(asked..., max_distance, accepted)) {
            result.object = {nearest->object.index, nearest->object.generation};
            result.user = nearest->user;
            result.distance = nearest->distance;
            std::memcpy(result.on_shape, &nearest->on_shape, sizeof result.on_shape);
            std::memcpy(result.on_object, &nearest->on_object, sizeof result.on_object);
            result.triangle = nearest->triangle;
            result.child = nearest->child;
        }
        write_growing(result, closest);
        return CROFTON_OK;
    });
}

crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs, size_t* count) {
    CROFTON_READ(world);
    return give_list(world->world.pairs(), pairs, count, __func__);
}

crofton_status crofton_world_contacts(const crofton_world* world, const crofton_object_contact** contacts,
                                      size_t* count) {
    CROFTON_READ(world);
    return give_list(world->world.contacts(), contacts, count, __func__);
}
