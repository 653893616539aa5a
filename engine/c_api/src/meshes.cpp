// SPDX-License-Identifier: MIT
// Questions asked of two shapes of meshes.
#include <crofton/capi/modules.h>

#include <algorithm>
#include <crofton/mesh/mesh_distance.hpp>
#include <crofton/mesh/mesh_query.hpp>

#include <crofton/capi/shapes.hpp>

using namespace crofton;
using namespace crofton::capi;

static_assert(CROFTON_A_INSIDE_B == static_cast<int>(mesh::Containment::a_inside_b) &&
              CROFTON_B_INSIDE_A == static_cast<int>(mesh::Containment::b_inside_a) &&
              CROFTON_PARTLY_INSIDE == static_cast<int>(mesh::Containment::partly));

namespace {

constexpr std::uint32_t kAllRelations = 2 * CROFTON_MESHES_DEPTH - 1;

// Two meshes and how they lie, checked, for the length of a call.
class PosedMeshes {
  public:
    PosedMeshes(const crofton_shape* a, const crofton_shape* b, const crofton_transform* b_to_a, const char* function)
        : use_a_(a, function), use_b_(b, function) {
        status_ = use_a_.failed() ? use_a_.status() : use_b_.failed() ? use_b_.status() : set(*a, *b, b_to_a, function);
    }
    [[nodiscard]] crofton_status status() const { return status_; }
    [[nodiscard]] const mesh::MeshTree& a() const { return *a_; }
    [[nodiscard]] const mesh::MeshTree& b() const { return *b_; }
    [[nodiscard]] const RigidTransform& pose() const { return pose_; }

  private:
    crofton_status set(const crofton_shape& a, const crofton_shape& b, const crofton_transform* b_to_a,
                       const char* function) {
        if (!a.data->mesh) return report(CROFTON_UNSUPPORTED, function, "the shape is not a mesh", 0);
        if (!b.data->mesh) return report(CROFTON_UNSUPPORTED, function, "the shape is not a mesh", 1);
        CROFTON_CHECK(check_pointer(b_to_a, function));
        a_ = &*a.data->mesh;
        b_ = &*b.data->mesh;
        const Transform given = to_transform(*b_to_a);
        pose_ = {given.linear, given.translation};
        return status_of(validate(pose_), function);
    }

    SharedUse use_a_, use_b_;
    crofton_status status_;
    const mesh::MeshTree *a_ = nullptr, *b_ = nullptr;
    RigidTransform pose_;
};

}  // namespace

crofton_status crofton_meshes_relate(const crofton_shape* a, const crofton_shape* b, const crofton_transform* b_to_a,
                                     uint32_t which, crofton_mesh_relation* relation) {
    const PosedMeshes posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_growing(relation, __func__));
    if (which > kAllRelations) return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown relations of meshes");
    crofton_mesh_relation result{};
    if (which & CROFTON_MESHES_MEET) result.meet = mesh::intersects(posed.a(), posed.b(), posed.pose()) ? 1 : 0;
    if (which & CROFTON_MESHES_CONTAINMENT)
        result.containment = static_cast<std::uint32_t>(mesh::containment(posed.a(), posed.b(), posed.pose()));
    if (which & CROFTON_MESHES_DISTANCE) {
        const mesh::MeshDistance found = mesh::distance(posed.a(), posed.b(), posed.pose());
        result.distance = found.distance;
        copy_out(found.on_a, result.on_a);
        copy_out(found.on_b, result.on_b);
    }
    if (which & CROFTON_MESHES_DEPTH) {
        Vector<mesh::MeshContact> contacts;
        mesh::contacts(posed.a(), posed.b(), posed.pose(), contacts);
        const mesh::SeparatingMotion found = mesh::separating_motion(posed.a(), posed.b(), posed.pose(), contacts);
        result.depth = found.depth;
        copy_out(found.direction, result.direction);
    }
    write_growing(result, relation);
    return CROFTON_OK;
}

crofton_status crofton_meshes_contacts(const crofton_shape* a, const crofton_shape* b, const crofton_transform* b_to_a,
                                       crofton_mesh_contact* contacts, size_t capacity, size_t* count) {
    const PosedMeshes posed(a, b, b_to_a, __func__);
    CROFTON_CHECK(posed.status());
    CROFTON_CHECK(check_room(contacts, capacity, __func__));
    CROFTON_CHECK(check_pointer(count, __func__));
    Vector<mesh::MeshContact> found;
    mesh::contacts(posed.a(), posed.b(), posed.pose(), found);
    for (std::size_t i = 0; i < std::min(capacity, found.size()); ++i) {
        contacts[i].triangles = {found[i].triangles.first, found[i].triangles.second};
        copy_out(found[i].segment.begin, contacts[i].begin);
        copy_out(found[i].segment.end, contacts[i].end);
        copy_out(found[i].normal, contacts[i].normal);
    }
    *count = found.size();
    return CROFTON_OK;
}
