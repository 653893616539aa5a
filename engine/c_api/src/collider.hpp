// SPDX-License-Identifier: MIT
// What collides, as the functions of several headers see it: boxes, and meshes made ready.
#pragma once
#include <crofton/capi/modules.h>

#include <algorithm>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_tree.hpp>

#include <crofton/capi/call.hpp>

struct crofton_collider {
    static constexpr std::uint32_t kKind = 0x43724f05;
    crofton::capi::Header header;
    crofton::mesh::MeshTree tree;
};

namespace crofton::capi {

[[nodiscard]] crofton_status to_pose(const crofton_transform* transform, const char* function, RigidTransform& pose);

// Both boxes are there and valid; an error names the first of them 0, the second 1.
[[nodiscard]] crofton_status check_boxes(const crofton_box* a, const crofton_box* b, const char* function);

// Where the caller asked for it.
inline void copy_vector(const glm::dvec3& v, double* result) {
    if (result) std::copy_n(&v.x, 3, result);
}

// Two meshes and how they lie, checked, for the length of a call.
class PosedColliders {
  public:
    PosedColliders(const crofton_collider* a, const crofton_collider* b, const crofton_transform* b_to_a,
                   const char* function)
        : a_(a, function), b_(b, function) {
        status_ = a_.failed() ? a_.status() : b_.failed() ? b_.status() : to_pose(b_to_a, function, pose);
    }
    [[nodiscard]] crofton_status status() const { return status_; }

    RigidTransform pose;

  private:
    SharedUse a_, b_;
    crofton_status status_;
};

}  // namespace crofton::capi
