// SPDX-License-Identifier: MIT
#include "occlusion.hpp"

#include <algorithm>
#include <iterator>

namespace crofton::viewer {
namespace {

// Ascending, each once.
std::vector<scene::NodeId> nodes_of(std::span<const OccluderRef> occluders) {
    std::vector<scene::NodeId> nodes;
    for (const OccluderRef& occluder : occluders) nodes.push_back(static_cast<scene::NodeId>(occluder.user));
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

}  // namespace

Json to_json(const OcclusionCounts& counts) {
    return {{"hidden", counts.hidden},
            {"triangles_hidden", counts.triangles_hidden},
            {"occluders", counts.occluders},
            {"us", counts.us}};
}

void Occlusion::apply(const scene::Scene& scene, const pipeline::Pipeline& pipeline, pipeline::FrameStatistics& frame) {
    counts_ = {};
    hidden_.clear();
    if (!frame.occlusion) return;
    pipeline::OccludedFrame& left = *frame.occlusion;
    std::set_difference(frame.visible_ids.begin(), frame.visible_ids.end(), left.visible_ids.begin(),
                        left.visible_ids.end(), std::back_inserter(hidden_));
    counts_ = {hidden_.size(), frame.triangles_submitted - left.triangles_submitted, left.occluders, left.occlude_us};
    const auto verdicts = pipeline.verdicts();
    for (const scene::InstanceId i : hidden_) frame.inside -= verdicts[i] == cull::Verdict::inside ? 1u : 0u;
    frame.visible = left.visible;
    frame.straddling = frame.visible - frame.inside;
    frame.triangles_submitted = left.triangles_submitted;
    frame.triangles_passed = left.triangles_passed;
    if (const auto frustum = frustum_of(frame.camera))
        frame.improper -= counter_.count(pipeline::SceneDrawables(scene), *frustum, hidden_, verdicts).improper;
    frame.visible_ids = std::move(left.visible_ids);
    frame.occlusion.reset();
}

std::vector<scene::NodeId> hiding_nodes(const pipeline::Pipeline& pipeline) {
    Vector<OccluderRef> occluders;
    (void)pipeline.world().drawn_occluders(pipeline.not_hidden(), occluders);
    return nodes_of(occluders);
}

std::vector<scene::NodeId> nodes_that_hide(const pipeline::Pipeline& pipeline, scene::InstanceId instance) {
    Vector<OccluderRef> occluders;
    const ViewResult& seen = pipeline.not_hidden();
    if (!pipeline.world().hidden_by(seen.ref(instance).object, seen, occluders)) return {};
    return nodes_of(occluders);
}

}  // namespace crofton::viewer
