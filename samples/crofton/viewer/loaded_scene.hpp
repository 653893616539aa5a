// SPDX-License-Identifier: MIT
// A scene with its culling and collisions, ready to be asked once a frame.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "assets/scene_source.hpp"
#include "instance_shapes.hpp"
#include "occlusion.hpp"
#include "pipeline/baked_parts.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/region_pipeline.hpp"
#include "settings.hpp"

namespace crofton::viewer {

struct SceneRequest {
    std::string source = "town";
    std::string map;
    std::string baked = {};  // a .crofton file with occluders or visible sets of the scene
    std::uint64_t seed = 1;
    std::uint32_t instances = 0;
    assets::ReadLimits limits = {};
    bool strict = false;
    bool waits_for_regions = false;  // of a folder of regions, so that pictures do not depend on the time
    double unit = 0.0;               // metres that a length of 1 is; 0: as the file says
};

class LoadedScene {
  public:
    // Loads the scene, fits its boxes and cuts its triangles as the method asks. `like`: the same scene, loaded before;
    // where its triangles are the same its occluders are taken. Errors: as assets::load_scene and
    // pipeline::load_baked_parts.
    [[nodiscard]] static Result<std::unique_ptr<LoadedScene>> load(const SceneRequest& request, const Method& method,
                                                                   const Settings& settings,
                                                                   const LoadedScene* like = nullptr);
    [[nodiscard]] const Method& method() const { return method_; }
    // True where `method` needs other boxes or triangles than the scene was loaded with: then load() anew.
    [[nodiscard]] bool needs_reload(const Method& method) const;
    // Takes over switches that need no reload. The World is made anew for another kind of bound alone; occluders are
    // found once.
    [[nodiscard]] Result<void> configure(const Method& method, const Settings& settings);

    // Moves what moves to the given time and follows it.
    void animate(std::uint32_t frame);
    [[nodiscard]] std::uint32_t scene_frame() const { return scene_frame_; }
    [[nodiscard]] Result<pipeline::FrameStatistics> run(const Camera& camera);

    // Returns what run() found hidden; nullptr if the method has no occlusion.
    [[nodiscard]] const Occlusion* occlusion() const { return method_.occlude ? &occlusion_ : nullptr; }
    // Potentially visible sets that were baked of the scene; nullptr: none.
    [[nodiscard]] const pvs::Pvs* pvs() const { return baked_.pvs.get(); }
    // Clusters of the meshes that the scene's file had; nullptr: none.
    [[nodiscard]] std::shared_ptr<const pipeline::SceneClusters> clusters() const { return clusters_; }
    // The source is a folder of regions: scene() is then empty, and only colourings of instances work. nullptr: it is
    // none.
    [[nodiscard]] const pipeline::RegionPipeline* regions() const { return regions_ ? &*regions_ : nullptr; }
    [[nodiscard]] InstanceShapes& shapes() { return *shapes_; }

    [[nodiscard]] const assets::SceneSource& source() const { return source_; }
    [[nodiscard]] const scene::Scene& scene() const { return source_.scene; }
    [[nodiscard]] const pipeline::Pipeline& pipeline() const { return *pipeline_; }
    [[nodiscard]] const Aabb& extent() const { return extent_; }
    // Where most triangles are: without the far landscape and the odd stray.
    [[nodiscard]] const Aabb& focus() const { return focus_; }
    [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }

  private:
    explicit LoadedScene(assets::SceneSource source) : source_(std::move(source)) {}
    [[nodiscard]] static Result<std::unique_ptr<LoadedScene>> load_regions(const SceneRequest& request,
                                                                           const Settings& settings);
    [[nodiscard]] Result<void> take_baked(const SceneRequest& request, const Method& method, const LoadedScene* like);

    assets::SceneSource source_;
    std::optional<pipeline::Pipeline> pipeline_;
    std::optional<pipeline::RegionPipeline> regions_;
    std::optional<InstanceShapes> shapes_;
    pipeline::BakedParts baked_;
    std::shared_ptr<const pipeline::SceneClusters> clusters_;
    Occlusion occlusion_;
    Method method_;
    pipeline::PipelineOptions options_;
    Aabb extent_, focus_;
    std::uint64_t triangle_count_ = 0;
    double update_us_ = 0.0;
    std::uint32_t scene_frame_ = 0;
};

}  // namespace crofton::viewer
