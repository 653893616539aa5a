// SPDX-License-Identifier: MIT
#include <crofton/capi/modules.h>
#include <crofton/mesh/mesh_tree.hpp>

#include <crofton/collide/broadphase.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/mesh/mesh_query.hpp>

#include <crofton/capi/convert.hpp>
#include "collider.hpp"
#include "mesh.hpp"

using namespace crofton;
using namespace crofton::capi;

struct crofton_broadphase {
    static constexpr std::uint32_t kKind = 0x43724f04;
    Header header;
    collide::Broadphase broadphase{};
};

static_assert(sizeof(crofton_pair) == sizeof(IdPair) && sizeof(crofton_filter) == sizeof(collide::CollisionFilter));

namespace {

std::span<const IdPair> pairs_of(const collide::Broadphase& broadphase, uint32_t which) {
    switch (which) {
        case CROFTON_PAIRS_BEGAN:
            return broadphase.began();
        case CROFTON_PAIRS_STAYED:
            return broadphase.stayed();
        case CROFTON_PAIRS_ENDED:
            return broadphase.ended();
        default:
            return broadphase.pairs();
    }
}

}  // namespace

crofton_status capi::to_pose(const crofton_transform* transform, const char* function, RigidTransform& pose) {
    CROFTON_CHECK(check_pointer(transform, function));
    const Transform source = to_transform(*transform);
    pose = {source.linear, source.translation};
    return status_of(validate(pose), function);
}

crofton_status capi::check_boxes(const crofton_box* a, const crofton_box* b, const char* function) {
    CROFTON_CHECK(check_pointer(a, function));
    CROFTON_CHECK(check_pointer(b, function));
    CROFTON_CHECK(status_of(validate(to_box(a), 0), function));
    return status_of(validate(to_box(b), 1), function);
}

crofton_status crofton_boxes_meet(const crofton_box* a, const crofton_box* b, int* meet) {
    CROFTON_CHECK(check_pointer(meet, __func__));
    CROFTON_CHECK(check_boxes(a, b, __func__));
    *meet = collide::intersects(to_box(a), to_box(b)) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_broadphase_create(crofton_broadphase** broadphase) {
    CROFTON_CHECK(check_pointer(broadphase, __func__));
    return create(broadphase, __func__);
}

crofton_status crofton_broadphase_destroy(crofton_broadphase* broadphase) {
    return destroy(broadphase, __func__);
}

crofton_status crofton_broadphase_update(crofton_broadphase* broadphase, const crofton_box* boxes,
                                         const crofton_filter* filters, size_t count, const crofton_jobs* jobs) {
    const ExclusiveUse use(broadphase, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_array(boxes, count, __func__));
    CROFTON_CHECK(check_jobs(jobs, __func__));
    HostJobs executor(jobs);
    const std::span all_filters(reinterpret_cast<const collide::CollisionFilter*>(filters), filters ? count : 0);
    return status_of(broadphase->broadphase.update(to_boxes(boxes, count), all_filters, executor), __func__);
}

crofton_status crofton_broadphase_pairs(const crofton_broadphase* broadphase, uint32_t which,
                                        const crofton_pair** pairs, size_t* count) {
    const SharedUse use(broadphase, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_pointer(pairs, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    if (which > CROFTON_PAIRS_ENDED) return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown kind of pairs");
    const auto found = pairs_of(broadphase->broadphase, which);
    *pairs = reinterpret_cast<const crofton_pair*>(found.data());
    *count = found.size();
    return CROFTON_OK;
}

crofton_status crofton_broadphase_get_statistics(const crofton_broadphase* broadphase,
                                                 crofton_broadphase_statistics* statistics) {
    const SharedUse use(broadphase, __func__);
    if (use.failed()) return use.status();
    CROFTON_CHECK(check_struct(statistics, __func__));
    const collide::BroadphaseStatistics& s = broadphase->broadphase.statistics();
    *statistics = {sizeof *statistics, s.bound_pairs, s.box_pairs, s.nodes_tested, s.rejected};
    return CROFTON_OK;
}

crofton_status crofton_collider_create(const crofton_mesh* mesh, crofton_collider** collider) {
    CROFTON_CHECK(check_pointer(collider, __func__));
    TriangleMesh copy;
    CROFTON_CHECK(to_mesh(mesh, __func__, copy));
    auto built = mesh::MeshTree::build(copy, {.rays = true});
    if (!built) return report(built.error(), __func__);
    return create(collider, __func__, std::move(*built));
}

crofton_status crofton_collider_destroy(crofton_collider* collider) {
    return destroy(collider, __func__);
}

crofton_status crofton_colliders_meet(const crofton_collider* a, const crofton_collider* b,
                                      const crofton_transform* b_to_a, int* meet) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_pointer(meet, __func__));
    *meet = mesh::intersects(a->tree, b->tree, posed.pose) ? 1 : 0;
    return CROFTON_OK;
}

crofton_status crofton_colliders_distance(const crofton_collider* a, const crofton_collider* b,
                                          const crofton_transform* b_to_a, double* distance, double* on_a,
                                          double* on_b) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_pointer(distance, __func__));
    const mesh::MeshDistance found = mesh::distance(a->tree, b->tree, posed.pose);
    *distance = found.distance;
    copy_vector(found.on_a, on_a);
    copy_vector(found.on_b, on_b);
    return CROFTON_OK;
}

crofton_status crofton_colliders_triangle_pairs(const crofton_collider* a, const crofton_collider* b,
                                                const crofton_transform* b_to_a, crofton_pair* pairs, size_t capacity,
                                                size_t* count) {
    const PosedColliders posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_room(pairs, capacity, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    Vector<mesh::TrianglePair> found;
    mesh::intersecting_triangles(a->tree, b->tree, posed.pose, found);
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i) pairs[i] = {found[i].first, found[i].second};
    *count = found.size();
    return CROFTON_OK;
}
