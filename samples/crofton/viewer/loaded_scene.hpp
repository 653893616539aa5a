// SPDX-License-Identifier: MIT
// A scene with its culling and collisions, ready to be asked once a frame.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "assets/scene_source.hpp"
#include "mesh_world.hpp"
#include "occlusion.hpp"
#include "pipeline/pipeline.hpp"
#include "settings.hpp"

namespace crofton::viewer {

struct SceneRequest {
    std::string source = "town";
    std::string map;
    std::uint64_t seed = 1;
    std::uint32_t instances = 0;
    assets::ReadLimits limits = {};
    bool strict = false;
};

class LoadedScene {
  public:
    // Loads the scene, fits its boxes and cuts its triangles as the method asks. Errors: as assets::load_scene.
    [[nodiscard]] static Result<std::unique_ptr<LoadedScene>> load(const SceneRequest& request, const Method& method,
                                                                   const Settings& settings);
    [[nodiscard]] const Method& method() const { return method_; }
    // True where `method` needs other boxes or triangles than the scene was loaded with: then load() anew.
    [[nodiscard]] bool needs_reload(const Method& method) const;
    // Takes over switches that need no reload; rebuilds the tree only where one changed.
    [[nodiscard]] Result<void> configure(const Method& method, const Settings& settings);

    // Moves what moves to the given time and follows it.
    void animate(std::uint32_t frame);
    [[nodiscard]] Result<pipeline::FrameStatistics> run(const Camera& camera);

    // What run() found hidden; nullptr where the method does not ask.
    [[nodiscard]] const Occlusion* occlusion() const { return method_.occlude ? &occlusion_ : nullptr; }
    // The scene's meshes as they stand now, with contacts between movers where the settings show them. Made when first
    // asked for: most visits need it late or never. Errors: as MeshWorld::create.
    [[nodiscard]] Result<MeshWorld*> mesh_world();

    [[nodiscard]] const assets::SceneSource& source() const { return source_; }
    [[nodiscard]] const scene::Scene& scene() const { return source_.scene; }
    [[nodiscard]] const pipeline::Pipeline& pipeline() const { return *pipeline_; }
    [[nodiscard]] const Aabb& extent() const { return extent_; }
    // Where most triangles are: without the far landscape and the odd stray.
    [[nodiscard]] const Aabb& focus() const { return focus_; }
    [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }

  private:
    explicit LoadedScene(assets::SceneSource source) : source_(std::move(source)) {}

    assets::SceneSource source_;
    std::optional<pipeline::Pipeline> pipeline_;
    std::optional<MeshWorld> mesh_world_;
    bool mesh_world_is_old_ = false, shows_contacts_ = false;
    Occlusion occlusion_;
    Method method_;
    pipeline::PipelineOptions options_;
    Aabb extent_, focus_;
    std::uint64_t triangle_count_ = 0;
    double update_us_ = 0.0;
};

}  // namespace crofton::viewer
