// SPDX-License-Identifier: MIT
#include "instance_coloring.hpp"

#include <algorithm>
#include <array>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>

namespace crofton::viewer {
namespace {

constexpr std::uint8_t kPlain = 255;

// Depth of the leaf that holds an item: steps from the root.
unsigned depth_of(const boxtree::BoxTree& tree, boxtree::ItemId item) {
    const std::uint32_t slot = tree.structure().slot_of(item);
    if (slot == boxtree::kNone) return 0;
    unsigned depth = 1;
    for (boxtree::NodeId node = tree.structure().leaves()[slot / boxtree::kWidth].parent;
         node != boxtree::kNone && node != 0; node = tree.structure().nodes()[node].parent)
        ++depth;
    return depth;
}

constexpr std::array<const char*, 6> kDepthNames{"depth 1", "depth 2", "depth 3", "depth 4", "depth 5", "deeper"};
constexpr std::array<glm::vec3, 6> kDepthColors{{{0.60f, 0.05f, 0.05f},
                                                 {0.70f, 0.40f, 0.02f},
                                                 {0.20f, 0.50f, 0.05f},
                                                 {0.03f, 0.40f, 0.45f},
                                                 {0.10f, 0.15f, 0.70f},
                                                 {0.40f, 0.05f, 0.55f}}};

// Neighbouring regions mostly differ.
constexpr std::array<glm::vec3, 7> kRegionColors{{{0.55f, 0.10f, 0.08f},
                                                  {0.10f, 0.35f, 0.60f},
                                                  {0.55f, 0.42f, 0.06f},
                                                  {0.12f, 0.45f, 0.16f},
                                                  {0.42f, 0.12f, 0.50f},
                                                  {0.06f, 0.42f, 0.42f},
                                                  {0.60f, 0.24f, 0.36f}}};

}  // namespace

void InstanceColoring::count(const char* name, const glm::vec3& color) {
    counts_.push_back({name, color, 0});
}

void InstanceColoring::classify(const LoadedScene& loaded, const pipeline::FrameStatistics& frame, Coloring coloring,
                                scene::InstanceId selected, std::span<const scene::NodeId> hiders) {
    counts_.clear();
    if (const pipeline::RegionPipeline* const regions = loaded.regions())
        return classify_regions(*regions, frame, coloring, selected);
    const auto verdicts = loaded.pipeline().verdicts();
    tint_of_.assign(verdicts.size(), kPlain);
    switch (coloring) {
        case Coloring::lit:
        case Coloring::shape:
        case Coloring::clusters:
        case Coloring::regions:
            break;
        case Coloring::verdict:
            count("inside", palette::kInside);
            count("straddling", palette::kStraddling);
            for (const scene::InstanceId i : frame.visible_ids)
                tint_of_[i] = verdicts[i] == cull::Verdict::inside ? 0 : 1;
            break;
        case Coloring::improper: {
            count("inside", palette::kInside);
            count("straddling", palette::kStraddling);
            count("improper", palette::kImproper);
            const auto frustum = frustum_of(frame.camera);
            for (const scene::InstanceId i : frame.visible_ids) {
                tint_of_[i] = verdicts[i] == cull::Verdict::inside ? 0 : 1;
                if (tint_of_[i] == 1 && frustum &&
                    counter_.count(pipeline::SceneDrawables(loaded.scene()), *frustum, std::span(&i, 1), verdicts)
                            .improper > 0)
                    tint_of_[i] = 2;
            }
            break;
        }
        case Coloring::occlusion:
            classify_occlusion(loaded, frame);
            break;
        case Coloring::visible_set:
            classify_visible_set(loaded, frame);
            break;
        case Coloring::collision:
            count("calm", palette::kCalm);
            count("colliding", palette::kColliding);
            for (const scene::InstanceId i : frame.visible_ids) tint_of_[i] = 0;
            for (const auto& [first, second] : frame.colliding_ids)
                for (const scene::InstanceId i : {first, second})
                    if (tint_of_[i] == 0) tint_of_[i] = 1;
            break;
        case Coloring::depth:
            for (std::size_t d = 0; d < kDepthNames.size(); ++d) count(kDepthNames[d], kDepthColors[d]);
            for (const scene::InstanceId i : frame.visible_ids)
                tint_of_[i] = static_cast<std::uint8_t>(
                    std::min<std::size_t>(depth_of(loaded.pipeline().world().tree(), i), kDepthNames.size()) - 1);
            break;
    }
    for (const std::uint8_t tint : tint_of_)
        if (tint != kPlain) ++counts_[tint].instances;
    if (!hiders.empty()) {
        count("hides the selected", palette::kHidesSelected);
        counts_.back().instances =
            tint_nodes(loaded.scene(), frame.visible_ids, hiders, static_cast<std::uint8_t>(counts_.size() - 1));
    }
    tint_selected(selected);
}

void InstanceColoring::tint_selected(scene::InstanceId selected) {
    if (selected >= tint_of_.size()) return;
    count("selected", palette::kSelected);
    tint_of_[selected] = static_cast<std::uint8_t>(counts_.size() - 1);
    counts_.back().instances = 1;
}

void InstanceColoring::classify_regions(const pipeline::RegionPipeline& regions, const pipeline::FrameStatistics& frame,
                                        Coloring coloring, scene::InstanceId selected) {
    const auto verdicts = regions.verdicts();
    tint_of_.resize(verdicts.size(), kPlain);
    if (coloring == Coloring::verdict) {
        count("inside", palette::kInside);
        count("straddling", palette::kStraddling);
    }
    for (const scene::InstanceId i : frame.visible_ids) {
        tint_of_[i] = kPlain;
        if (coloring == Coloring::verdict) tint_of_[i] = verdicts[i] == cull::Verdict::inside ? 0 : 1;
        if (coloring == Coloring::regions)
            tint_of_[i] = static_cast<std::uint8_t>(regions.place_of(i) % kRegionColors.size());
        if (coloring == Coloring::verdict) ++counts_[tint_of_[i]].instances;
    }
    if (coloring == Coloring::regions)
        for (const glm::vec3& color : kRegionColors) count("", color);
    if (coloring == Coloring::visible_set) classify_sets(regions, frame);
    if (std::binary_search(frame.visible_ids.begin(), frame.visible_ids.end(), selected)) tint_selected(selected);
}

// By the sets of the object's own region, at the eye's cell.
void InstanceColoring::classify_sets(const pipeline::RegionPipeline& regions, const pipeline::FrameStatistics& frame) {
    count("not proved hidden", palette::kInside);
    count("proved hidden", palette::kHidden);
    count("in no set", palette::kCalm);
    std::uint32_t place = scene::kNone;
    std::span<const std::uint64_t> seen;  // of the region at this place: visible instances lie region by region
    for (const scene::InstanceId i : frame.visible_ids) {
        if (const std::uint32_t own = regions.place_of(i); own != place)
            place = own, seen = regions.set_of(place, frame.camera);
        tint_of_[i] = seen.empty() ? 2 : cull::is_candidate(seen, i - regions.first_of(place)) ? 0 : 1;
        ++counts_[tint_of_[i]].instances;
    }
}

std::uint64_t InstanceColoring::tint_nodes(const scene::Scene& scene, std::span<const scene::InstanceId> instances,
                                           std::span<const scene::NodeId> nodes, std::uint8_t tint) {
    std::uint64_t tinted = 0;
    for (const scene::InstanceId i : instances) {
        if (!std::binary_search(nodes.begin(), nodes.end(), scene.node_of(i))) continue;
        tint_of_[i] = tint;
        ++tinted;
    }
    return tinted;
}

void InstanceColoring::classify_occlusion(const LoadedScene& loaded, const pipeline::FrameStatistics& frame) {
    count("visible", palette::kInside);
    count("visible, hides others", palette::kHides);
    count("hidden", palette::kHidden);
    for (const scene::InstanceId i : frame.visible_ids) tint_of_[i] = 0;
    if (loaded.occlusion() == nullptr) return;
    tint_nodes(loaded.scene(), frame.visible_ids, hiding_nodes(loaded.pipeline()), 1);
    for (const scene::InstanceId i : loaded.occlusion()->hidden()) tint_of_[i] = 2;
}

// By the set of the eye's cell; what has none is grey.
void InstanceColoring::classify_visible_set(const LoadedScene& loaded, const pipeline::FrameStatistics& frame) {
    count("seen from the cell", palette::kInside);
    count("unseen, not proved hidden", palette::kUnseen);
    count("proved hidden", palette::kHidden);
    count("in no set", palette::kCalm);
    const pvs::Pvs* pvs = loaded.pvs();
    const std::uint32_t cell = pvs != nullptr ? pvs->find_cell(frame.camera.position) : pvs::kNoCell;
    for (const scene::InstanceId i : frame.visible_ids) {
        tint_of_[i] = 3;
        if (cell == pvs::kNoCell || !pvs->is_baked(i)) continue;
        const pvs::PairState state = pvs->state(cell, i);
        tint_of_[i] = state == pvs::PairState::seen ? 0 : state == pvs::PairState::unseen ? 1 : 2;
    }
}

// A transform for each colour that an instance shows. The list has the ranges of an instance side by side.
void InstanceColoring::paint_clusters(const pipeline::DrawList& list, const ClusterColoring& clusters) {
    constexpr std::uint32_t kNone = ~std::uint32_t{0};
    const auto own = list.transforms();
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const std::uint32_t instance_transform = list.ranges()[r].transform;
        if (tint_of_[list.instance_of(r)] != kPlain) continue;
        if (r == 0 || list.ranges()[r - 1].transform != instance_transform) transform_of_shade_.assign(256, kNone);
        const std::size_t piece = list.piece_of(r);
        std::uint32_t& transform = transform_of_shade_[clusters.shade_of_piece(piece)];
        if (transform == kNone) {
            transform = static_cast<std::uint32_t>(transforms_.size());
            transforms_.push_back(own[instance_transform]);
            render::set_tint(transforms_.back(), clusters.color_of_piece(piece));
            transforms_.back().unlit = 0.0f;
        }
        ranges_[r].transform = transform;
    }
}

void InstanceColoring::paint(const pipeline::DrawList& list, bool wireframe, const ClusterColoring* clusters) {
    const auto ranges = list.ranges();
    const auto transforms = list.transforms();
    ranges_.assign(ranges.begin(), ranges.end());
    transforms_.assign(transforms.begin(), transforms.end());
    // Tints are lit, to show shapes.
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const std::uint8_t tint = tint_of_[list.instance_of(r)];
        if (tint == kPlain) continue;
        render::set_tint(transforms_[ranges_[r].transform], counts_[tint].color);
        transforms_[ranges_[r].transform].unlit = 0.0f;
    }
    if (clusters != nullptr) paint_clusters(list, *clusters);
    wires_.clear();
    if (!wireframe) return;
    const auto first_wire = static_cast<std::uint32_t>(transforms_.size());
    for (const render::DrawTransform& transform : transforms) {
        render::DrawTransform wire = transform;
        render::set_tint(wire, glm::vec3(0.004f));
        wire.unlit = 1.0f;
        transforms_.push_back(wire);
    }
    for (const render::DrawRange& range : ranges)
        wires_.push_back({range.first_index, range.index_count, first_wire + range.transform});
}

}  // namespace crofton::viewer
