// SPDX-License-Identifier: MIT
// Transforms from model to clip coordinates in float, and a prediction of how many triangles a software clipper makes
// of a mesh.
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

// Makes the float matrix of a drawn mesh by which both CPU and GPU multiply, so that they agree bit for bit. It is
// composed in double relative to the camera and rounded once, so precision does not suffer at large offsets.
class ModelToClip {
  public:
    // Requires validate(camera).
    explicit ModelToClip(const Camera& camera, DepthRange depth = DepthRange::reversed_zero_to_one);

    // Returns the matrix for the placement x ↦ linear · x + translation in world coordinates.
    [[nodiscard]] glm::mat4 operator()(const glm::dmat3& linear, const glm::dvec3& translation) const;

  private:
    glm::dvec3 camera_position_;
    glm::dmat4 from_camera_relative_;
};

// The rasterizer moves each triangle back by this share of its steepest depth slope, from one pixel to the next.
//
// A device computes a triangle's depth from its exact vertices, and its pixels from vertices snapped to a grid of 1/256
// pixel. A pixel may thus lie up to 1/512 pixel along each axis beyond the triangle. Without the bias a triangle seen
// edge-on would be drawn far nearer than any of its vertices.
inline constexpr float kDepthSlopeBias = -1.0f / 256.0f;

// Returns true only if the float pipeline finds no point of `bounds` beyond a clip plane of |x| ≤ w, |y| ≤ w, 0 ≤ z ≤
// w. A mesh inside is drawn without any clipping. Returns false for boxes within rounding of a plane.
[[nodiscard]] bool inside_clip_planes(const Aabb& bounds, const glm::mat4& model_to_clip);

// Predicts the `clipping primitives` that Mesa's software pipeline (lavapipe) counts.
//
// Each triangle is clipped, in float, by the planes of |x| ≤ w, |y| ≤ w, 0 ≤ z ≤ w; a polygon of n ≥ 3 vertices counts
// n − 2. This is not the number of triangles that meet the frustum, because clipping repeats vertices that lie on
// planes, and rounds. Back-facing and degenerate triangles count. A triangle with a NaN, or with an infinite distance
// from a plane that it crosses, counts nothing.
//
// The count is equal bit for bit if the vertex shader computes ((column0·x + column1·y) + column2·z) + column3 without
// contraction, on a CPU that flushes denormals as Mesa sets up x86-64. tests/render compares it with lavapipe.
class ClipPredictor {
  public:
    // Returns Σ(n − 2) over the triangles `indices` of `positions`. Requires indices < positions.size(), a multiple of
    // 3 of them. Keeps scratch memory between calls: allocates only while meshes grow. Use one predictor per thread.
    [[nodiscard]] std::uint64_t count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                      const glm::mat4& model_to_clip);

    // Returns the same sum for positions that all lie in `bounds`. A mesh inside all planes, or beyond one, by more
    // than the rounding of floats is counted by its bounds alone.
    [[nodiscard]] std::uint64_t count(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                      const glm::mat4& model_to_clip, const Aabb& bounds);

  private:
    Vector<std::uint8_t> codes_;  // per position: bit k set where it lies outside plane k
};

}  // namespace crofton::render
