// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace crofton {
namespace {

template <class Number>
glm::dmat4 read_matrix(std::span<const Number, 16> numbers, MatrixOrder order) {
    glm::dmat4 matrix;
    for (int k = 0; k < 16; ++k) {
        const int column = order == MatrixOrder::columns ? k / 4 : k % 4;
        const int row = order == MatrixOrder::columns ? k % 4 : k / 4;
        matrix[column][row] = double{numbers[static_cast<std::size_t>(k)]};
    }
    return matrix;
}

}  // namespace

Result<void> validate(const Camera& camera) {
    const auto bad = [](ErrorCode code, const char* why) { return fail(code, kNoItem, why); };
    if (!is_finite(camera.position) || !is_finite(camera.forward) || !is_finite(camera.up))
        return bad(ErrorCode::non_finite, "camera: position, forward or up is NaN or infinite");
    const double scale = glm::length(camera.forward) * glm::length(camera.up);
    if (!(glm::length(glm::cross(camera.forward, camera.up)) > 1e-9 * scale))
        return bad(ErrorCode::degenerate, "camera: forward and up are parallel or zero; choose another up");
    if (camera.projection == Projection::perspective) {
        if (!(camera.fov_y > 1e-6 && camera.fov_y < std::numbers::pi - 1e-6))
            return bad(ErrorCode::out_of_range, "camera: fov_y must lie in (1e-6, pi - 1e-6) radians");
        if (!(camera.near_distance > 0.0)) return bad(ErrorCode::out_of_range, "camera: near must be positive");
    } else {
        if (!(camera.height > 0.0 && std::isfinite(camera.height)))
            return bad(ErrorCode::out_of_range, "camera: height must be positive");
        if (!std::isfinite(camera.far_distance))
            return bad(ErrorCode::out_of_range, "camera: an orthographic far must be finite");
    }
    if (!(camera.aspect > 0.0 && std::isfinite(camera.aspect)))
        return bad(ErrorCode::out_of_range, "camera: aspect must be positive");
    if (!std::isfinite(camera.near_distance)) return bad(ErrorCode::non_finite, "camera: near is NaN or infinite");
    if (!(camera.far_distance > camera.near_distance))
        return bad(ErrorCode::out_of_range, "camera: far must be greater than near");
    return {};
}

glm::dmat3 world_to_view_rotation(const Camera& camera) {
    const glm::dvec3 forward = glm::normalize(camera.forward);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    return glm::dmat3(right.x, up.x, -forward.x, right.y, up.y, -forward.y, right.z, up.z, -forward.z);
}

glm::dmat4 matrix_of(std::span<const float, 16> numbers, MatrixOrder order) {
    return read_matrix(numbers, order);
}

glm::dmat4 matrix_of(std::span<const double, 16> numbers, MatrixOrder order) {
    return read_matrix(numbers, order);
}

glm::dmat4 view_to_clip(const Camera& camera, DepthRange depth) {
    const double n = camera.near_distance, f = camera.far_distance;
    glm::dmat4 m(0.0);
    // Depth row for clip z in [0, w] with near at 0: z_clip = −(a·z + b) as a function of the view's z ≤ 0.
    double z_scale, z_offset;
    if (camera.projection == Projection::perspective) {
        const double y_scale = 1.0 / tangent(0.5 * camera.fov_y);
        m[0][0] = y_scale / camera.aspect;
        m[1][1] = y_scale;
        m[2][3] = -1.0;
        const bool infinite = std::isinf(f);
        switch (depth) {
            case DepthRange::reversed_zero_to_one:
                z_scale = infinite ? 0.0 : n / (f - n);
                z_offset = infinite ? n : f * n / (f - n);
                break;
            case DepthRange::zero_to_one:
                z_scale = infinite ? -1.0 : -f / (f - n);
                z_offset = infinite ? -n : -f * n / (f - n);
                break;
            default:
                z_scale = infinite ? -1.0 : -(f + n) / (f - n);
                z_offset = infinite ? -2.0 * n : -2.0 * f * n / (f - n);
                break;
        }
    } else {
        m[1][1] = 2.0 / camera.height;
        m[0][0] = m[1][1] / camera.aspect;
        m[3][3] = 1.0;
        switch (depth) {
            case DepthRange::reversed_zero_to_one:
                z_scale = 1.0 / (f - n);
                z_offset = f / (f - n);
                break;
            case DepthRange::zero_to_one:
                z_scale = -1.0 / (f - n);
                z_offset = -n / (f - n);
                break;
            default:
                z_scale = -2.0 / (f - n);
                z_offset = -(f + n) / (f - n);
                break;
        }
    }
    m[2][2] = z_scale;
    m[3][2] = z_offset;
    return m;
}

glm::dmat4 world_to_clip(const Camera& camera, DepthRange depth) {
    glm::dmat4 world_to_view(world_to_view_rotation(camera));
    world_to_view[3] = glm::dvec4(-(world_to_view_rotation(camera) * camera.position), 1.0);
    return view_to_clip(camera, depth) * world_to_view;
}

}  // namespace crofton
