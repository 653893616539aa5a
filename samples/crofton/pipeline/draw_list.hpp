// SPDX-License-Identifier: MIT
// A scene's meshes as one static vertex and index buffer, and what is visible as ranges of it.
#pragma once
#include <crofton/depth/depth_culler.hpp>
#include <crofton/render/clip_space.hpp>
#include <crofton/render/rasterizer.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drawables.hpp"
#include "frame_statistics.hpp"
#include "scene_clusters.hpp"

namespace crofton::pipeline {

// Instances share the vertices of their mesh and have a transform each.
class DrawList {
  public:
    // By mesh, and possibly shorter, the rest being 0.
    struct Looks {
        std::span<const std::uint8_t> unlit{};      // shows its colours as they are
        std::span<const std::uint8_t> one_sided{};  // does not show its back faces
        std::span<const std::uint8_t> flat{};       // each face has its own normal
    };
    // With `clusters`, of this scene, triangles lie in their order, so that a cluster is a range.
    DrawList(const scene::Scene& scene, const Looks& looks, std::shared_ptr<const SceneClusters> clusters = nullptr)
        : DrawList(std::make_shared<SceneDrawables>(scene), looks, std::move(clusters)) {}
    // The meshes are those of now.
    DrawList(std::shared_ptr<const Drawables> drawables, const Looks& looks,
             std::shared_ptr<const SceneClusters> clusters);

    [[nodiscard]] std::span<const render::Vertex> vertices() const { return vertices_; }
    [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }

    // Ranges and transforms for these instances and camera, front to back: what lies behind then stores no pixels.
    void select(std::span<const scene::InstanceId> visible, const Camera& camera);
    // For these triangles alone, in the same order; objects are instances, ascending. Requires clusters.
    void select(std::span<const depth::VisibleCluster> visible, const Camera& camera);
    // Selects what a frame with occlusion draws: triangles or whole instances, in the order found.
    void select(const OccludedFrame& frame, const Camera& camera);
    [[nodiscard]] std::span<const render::DrawRange> ranges() const { return ranges_; }
    // One an instance.
    [[nodiscard]] std::span<const render::DrawTransform> transforms() const { return transforms_; }
    // The instance that ranges()[i] draws.
    [[nodiscard]] scene::InstanceId instance_of(std::size_t range) const {
        return selected_[ranges_[range].transform].instance;
    }

    // The entry of the clusters given to select() that ranges()[i] belongs to.
    [[nodiscard]] std::size_t piece_of(std::size_t range) const { return piece_of_range_[range]; }

    // Σ (vertices of the clipped polygon − 2) over the selection, as lavapipe will count it.
    [[nodiscard]] std::uint64_t predict_clipped();

  private:
    struct Part {  // a run of vertices with the indices that refer to it, counted from its first vertex
        std::uint32_t first_vertex = 0, vertex_count = 0, first_index = 0, index_count = 0;
        Aabb bounds;  // of the vertices
    };
    struct Selected {
        scene::InstanceId instance;
        bool one_sided;
        std::size_t begin = 0, end = 0;  // of the clusters given, where there are some
    };

    void append(scene::MeshId mesh, bool flat);
    // Puts what selected_ holds in order, and makes its transforms.
    void place(const Camera& camera);
    [[nodiscard]] bool is_unclipped(std::size_t selected, const Aabb& bounds) const;
    void add_range(std::size_t selected, std::uint32_t first_index, std::uint32_t index_count, bool unclipped);

    std::shared_ptr<const Drawables> drawables_;
    std::shared_ptr<const SceneClusters> clusters_;
    Vector<render::Vertex> vertices_;
    Vector<glm::vec3> positions_;
    Vector<std::uint32_t> indices_;                               // into vertices_
    Vector<std::uint32_t> local_indices_;                         // the same, from each part's first vertex
    std::vector<Part> parts_;                                     // by mesh
    std::vector<std::uint8_t> unlit_, one_sided_;                 // by mesh
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  // scratch
    std::vector<Selected> selected_, unsorted_;                   // front to back; by instance
    std::vector<render::DrawRange> ranges_;
    std::vector<std::size_t> piece_of_range_;
    std::vector<render::DrawTransform> transforms_;
    render::ClipPredictor predictor_;
};

}  // namespace crofton::pipeline
