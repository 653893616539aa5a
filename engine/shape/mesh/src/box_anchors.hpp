// SPDX-License-Identifier: MIT
// Lets the boxes of a mesh tree follow their vertices.
#pragma once
#include <crofton/mesh/mesh_layout.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::mesh {

// Chooses three of the points, far apart, and stores them and the box's axes in their frame as lane `lane` of
// `anchors`. `vertices` are the points' indices.
void set_anchors(const MeshBox& box, std::span<const glm::vec3> points, std::span<const std::uint32_t> vertices,
                 std::uint32_t lane, BoxAnchors& anchors);

// Frames that three points each span, sixteen side by side; [k][i]: component i of vector k. The first runs from a to
// b, the second lies in their plane. Where points coincide or are collinear, to a sine of 1e-3, the frame is any that
// the others allow. Orthonormal to 5e-7.
struct AnchorPoints {
    alignas(64) float a[3][kMeshNodeWidth], b[3][kMeshNodeWidth], c[3][kMeshNodeWidth];
};
struct AnchorFrames {
    alignas(64) float axes[3][3][kMeshNodeWidth];
};
void find_frames(const AnchorPoints& points, AnchorFrames& frames);

}  // namespace crofton::mesh
