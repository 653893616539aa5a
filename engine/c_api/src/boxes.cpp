// SPDX-License-Identifier: MIT
// Questions asked of boxes.
#include <crofton/capi/modules.h>

#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <limits>

#include <crofton/capi/convert.hpp>
#include <crofton/capi/queries.hpp>

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_MAX_MANIFOLD_POINTS == std::size(collide::Manifold{}.points));

namespace {

void copy_vector(const glm::dvec3& v, double* result) {
    if (result) std::copy_n(&v.x, 3, result);
}

// Both boxes are there and valid; an error names the first of them 0, the second 1.
crofton_status check_boxes(const crofton_box* a, const crofton_box* b, const char* function) {
    CROFTON_CHECK(check_pointer(a, function));
    CROFTON_CHECK(check_pointer(b, function));
    CROFTON_CHECK(status_of(validate(to_box(a), 0), function));
    return status_of(validate(to_box(b), 1), function);
}

}  // namespace

crofton_status crofton_boxes_meet(const crofton_box* a, const crofton_box* b, int* meet) {
    CROFTON_CHECK(check_pointer(meet, __func__));
    CROFTON_CHECK(check_boxes(a, b, __func__));
    *meet = collide::intersects(to_box(a), to_box(b)) ? 1 : 0;
    return CROFTON_OK;
}

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

crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t) {
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(ray, __func__));
    CROFTON_CHECK(check_pointer(t, __func__));
    CROFTON_CHECK(status_of(validate(to_box(box), 0), __func__));
    Ray checked;
    CROFTON_CHECK(to_ray(*ray, __func__, kNoItem, checked));
    *t = mesh::raycast(checked, to_box(box)).value_or(std::numeric_limits<double>::infinity());
    return CROFTON_OK;
}
