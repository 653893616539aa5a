// SPDX-License-Identifier: MIT
// Finds the triangles that a picture needs, front to back, by the depth of the triangles it has already found.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>

namespace crofton::depth {

// One drawn mesh. `to_clip` takes model coordinates to clip coordinates, as the vertex shader does, in float.
struct DepthObject {
    const ClusteredMesh* mesh = nullptr;  // must outlive the call
    glm::mat4 to_clip{1.0f};
    // Set it where the renderer drops back faces: those are never listed then, and hide nothing. Front faces are
    // counter-clockwise seen with y up.
    bool one_sided = false;
    // Clear it for alpha-tested and transparent things: they are culled, and hide nothing.
    bool hides = true;
    // How far the drawn vertices may lie from the mesh's, in the model's units, beyond what the product `to_clip` ·
    // vertex rounds: 0 unless the renderer uses other vertices (placed in the world beforehand, quantised).
    float position_error = 0.0f;
};

// The picture that is drawn: one sample a pixel, at its centre.
struct PictureView {
    static constexpr std::uint32_t kMaxSize = 16'384;

    std::uint32_t width = 1280;  // 1 to kMaxSize pixels
    std::uint32_t height = 720;
    DepthRange depth = DepthRange::reversed_zero_to_one;
};

// A cluster with a triangle that may own a sample. Bit k of `triangles` stands for triangle
// mesh.clusters()[cluster].first_triangle + k; at least one is set.
struct VisibleCluster {
    std::uint32_t object = 0;
    std::uint32_t cluster = 0;
    std::uint64_t triangles = 0;
};

struct DepthStatistics {
    std::uint64_t objects_listed = 0;   // with at least one triangle
    std::uint64_t objects_asked = 0;    // whose bounds cover a sample of the picture
    std::uint64_t clusters_asked = 0;   // of the objects that were not hidden as a whole
    std::uint64_t clusters_drawn = 0;   // that were not hidden as a whole
    std::uint64_t triangles_drawn = 0;  // of those clusters
    std::uint64_t triangles_listed = 0;
};

// Finds, for a picture of opaque triangles with the depth test on, the triangles without which it would change.
//
// The promise: draw the listed triangles, or any set of triangles that contains them, in the order in which you would
// draw all, and the picture has the same bits. It holds for this picture, at its samples (one a pixel): a larger
// picture needs another call. It holds for renderers that
// - compute positions as to_clip · vertex in float, in any order of operations, and snap them to a grid of at most
//   1/256 pixel (Vulkan's subPixelPrecisionBits ≥ 8),
// - cover no sample twice and leave none out where two triangles share an edge,
// - never give a sample a depth nearer than the triangle's nearest vertex, and write and compare depth as 32-bit
// floats. docs/notes/depth.md derives the margins.
//
// Keeps its memory between calls: once warm it allocates nothing. One culler per thread.
class DepthCuller {
  public:
    DepthCuller();
    ~DepthCuller();
    DepthCuller(DepthCuller&&) noexcept;
    DepthCuller& operator=(DepthCuller&&) noexcept;

    // Lists by object, then by cluster, both ascending. Objects wholly outside of the picture cost little, but are
    // better left out (World::view). Valid until the next call.
    //
    // Errors: a size out of range; an object without a mesh (item = object). A matrix or an error that is not finite
    // makes its object visible as a whole, and it hides nothing.
    [[nodiscard]] Result<std::span<const VisibleCluster>> find_visible(std::span<const DepthObject> objects,
                                                                       const PictureView& view);

    [[nodiscard]] const DepthStatistics& statistics() const;

    // The nearness that the listed triangles surely have at a pixel, of the last call: depth, negated unless reversed;
    // minus infinity where none surely covers it. Row 0 is at the bottom. Requires x < width, y < height.
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const;

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::depth
