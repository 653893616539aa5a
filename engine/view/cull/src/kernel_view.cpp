// SPDX-License-Identifier: MIT
// Builds the kernels' view for a query: only what that query needs, without branches or calls.
#include "kernel_view.hpp"

#include <cstdlib>

#include "exact/box_constraints.hpp"
#include "tree/query.hpp"

namespace crofton::cull {

bool set_planes(const View& view, KernelView& result) {
    const Frustum& frustum = view.frustum;
    bool takes = frustum.plane_count > 0;
    for (int j = 0; j < 3; ++j) {
        result.origin[j] = frustum.origin[j];
        takes &= std::fabs(frustum.origin[j]) <= kMaxCoordinate;
    }
    result.plane_count = frustum.plane_count;
    result.layer_mask = view.layer_mask;
    for (std::uint32_t i = 0; i < frustum.plane_count; ++i) {
        const glm::dvec3& n = frustum.planes[i].normal;
        KernelPlane& plane = result.planes[i];
        for (int j = 0; j < 3; ++j) {
            plane.normal[j] = n[j];
            plane.normal_f[j] = static_cast<float>(n[j]);
        }
        plane.offset = frustum.planes[i].offset;
        takes &= std::fabs(plane.offset) <= 1e32;
        takes &= std::fabs(n.x * n.x + n.y * n.y + n.z * n.z - 1.0) <= 1e-3;  // has_unit_normals(); not of NaN
    }
    return takes;
}

void set_lengths(KernelView& view) {
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        const double* n = view.planes[i].normal;
        view.planes[i].length_f = static_cast<float>(std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
    }
}

KernelView kernel_view_of(const View& view) {
    KernelView result;  // planes beyond the last are not read
    static_cast<void>(set_planes(view, result));
    for (std::uint32_t i = 0; i < result.plane_count; ++i)
        result.pair_planes[i] = pair_plane_of(result.planes[i].normal);
    return result;
}

}  // namespace crofton::cull
