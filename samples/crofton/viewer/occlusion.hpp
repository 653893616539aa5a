// SPDX-License-Identifier: MIT
// Finds the visible instances of a frame that others hide.
#pragma once
#include <crofton/crofton.hpp>
#include <crofton/scene/scene.hpp>
#include <span>
#include <vector>

#include "json/json.hpp"
#include "pipeline/frame_statistics.hpp"
#include "pipeline/object_counts.hpp"
#include "pipeline/pipeline.hpp"

namespace crofton::viewer {

struct OcclusionCounts {
    std::uint64_t hidden = 0;            // instances whose bound meets the view and is hidden
    std::uint64_t triangles_hidden = 0;  // theirs
    std::uint64_t occluders = 0;         // drawn into the depth buffer
    double us = 0.0;                     // to choose occluders, draw them and ask for all instances
};
[[nodiscard]] Json to_json(const OcclusionCounts& counts);

class Occlusion {
  public:
    // Takes what frame.occlusion leaves out of the frame's own ids and counts: what is left is what is drawn.
    void apply(const scene::Scene& scene, const pipeline::Pipeline& pipeline, pipeline::FrameStatistics& frame);

    [[nodiscard]] const OcclusionCounts& counts() const { return counts_; }
    [[nodiscard]] std::span<const scene::InstanceId> hidden() const { return hidden_; }  // taken out; ascending

  private:
    std::vector<scene::InstanceId> hidden_;
    pipeline::ObjectCounter counter_;
    OcclusionCounts counts_;
};

// Results of the last run() of a pipeline with occlusion. Nodes hide as a whole, with all their instances.

// Returns the nodes whose occluders were drawn, ascending.
[[nodiscard]] std::vector<scene::NodeId> hiding_nodes(const pipeline::Pipeline& pipeline);
// That hide an instance; ascending, empty where none does. Draws every occluder again.
[[nodiscard]] std::vector<scene::NodeId> nodes_that_hide(const pipeline::Pipeline& pipeline,
                                                         scene::InstanceId instance);

}  // namespace crofton::viewer
