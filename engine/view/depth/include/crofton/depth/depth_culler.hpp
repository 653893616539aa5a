// SPDX-License-Identifier: MIT
// Finds the triangles that a picture needs, from front to back: triangles behind those found before are left out.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>

namespace crofton::depth {

// One drawn mesh. `to_clip` takes model coordinates to clip coordinates: the float matrix of the vertex shader.
struct DepthObject {
    const ClusteredMesh* mesh = nullptr;  // must outlive the call
    glm::mat4 to_clip{1.0f};
    // Set it if the renderer drops back faces: they are then not listed and hide nothing. Front faces are
    // counter-clockwise in clip coordinates with y up.
    bool one_sided = false;
    // Clear it for alpha-tested and transparent objects: they are culled, but hide nothing.
    bool hides = true;
    // The largest distance of a drawn vertex from the mesh's vertex, in the model's units, in addition to the rounding
    // of `to_clip` · vertex. 0 unless the renderer draws other vertices (transformed to the world beforehand,
    // quantised).
    float position_error = 0.0f;
};

// The picture that is drawn.
struct PictureView {
    static constexpr std::uint32_t kMaxSize = 16'384;

    std::uint32_t width = 1280;  // 1 to kMaxSize pixels
    std::uint32_t height = 720;
    DepthRange depth = DepthRange::reversed_zero_to_one;

    // In each pixel: 1, at its centre, or 2, 4 or 8 for multisampling, at Vulkan's standard sample locations, where y
    // points up. What is visible at any of them is listed, which takes the time of so many pictures.
    std::uint32_t samples = 1;

    // Bounds the time where little is hidden: 0 for no limit, otherwise a number of clusters that are tested and of
    // triangles that are drawn, together. An average one takes some 50 to 200 ns. After that, an object or a cluster is
    // still tested by its box, and if the box may be visible, it is listed whole and hides nothing.
    // With several samples it is a limit for each.
    std::uint64_t work_limit = 0;

    // Errors, with this item: a size or a number of samples out of range.
    [[nodiscard]] Result<void> check(std::uint64_t item = kNoItem) const;
};

class DepthCuller;

// An object of a camera's picture, with its place in a light's shadow map.
struct DepthReceiver {
    const ClusteredMesh* mesh = nullptr;  // the same as in the picture; read only if something of the object is seen
    glm::mat4 to_map{1.0f};               // takes model coordinates to clip coordinates of the map, as the shader does
    // Set it if anything within the mesh's bound may be seen, and not its triangles only.
    bool solid = false;
};

// The points that look a shadow map up: those that a camera sees.
struct DepthReceivers {
    static constexpr float kMaxRadius = 1024.0f;

    const DepthCuller* seen = nullptr;            // its last answer is that of find_visible() for the camera's picture
    std::span<const DepthReceiver> objects = {};  // one for each object of that call
    // A lookup reads texels whose centres are at most this far from its point along each axis, in texels: 0.5 for the
    // nearest texel, 1 for a bilinear comparison, r + 1 for one in each of (2 r + 1)² texels. Add the texels by which
    // the shader moves the point, if it does.
    float radius = 1.0f;

    [[nodiscard]] static bool has_radius(float texels) { return texels >= 0.5f && texels <= kMaxRadius; }
};

// A cluster with at least one triangle that may be visible at a sample. If bit k of `triangles` is set, draw triangle
// mesh.clusters()[cluster].first_triangle + k.
struct VisibleCluster {
    std::uint32_t object = 0;
    std::uint32_t cluster = 0;
    std::uint64_t triangles = 0;
};

// Counts of the last call. With several samples per pixel, objects and clusters are counted once for each sample.
struct DepthStatistics {
    std::uint64_t objects_listed = 0;  // with at least one triangle
    std::uint64_t objects_asked = 0;   // whose bounds may cover a sample of the picture
    std::uint64_t clusters_asked = 0;  // of objects that are not hidden as a whole
    std::uint64_t clusters_drawn = 0;  // those that are not hidden as a whole
    // Triangles of the drawn clusters. work_limit was exceeded if this plus clusters_asked is more.
    std::uint64_t triangles_drawn = 0;
    std::uint64_t triangles_listed = 0;
};

// Finds the triangles without which a picture of opaque triangles, drawn with the depth test, would change.
//
// Draw the listed triangles, or any set that contains them, in the order in which you would draw all triangles: the
// picture has the same bits. This holds only for the size and the samples given; others need another call. It holds for
// renderers that
// - compute positions as to_clip · vertex in float, in any order of operations, and snap them to a grid of at most
//   1/256 pixel (Vulkan's subPixelPrecisionBits ≥ 8),
// - cover no sample twice and leave none out where two triangles share an edge,
// - never give a sample a depth nearer than the triangle's nearest vertex, and write and compare depth as 32-bit
// floats. docs/notes/depth.md derives the margins.
//
// Keeps its memory between calls and allocates only when it must grow. Keeps no pointer to what a call was given. Use
// one culler per thread; with an executor one call may use several threads.
class DepthCuller {
  public:
    DepthCuller();
    ~DepthCuller();
    DepthCuller(DepthCuller&&) noexcept;
    DepthCuller& operator=(DepthCuller&&) noexcept;

    // Returns visible clusters by object, then by cluster, both ascending; valid until the next call. Leave out objects
    // outside the frustum (World::view): it is faster. The answer has the same bits with any executor.
    //
    // Errors: a size or a number of samples out of range; an object without a mesh (item = object). If an object's
    // matrix or position_error is not finite, all its triangles are listed and it hides nothing.
    [[nodiscard]] Result<std::span<const VisibleCluster>> find_visible(std::span<const DepthObject> objects,
                                                                       const PictureView& view,
                                                                       Executor& executor = serial_executor());

    // Finds the triangles without which a shadow on what a camera sees would change. `objects` are the casters, with
    // matrices to the clip coordinates of `map`.
    //
    // Draw the listed triangles into the map, or any set that contains them. Each lookup by a point of what the camera
    // sees gives the same bits as with all casters: at each texel that it reads, the map has the same depth, or both
    // depths are farther from the light than the point. This holds for comparisons with the point's depth, or one that
    // is nearer to the light, as shaders with a bias compare; for renderers as above, without slope-scaled depth bias
    // in the map; and for shaders that look up points of the triangles (docs/depth.md).
    //
    // Errors: as find_visible(); no culler in `receivers`, or this one, or one whose last answer is not that of
    // find_visible(); a number of its objects that is not that of the camera's; an object that is seen without a mesh,
    // or with another than in the camera's picture (item = object; ClusteredMesh::identity()); a radius out of
    // [0.5, kMaxRadius]; a map with several samples.
    [[nodiscard]] Result<std::span<const VisibleCluster>> find_casters(std::span<const DepthObject> objects,
                                                                       const PictureView& map,
                                                                       const DepthReceivers& receivers,
                                                                       Executor& executor = serial_executor());

    [[nodiscard]] const DepthStatistics& statistics() const;

    // Returns a lower bound for the nearness of the listed triangles at a pixel, after the last call. After
    // find_casters(), it may also be the least nearness at which a caster matters there: infinity where no point is
    // looked up. Nearness is
    // depth, negated unless the range is reversed; minus infinity where no triangle surely covers the pixel. Row 0 is
    // at the bottom. Where a pixel has several samples, it is that of the first. Requires x < width, y < height.
    [[nodiscard]] float nearness(std::uint32_t x, std::uint32_t y) const;

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::depth
