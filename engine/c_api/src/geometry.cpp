// SPDX-License-Identifier: MIT
#include <crofton/capi/base.h>

#include <crofton/measure/measure.hpp>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/scene/transformed_box.hpp>

namespace crofton::capi {

void copy_frustum(const Frustum& frustum, crofton_frustum& result) {
    for (int i = 0; i < 3; ++i) result.origin[i] = frustum.origin[i];
    result.plane_count = frustum.plane_count;
    std::memcpy(result.planes, static_cast<const void*>(frustum.planes.data()), sizeof result.planes);
}

Camera to_camera(const crofton_camera& camera) {
    return {.position = to_vector(camera.position),
            .forward = to_vector(camera.forward),
            .up = to_vector(camera.up),
            .projection = static_cast<Projection>(camera.projection),
            .fov_y = camera.fov_y,
            .height = camera.height,
            .aspect = camera.aspect,
            .near_distance = camera.near_distance,
            .far_distance = camera.far_distance};
}

crofton_status check_camera(const crofton_camera* camera, const char* function) {
    CROFTON_CHECK(check_struct(camera, function));
    if (camera->projection > CROFTON_ORTHOGRAPHIC)
        return report(CROFTON_INVALID_ARGUMENT, function, "unknown projection");
    return CROFTON_OK;
}

crofton_status check_valid_boxes(const crofton_box* boxes, std::size_t count, const char* function) {
    CROFTON_CHECK(check_array(boxes, count, function));
    for (std::size_t i = 0; i < count; ++i)
        if (const auto valid = validate(to_boxes(boxes, count)[i], i); !valid) return report(valid.error(), function);
    return CROFTON_OK;
}

}  // namespace crofton::capi

using namespace crofton;
using namespace crofton::capi;

crofton_camera crofton_default_camera(void) {
    const Camera source;
    crofton_camera result{.size = sizeof(crofton_camera),
                          .position = {},
                          .forward = {},
                          .up = {},
                          .projection = static_cast<std::uint32_t>(source.projection),
                          .fov_y = source.fov_y,
                          .height = source.height,
                          .aspect = source.aspect,
                          .near_distance = source.near_distance,
                          .far_distance = source.far_distance};
    for (int i = 0; i < 3; ++i) {
        result.forward[i] = source.forward[i];
        result.up[i] = source.up[i];
    }
    return result;
}

crofton_status crofton_frustum_from_camera(const crofton_camera* camera, crofton_frustum* frustum) {
    CROFTON_CHECK(check_camera(camera, __func__));
    CROFTON_CHECK(check_struct(frustum, __func__));
    const auto result = frustum_of(to_camera(*camera));
    if (!result) return report(result.error(), __func__);
    copy_frustum(*result, *frustum);
    return CROFTON_OK;
}

crofton_status crofton_frustum_from_matrix(const double to_clip[16], uint32_t depth, const double* origin,
                                           crofton_frustum* frustum) {
    CROFTON_CHECK(check_pointer(to_clip, __func__));
    CROFTON_CHECK(check_struct(frustum, __func__));
    if (depth > CROFTON_DEPTH_MINUS_ONE_TO_ONE)
        return report(CROFTON_INVALID_ARGUMENT, __func__, "unknown depth range");
    glm::dmat4 matrix;
    std::memcpy(static_cast<void*>(&matrix), to_clip, sizeof matrix);
    const auto result =
        frustum_of(matrix, static_cast<DepthRange>(depth), origin ? to_vector(origin) : glm::dvec3(0.0));
    if (!result) return report(result.error(), __func__);
    copy_frustum(*result, *frustum);
    return CROFTON_OK;
}

crofton_status crofton_boxes_validate(const crofton_box* boxes, size_t count) {
    return check_valid_boxes(boxes, count, __func__);
}

crofton_status crofton_box_transform(const crofton_transform* transform, const crofton_box* box, crofton_box* result) {
    CROFTON_CHECK(check_pointer(transform, __func__));
    CROFTON_CHECK(check_pointer(box, __func__));
    CROFTON_CHECK(check_pointer(result, __func__));
    CROFTON_CHECK(status_of(validate(to_transform(*transform)), __func__));
    CROFTON_CHECK(status_of(validate(to_box(box)), __func__));
    const auto turned = scene::transformed_box(to_transform(*transform), to_box(box), measure::minimal_perimeter());
    if (!turned) return report(turned.error(), __func__);
    *result = *to_c(&*turned);
    return CROFTON_OK;
}
