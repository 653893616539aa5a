// SPDX-License-Identifier: MIT
// Why each cluster of triangles is drawn or not, by the depth of what is drawn before it, and in which colour that is
// shown.
#pragma once
#include <array>
#include <crofton/depth/depth_culler.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "assets/scene_source.hpp"
#include "pipeline/scene_clusters.hpp"

namespace crofton::viewer {

// In this order: a triangle has the first that holds.
enum class Fate : std::uint8_t {
    drawn,            // DepthCuller lists it
    outside,          // of the frustum
    faces_away,       // of a one-sided mesh
    between_samples,  // covers no sample of the picture
    hidden,           // by what is drawn
};
inline constexpr std::size_t kFates = 5;

class ClusterColoring {
  public:
    struct Count {
        const char* name;
        glm::vec3 color;  // linear RGB
        std::uint64_t clusters, triangles;
    };

    // Finds the fate of every triangle for a picture that `camera` takes. `in_view`, ascending: the instances whose
    // bounds meet the frustum. Errors: as DepthCuller::find_visible().
    [[nodiscard]] Result<void> classify(const assets::SceneSource& source, const pipeline::SceneClusters& clusters,
                                        std::span<const scene::InstanceId> in_view, const Camera& camera,
                                        const depth::PictureView& picture);

    // Every triangle of every instance that is not hidden by its layers, in groups of one fate. Objects are instances,
    // ascending.
    [[nodiscard]] std::span<const depth::VisibleCluster> pieces() const { return pieces_; }
    // By piece, linear RGB. Clusters that lie side by side have different shades.
    [[nodiscard]] const glm::vec3& color_of_piece(std::size_t piece) const { return colors_[shades_[piece]]; }
    // A number for each colour.
    [[nodiscard]] std::uint8_t shade_of_piece(std::size_t piece) const { return shades_[piece]; }

    // By fate. A cluster is drawn if a triangle of it is, else hidden if one is, and so on up to outside.
    [[nodiscard]] std::span<const Count> counts() const { return counts_; }

  private:
    void add_outside(scene::InstanceId instance, const depth::ClusteredMesh& mesh);
    void add_in_view(scene::InstanceId instance, const TriangleMesh& mesh, const depth::DepthObject& object,
                     const depth::PictureView& picture);
    void add_cluster(scene::InstanceId instance, std::uint32_t cluster,
                     const std::array<std::uint64_t, kFates>& triangles);

    depth::DepthCuller culler_;
    std::vector<depth::DepthObject> objects_;
    std::vector<std::uint64_t> listed_;  // by cluster of the object at hand
    std::vector<depth::VisibleCluster> pieces_;
    std::vector<std::uint8_t> shades_;
    std::vector<glm::vec3> colors_;
    std::array<Count, kFates> counts_{};
};

}  // namespace crofton::viewer
