// SPDX-License-Identifier: MIT
// A scene as one static vertex and index buffer, and a set of visible instances as ranges of it.
#pragma once
#include <crofton/render/clip_space.hpp>
#include <crofton/render/rasterizer.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <span>
#include <vector>

namespace crofton::pipeline {

// Instances that never move are baked in world coordinates, side by side in the order given: what is visible together
// then draws as one range. Movers, and all instances of scenes too large to bake, share their mesh's vertices and have
// a transform each.
class DrawList {
  public:
    // By mesh, and possibly shorter, the rest being 0.
    struct Looks {
        std::span<const std::uint8_t> unlit{};      // shows its colours as they are
        std::span<const std::uint8_t> one_sided{};  // does not show its back faces
        std::span<const std::uint8_t> flat{};       // each face has its own normal
    };
    // `order` lists the instances as they should lie in the buffer, a tree's leaf order; `is_mover` is by instance.
    DrawList(const scene::Scene& scene, std::span<const scene::InstanceId> order,
             std::span<const std::uint8_t> is_mover, const Looks& looks);

    [[nodiscard]] std::span<const render::Vertex> vertices() const { return vertices_; }
    [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }

    // Ranges and transforms for these instances and camera, front to back: what lies behind then stores no pixels.
    void select(std::span<const scene::InstanceId> visible, const Camera& camera);
    [[nodiscard]] std::span<const render::DrawRange> ranges() const { return ranges_; }
    [[nodiscard]] std::span<const render::DrawTransform> transforms() const { return transforms_; }
    // Baked instances share these first transforms, lit and unlit; the others are one instance's each.
    static constexpr std::uint32_t kSharedTransforms = 2;
    // The instance that ranges()[i] draws.
    [[nodiscard]] scene::InstanceId instance_of(std::size_t range) const { return instances_[selected_[range]]; }

    // Σ (vertices of the clipped polygon − 2) over the selection, as lavapipe will count it.
    [[nodiscard]] std::uint64_t predict_clipped();

  private:
    struct Part {  // a run of vertices with the indices that refer to it, counted from its first vertex
        std::uint32_t first_vertex = 0, vertex_count = 0, first_index = 0, index_count = 0;
        Aabb bounds;  // of the vertices
    };

    void sort_front_to_back(std::span<const scene::InstanceId> visible, const glm::dvec3& eye);
    Part append(std::span<const render::Vertex> vertices, std::span<const std::uint32_t> local_indices);

    const scene::Scene& scene_;
    glm::dvec3 baked_origin_{0.0};
    Vector<render::Vertex> vertices_;
    Vector<glm::vec3> positions_;
    Vector<std::uint32_t> indices_;                        // into vertices_
    Vector<std::uint32_t> local_indices_;                  // the same, from each part's first vertex
    std::vector<scene::InstanceId> instances_;             // by rank: the order in the buffer
    std::vector<std::uint32_t> ranks_;                     // by instance
    std::vector<Part> parts_;                              // by rank
    std::vector<std::uint8_t> baked_, unlit_, one_sided_;  // by rank
    std::vector<std::uint64_t> order_;                     // scratch
    std::vector<std::uint32_t> selected_;                  // ranks, front to back
    std::vector<render::DrawRange> ranges_;
    std::vector<render::DrawTransform> transforms_;
    render::ClipPredictor predictor_;
};

}  // namespace crofton::pipeline
