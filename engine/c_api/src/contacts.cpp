// SPDX-License-Identifier: MIT
#include <crofton/capi/modules.h>

#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>

#include <crofton/capi/convert.hpp>
#include "collider.hpp"

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_MAX_MANIFOLD_POINTS == std::size(collide::Manifold{}.points));
static_assert(CROFTON_A_INSIDE_B == static_cast<int>(mesh::Containment::a_inside_b) &&
              CROFTON_B_INSIDE_A == static_cast<int>(mesh::Containment::b_inside_a) &&
              CROFTON_PARTLY_INSIDE == static_cast<int>(mesh::Containment::partly));

crofton_status crofton_boxes_manifold(const crofton_box* a, const crofton_box* b, crofton_manifold* manifold) {
    CROFTON_CHECK(check_boxes(a, b, __func__));
    CROFTON_CHECK(check_struct(manifold, __func__));
    const collide::Manifold found = collide::contact_manifold(to_box(a), to_box(b));
    copy_vector(found.normal, manifold->normal);
    manifold->depth = found.depth;
    manifold->point_count = static_cast<uint32_t>(found.count);
    for (int i = 0; i < found.count; ++i) {
        copy_vector(found.points[i].position, manifold->points[i].position);
        manifold->points[i].depth = found.points[i].depth;
    }
    return CROFTON_OK;
}

crofton_status crofton_boxes_distance(const crofton_box* a, const crofton_box* b, double* distance, double* on_a,
                                      double* on_b) {
    CROFTON_CHECK(check_boxes(a, b, __func__));
    CROFTON_CHECK(check_pointer(distance, __func__));
    const collide::Distance found = collide::distance(to_box(a), to_box(b));
    *distance = found.distance;
    copy_vector(found.on_a, on_a);
    copy_vector(found.on_b, on_b);
    return CROFTON_OK;
}

crofton_status crofton_colliders_contacts(const crofton_collider* a, const crofton_collider* b,
                                          const crofton_transform* b_to_a, crofton_mesh_contact* contacts,
                                          size_t capacity, size_t* count) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_room(contacts, capacity, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    Vector<mesh::MeshContact> found;
    mesh::contacts(a->tree, b->tree, posed.pose, found);
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i) {
        contacts[i].triangles = {found[i].triangles.first, found[i].triangles.second};
        copy_vector(found[i].segment.begin, contacts[i].begin);
        copy_vector(found[i].segment.end, contacts[i].end);
        copy_vector(found[i].normal, contacts[i].normal);
    }
    *count = found.size();
    return CROFTON_OK;
}

crofton_status crofton_colliders_depth(const crofton_collider* a, const crofton_collider* b,
                                       const crofton_transform* b_to_a, double* depth, double* direction) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_pointer(depth, __func__));
    Vector<mesh::MeshContact> found;
    mesh::contacts(a->tree, b->tree, posed.pose, found);
    const mesh::MeshDepth result = mesh::penetration(a->tree, b->tree, posed.pose, found);
    *depth = result.depth;
    copy_vector(result.direction, direction);
    return CROFTON_OK;
}

crofton_status crofton_colliders_containment(const crofton_collider* a, const crofton_collider* b,
                                             const crofton_transform* b_to_a, uint32_t* containment) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_pointer(containment, __func__));
    *containment = static_cast<uint32_t>(mesh::containment(a->tree, b->tree, posed.pose));
    return CROFTON_OK;
}
