// SPDX-License-Identifier: MIT
// What the formulas say of the view volumes that frustum_body() gives the corners of.
#pragma once
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/measure/measure.hpp>

namespace crofton::cli {

[[nodiscard]] inline measure::IntrinsicVolumes frustum_volumes(double tan_x, double tan_y, double near, double far,
                                                               bool perspective) {
    Camera camera;
    camera.projection = perspective ? Projection::perspective : Projection::orthographic;
    camera.fov_y = 2.0 * std::atan(tan_y);
    camera.height = 2.0 * tan_y;
    camera.aspect = tan_x / tan_y;
    camera.near_distance = near, camera.far_distance = far;
    return *measure::intrinsic_volumes_of_frustum(camera);
}

}  // namespace crofton::cli
