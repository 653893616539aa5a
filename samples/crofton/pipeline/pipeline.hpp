// SPDX-License-Identifier: MIT
// One frame of the project's main job: a World follows the scene, is asked what a camera sees, and its answer is
// counted. Drawing is beside it, in draw_list.hpp.
#pragma once
#include <crofton/crofton.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bounds.hpp"
#include "frame_statistics.hpp"
#include "scene_clusters.hpp"
#include "scene_occluders.hpp"

namespace crofton::pipeline {

enum class CullMode : std::uint8_t { none, flat, tree };

[[nodiscard]] Result<CullMode> cull_mode_from(const std::string& name);
[[nodiscard]] const char* to_string(CullMode mode);
[[nodiscard]] Result<boxtree::Orientation> orientation_from(const std::string& name);
[[nodiscard]] const char* to_string(boxtree::Orientation orientation);

struct PipelineOptions {
    BoundsKind bounds = BoundsKind::obb_perimeter;
    CullMode cull = CullMode::tree;
    bool count_triangles = true;  // triangles_passed and improper, which cost more than the culling itself
    cull::CullMode mode = cull::CullMode::exact;
    bool collide = true;
    // Also asks what is not hidden: FrameStatistics::occlusion. Occluders are found in the scene's meshes when this is
    // first set, and kept.
    std::optional<OcclusionOptions> occlusion = {};
    // In place of `occlusion`: asks which triangles this picture needs, by the depth of those found before. Meshes are
    // cut into clusters when this is first set, unless they are given, and kept.
    std::optional<depth::PictureView> picture = {};
    // With `picture`: also lists the casters of a sun's shadow map, of so many texels each way, over the scene. 0:
    // none.
    std::uint32_t shadow_map = 0;
    std::shared_ptr<const SceneClusters> clusters = {};  // of this scene; nullptr: not known
    std::span<const std::uint8_t> one_sided = {};        // by mesh, as DrawList::Looks; must live as long
    boxtree::Orientation tree = boxtree::Orientation::aligned;
    TraceHooks trace = {};
};

// Returns the camera of a sun's shadow map: an orthographic square around `center`, for casters up to 2 `reach` away.
[[nodiscard]] Camera sun_over(const glm::dvec3& center, double half_width, double reach);

// The layer of the objects that stand for instances; views ask for it.
inline constexpr std::uint32_t kSeenLayer = 1;

// Keeps a World of the instances' bounds. The scene is the caller's; between its update() and run() nothing may change
// it.
class Pipeline {
  public:
    // `movers`: the instances whose collisions are of interest. The scene has been updated. `occluders`: known ones of
    // this scene, as find_scene_occluders() gives them; without, they are found.
    // Errors: a bound that the World refuses, named by its instance.
    [[nodiscard]] static Result<Pipeline> create(const scene::Scene& scene, std::vector<scene::InstanceId> movers,
                                                 const PipelineOptions& options, Executor& executor,
                                                 std::shared_ptr<const SceneOccluders> occluders = nullptr);
    ~Pipeline();
    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;

    // Takes over all options but `bounds`, `tree` and `trace`, which stay as they were created. The World stays, and
    // the occluders that it has. Errors: as create().
    [[nodiscard]] Result<void> set_options(const PipelineOptions& options);
    // That it has, for another pipeline of the same scene; nullptr before occlusion is first asked for.
    [[nodiscard]] std::shared_ptr<const SceneOccluders> occluders() const;
    // For DrawList; nullptr before PipelineOptions::picture is first set.
    [[nodiscard]] std::shared_ptr<const SceneClusters> clusters() const;

    // Follows scene.moved_instances(), then answers for the camera. Fills all of FrameStatistics but index, update_us
    // of the scene itself, triangles_clipped, gpu and draw_us. Errors: an invalid camera.
    [[nodiscard]] Result<FrameStatistics> run(const Camera& camera);

    // By instance, as of the last run(); `straddling` for all that is not hidden where culling is off.
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const;
    [[nodiscard]] const Bounds& bounds() const;
    [[nodiscard]] std::span<const scene::InstanceId> movers() const;
    // Objects of kSeenLayer have their instance's number, as index and as user data, and its entry of bounds().boxes().
    [[nodiscard]] const World& world() const;
    // The answer with occlusion of the last run(), where PipelineOptions ask for it: what hides what, the depth buffer.
    // Objects without a bound of their own hide others; their user data are nodes.
    [[nodiscard]] const ViewResult& not_hidden() const;

  private:
    struct State;
    explicit Pipeline(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace crofton::pipeline
