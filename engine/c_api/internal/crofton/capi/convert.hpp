// SPDX-License-Identifier: MIT
// The C structs and the C++ ones, which say the same: arrays of them are read in place.
#pragma once
#include <crofton/capi/base.h>

#include <crofton/core/executor.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/transform.hpp>
#include <cstddef>
#include <cstring>
#include <span>

namespace crofton::capi {

static_assert(sizeof(crofton_box) == sizeof(Obb) && offsetof(crofton_box, axes) == offsetof(Obb, axes) &&
              offsetof(crofton_box, half_extents) == offsetof(Obb, half_extents));
static_assert(sizeof(crofton_transform) == sizeof(Transform) &&
              offsetof(crofton_transform, translation) == offsetof(Transform, translation));
static_assert(sizeof(crofton_plane) == sizeof(Plane) && offsetof(crofton_plane, offset) == offsetof(Plane, offset));
static_assert(CROFTON_MAX_PLANES == Frustum::kMaxPlanes);

[[nodiscard]] inline std::span<const Obb> to_boxes(const crofton_box* boxes, std::size_t count) {
    return {reinterpret_cast<const Obb*>(boxes), count};
}
[[nodiscard]] inline const Obb& to_box(const crofton_box* box) {
    return *reinterpret_cast<const Obb*>(box);
}
[[nodiscard]] inline const crofton_box* to_c(const Obb* boxes) {
    return reinterpret_cast<const crofton_box*>(boxes);
}
[[nodiscard]] inline glm::dvec3 to_vector(const double* v) {
    return {v[0], v[1], v[2]};
}
inline void copy_out(const glm::dvec3& v, double* result) {
    std::memcpy(result, &v.x, 3 * sizeof(double));
}

[[nodiscard]] inline Transform to_transform(const crofton_transform& transform) {
    Transform result;
    std::memcpy(static_cast<void*>(&result), &transform, sizeof result);
    return result;
}

// Copies the planes in use only. Requires frustum.plane_count ≤ CROFTON_MAX_PLANES.
inline void copy_frustum(const crofton_frustum& frustum, Frustum& result) {
    result.origin = to_vector(frustum.origin);
    result.plane_count = frustum.plane_count;
    std::memcpy(static_cast<void*>(result.planes.data()), frustum.planes, frustum.plane_count * sizeof(Plane));
}
void copy_frustum(const Frustum& frustum, crofton_frustum& result);
// The camera is there, of the right size and of a known projection.
[[nodiscard]] crofton_status check_camera(const crofton_camera* camera, const char* function);
[[nodiscard]] Camera to_camera(const crofton_camera& camera);

// The host's job system as an Executor; without one, the calling thread.
class HostJobs final : public Executor {
  public:
    explicit HostJobs(const crofton_jobs* jobs) : jobs_(jobs) {}
    [[nodiscard]] unsigned concurrency() const override;
    void parallel_for(std::size_t count, std::size_t grain, RangeTask shape) override;

  private:
    const crofton_jobs* jobs_;
};
[[nodiscard]] crofton_status check_valid_boxes(const crofton_box* boxes, std::size_t count, const char* function);
[[nodiscard]] crofton_status check_jobs(const crofton_jobs* jobs, const char* function);

}  // namespace crofton::capi
