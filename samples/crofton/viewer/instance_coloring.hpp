// SPDX-License-Identifier: MIT
// Chooses the colour of each visible instance.
#pragma once
#include <crofton/geometry/camera.hpp>
#include <crofton/render/rasterizer.hpp>
#include <vector>

#include "cluster_coloring.hpp"
#include "loaded_scene.hpp"
#include "pipeline/draw_list.hpp"
#include "pipeline/object_counts.hpp"
#include "settings.hpp"

namespace crofton::viewer {

// The palette, linear RGB; tests find these hues again in screenshots.
namespace palette {
inline constexpr glm::vec3 kInside{0.06f, 0.55f, 0.08f};
inline constexpr glm::vec3 kStraddling{0.85f, 0.42f, 0.01f};
inline constexpr glm::vec3 kImproper{0.75f, 0.02f, 0.60f};
inline constexpr glm::vec3 kColliding{0.90f, 0.02f, 0.02f};
inline constexpr glm::vec3 kCalm{0.32f, 0.34f, 0.36f};
inline constexpr glm::vec3 kHidden{0.75f, 0.02f, 0.60f};
inline constexpr glm::vec3 kHides{0.85f, 0.42f, 0.01f};
inline constexpr glm::vec3 kFacesAway{0.03f, 0.08f, 0.45f};
inline constexpr glm::vec3 kHiddenByDepth{0.30f, 0.015f, 0.22f};
inline constexpr glm::vec3 kOutside{0.14f, 0.15f, 0.16f};
inline constexpr glm::vec3 kUnseen{0.85f, 0.42f, 0.01f};
inline constexpr glm::vec3 kHidesSelected{0.90f, 0.02f, 0.02f};
inline constexpr glm::vec3 kSelected{0.05f, 0.45f, 0.95f};
}  // namespace palette

// Turns a draw list's selection into ranges and transforms with tints, and into wires over them. Ranges that share a
// colour and lie side by side still become one draw.
class InstanceColoring {
  public:
    // Decides the colours for this frame. `frame` is what the scene's run() said for the camera that culls; `hiders`
    // hide the selected instance, with all of theirs.
    void classify(const LoadedScene& loaded, const pipeline::FrameStatistics& frame, Coloring coloring,
                  scene::InstanceId selected, std::span<const scene::NodeId> hiders);
    // Lays out the selection of `list`, which has been made for the camera that looks.
    // `clusters`: whose pieces it selects, where these have colours of their own; else null.
    void paint(const pipeline::DrawList& list, bool wireframe, const ClusterColoring* clusters);

    [[nodiscard]] std::span<const render::DrawRange> ranges() const { return ranges_; }
    [[nodiscard]] std::span<const render::DrawRange> wire_ranges() const { return wires_; }
    [[nodiscard]] std::span<const render::DrawTransform> transforms() const { return transforms_; }
    // Instances of each tint in the last classify(), by tint: see tint_names().
    struct Count {
        const char* name;
        glm::vec3 color;
        std::uint64_t instances;
    };
    [[nodiscard]] std::span<const Count> counts() const { return counts_; }

  private:
    void count(const char* name, const glm::vec3& color);
    // Those of the instances that are on one of the nodes. Returns how many.
    std::uint64_t tint_nodes(const scene::Scene& scene, std::span<const scene::InstanceId> instances,
                             std::span<const scene::NodeId> nodes, std::uint8_t tint);
    void paint_clusters(const pipeline::DrawList& list, const ClusterColoring& clusters);
    void classify_visible_set(const LoadedScene& loaded, const pipeline::FrameStatistics& frame);
    void classify_regions(const pipeline::RegionPipeline& regions, const pipeline::FrameStatistics& frame,
                          Coloring coloring, scene::InstanceId selected);
    void classify_sets(const pipeline::RegionPipeline& regions, const pipeline::FrameStatistics& frame);
    void tint_selected(scene::InstanceId selected);
    void classify_occlusion(const LoadedScene& loaded, const pipeline::FrameStatistics& frame);

    std::vector<std::uint8_t> tint_of_;  // by instance: index into counts_, kPlain for the vertices' own colours
    std::vector<Count> counts_;
    std::vector<render::DrawRange> ranges_, wires_;
    std::vector<render::DrawTransform> transforms_;
    std::vector<std::uint32_t> transform_of_shade_;  // of one instance
    pipeline::ObjectCounter counter_;
};

}  // namespace crofton::viewer
