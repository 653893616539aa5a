// SPDX-License-Identifier: MIT
// Maps pixels to rays and directions to pixels.
#pragma once
#include <cmath>
#include <crofton/core/error.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <optional>

namespace crofton::study {

// Pixels are counted from the picture's upper left corner; the middle of the first is (0.5, 0.5).
class PictureRays {
  public:
    [[nodiscard]] static Result<PictureRays> of(const Camera& camera, std::uint32_t width, std::uint32_t height) {
        if (auto valid = validate(camera); !valid) return valid.error();
        if (camera.projection != Projection::perspective)
            return fail(ErrorCode::unsupported, kNoItem, "picture: the camera is orthographic");
        if (width == 0 || height == 0 || std::uint64_t{width} * height > std::uint64_t{1} << 24)
            return fail(ErrorCode::out_of_range, kNoItem, "picture: no pixels, or more than 2^24");
        PictureRays rays;
        rays.to_view_ = world_to_view_rotation(camera);
        rays.size_ = {width, height};
        rays.half_.y = tangent(0.5 * camera.fov_y);
        rays.half_.x = rays.half_.y * camera.aspect;
        return rays;
    }

    // Unit, in the world.
    [[nodiscard]] glm::dvec3 direction(double x, double y) const {
        const glm::dvec3 view((2.0 * x / size_.x - 1.0) * half_.x, (1.0 - 2.0 * y / size_.y) * half_.y, -1.0);
        return glm::normalize(glm::transpose(to_view_) * view);
    }
    // Returns the pixel of a point relative to the eye; nothing if it lies outside the picture.
    [[nodiscard]] std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const {
        const glm::dvec3 view = to_view_ * point;
        if (!(view.z < 0.0)) return {};
        const double x = 0.5 * size_.x * (1.0 - view.x / (view.z * half_.x)),
                     y = 0.5 * size_.y * (1.0 + view.y / (view.z * half_.y));
        if (!(x >= 0.0 && x < size_.x && y >= 0.0 && y < size_.y)) return {};
        return glm::dvec2(x, y);
    }

  private:
    glm::dmat3 to_view_{1.0};
    glm::dvec2 size_{0.0}, half_{0.0};
};

}  // namespace crofton::study
