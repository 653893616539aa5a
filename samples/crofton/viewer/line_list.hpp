// SPDX-License-Identifier: MIT
// Boxes, frusta and segments as lines for the rasterizer, relative to the eye.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/render/rasterizer.hpp>
#include <span>
#include <vector>

namespace crofton::viewer {

// RGBA with red in the lowest byte, as LineVertex has it.
constexpr std::uint32_t rgba(std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t a = 255) {
    return r | g << 8 | b << 16 | a << 24;
}

class LineList {
  public:
    void clear(const glm::dvec3& eye) {
        controller_ = eye;
        vertices_.clear();
    }
    void segment(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t color);
    void box(const Obb& box, std::uint32_t color);
    // The box's own axes from its centre, red, green and blue.
    void axes(const Obb& box);
    // Drawn to `far` where the camera sees farther.
    void frustum(const Camera& camera, double far, std::uint32_t color);
    void cross(const glm::dvec3& at, double size, std::uint32_t color);
    [[nodiscard]] std::span<const render::LineVertex> vertices() const { return vertices_; }

  private:
    glm::dvec3 controller_{0.0};
    std::vector<render::LineVertex> vertices_;
};

// The eight corners of what a camera sees up to `far`: near face left-bottom, right-bottom, left-top, right-top, then
// far.
[[nodiscard]] std::array<glm::dvec3, 8> view_corners(const Camera& camera, double far);

}  // namespace crofton::viewer
