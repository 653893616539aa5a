// SPDX-License-Identifier: MIT
#include <crofton/capi/modules.h>

#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>

#include <crofton/capi/tree.hpp>
#include "collider.hpp"
#include "queries.hpp"

using namespace crofton;
using namespace crofton::capi;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr crofton_ray_hit kMiss{kNever, CROFTON_NONE};

template <class Cast>
crofton_status cast_all(const crofton_ray* rays, size_t count, crofton_ray_hit* hits, const char* function, Cast cast) {
    CROFTON_CHECK(check_array(rays, count, function));
    CROFTON_CHECK(check_array(hits, count, function));
    Ray ray;
    for (std::size_t i = 0; i < count; ++i) CROFTON_CHECK(to_ray(rays[i], function, i, ray));
    for (std::size_t i = 0; i < count; ++i)
        hits[i] = cast({to_vector(rays[i].origin), to_vector(rays[i].direction), rays[i].max_t});
    return CROFTON_OK;
}

template <class Body>
crofton_status items_within(const crofton_tree& tree, const Body& body, uint32_t layer_mask, uint32_t* items,
                            size_t capacity, size_t* found, const char* function) {
    CROFTON_CHECK(check_room(items, capacity, function));
    CROFTON_CHECK(check_pointer(found, function));
    Vector<boxtree::ItemId> all;
    collide::overlapping(tree.tree, body, all, layer_mask);
    std::copy_n(all.data(), std::min(capacity, all.size()), items);
    *found = all.size();
    return CROFTON_OK;
}

}  // namespace

crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t) {
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(t, __func__));
    CROFTON_CHECK(status_of(validate(to_box(box), 0), __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *t = mesh::raycast(checked, to_box(box)).value_or(kNever);
    return CROFTON_OK;
}

crofton_status crofton_collider_raycast(const crofton_collider* collider, const crofton_ray* rays, size_t count,
                                        crofton_ray_hit* hits) {
    const SharedUse use(collider, __func__);
    if (use.failed()) return use.status();
    return cast_all(rays, count, hits, __func__, [&](const Ray& ray) {
        const auto hit = mesh::raycast(ray, collider->tree);
        return hit ? crofton_ray_hit{hit->t, hit->triangle} : kMiss;
    });
}

crofton_status crofton_collider_hits_any(const crofton_collider* collider, const crofton_ray* ray, int* hit) {
    const SharedUse use(collider, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(hit, __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *hit = mesh::hits_any(checked, collider->tree) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_tree_raycast(const crofton_tree* tree, const crofton_ray* rays, size_t count,
                                    uint32_t layer_mask, crofton_ray_hit* hits) {
    const SharedUse use(tree, __func__);
    if (use.failed()) return use.status();
    return cast_all(rays, count, hits, __func__, [&](const Ray& ray) {
        const auto hit = collide::raycast(ray, tree->tree, layer_mask);
        return hit ? crofton_ray_hit{hit->t, hit->item} : kMiss;
    });
}

crofton_status crofton_tree_within_box(const crofton_tree* tree, const crofton_box* box, uint32_t layer_mask,
                                       uint32_t* items, size_t capacity, size_t* found) {
    const SharedUse use(tree, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(status_of(validate(to_box(box)), __func__));
    return items_within(*tree, to_box(box), layer_mask, items, capacity, found, __func__);
}

crofton_status crofton_tree_within_sphere(const crofton_tree* tree, const double center[3], double radius,
                                          uint32_t layer_mask, uint32_t* items, size_t capacity, size_t* found) {
    const SharedUse use(tree, __func__);
    if (use.failed()) return use.status();
    Sphere sphere;
    CROFTON_CHECK(to_sphere(center, radius, __func__, sphere));
    return items_within(*tree, sphere, layer_mask, items, capacity, found, __func__);
}
