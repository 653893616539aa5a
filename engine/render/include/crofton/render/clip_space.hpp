// SPDX-License-Identifier: MIT
// Model coordinates to clip coordinates in float, and how many triangles a software clipper makes of a mesh there.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::render {

// Makes the one float matrix per drawn mesh that CPU and GPU both multiply by, so that they agree to the bit. Composed
// in double relative to the camera, rounded once: coordinates lose nothing at large offsets.
class ModelToClip {
  public:
    // Requires validate(camera).
    explicit ModelToClip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

    // For the placement x ↦ linear · x + translation in world coordinates.
    [[nodiscard]] glm::mat4 operator()(const glm::dmat3& linear, const glm::dvec3& translation) const;

  private:
    glm::dvec3 camera_position_;
    glm::dmat4 from_camera_relative_;
};

// The rasterizer moves each triangle back by this share of its steepest slope of depth, from one pixel to the next. A
// device sets up a triangle's depth from its vertices as they are, and its pixels from vertices snapped to a grid of
// 1/256 pixel. A pixel may so lie up to 1/512 pixel along each axis beyond the triangle. Without the bias a triangle
// seen edge-on would be drawn far nearer than any of its vertices.
inline constexpr float kDepthSlopeBias = -1.0f / 256.0f;

// True only where the float pipeline finds no point of `bounds` beyond a clip plane of |x| ≤ w, |y| ≤ w, 0 ≤ z ≤ w. A
// mesh within is drawn without any clipping. Boxes within rounding of a plane are answered false.
[[nodiscard]] bool inside_clip_planes(const Aabb& bounds, const glm::mat4& model_to_clip);

// Predicts the `clipping primitives` that Mesa's software pipeline (lavapipe) counts. Each triangle is clipped, in
// float, by the planes of |x| ≤ w, |y| ≤ w, 0 ≤ z ≤ w; a polygon of n ≥ 3 vertices counts n − 2. This is not the number
// of triangles that meet the frustum: clipping repeats vertices that lie on planes, and rounds. Back-facing and
// degenerate triangles count; a triangle with a NaN counts nothing, nor does one whose distance from a plane it crosses
// is infinite.
//
// Equal to the bit when the vertex shader computes ((column0·x + column1·y) + column2·z) + column3 without contraction,
// on a CPU that flushes denormals as Mesa sets up x86-64. Verified by tests/render against lavapipe itself.
class ClipPredictor {
  public:
    // Σ(n − 2) over the triangles `indices` of `positions`. Requires indices < positions.size(), a multiple of 3 of
    // them. Keeps scratch memory between calls: allocates only while meshes grow. One predictor per thread.
    [[nodiscard]] std::uint64_t count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                      const glm::mat4& model_to_clip);

    // The same sum for positions that all lie in `bounds`. A mesh inside all planes, or beyond one, by more than the
    // floats can round, is counted by its bounds alone.
    [[nodiscard]] std::uint64_t count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                      const glm::mat4& model_to_clip, const Aabb& bounds);

  private:
    Vector<std::uint8_t> codes_;  // per position: bit k set where it lies outside plane k
};

}  // namespace crofton::render
