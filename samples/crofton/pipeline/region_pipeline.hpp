// SPDX-License-Identifier: MIT
// One frame of a flight over regions: as Pipeline's, of a world that is larger than what is loaded of it.
#pragma once
#include <crofton/crofton.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drawables.hpp"
#include "frame_statistics.hpp"
#include "region_stream.hpp"
#include "scene_clusters.hpp"

namespace crofton::pipeline {

struct RegionPipelineOptions {
    RegionStreamOptions stream;
    bool count_triangles = true;
    // As PipelineOptions; at most one of both.
    std::optional<OcclusionOptions> occlusion = {};
    std::optional<depth::PictureView> picture = {};
    // In their place: leaves out what the regions' visible sets prove hidden. Needs `stream.sets`.
    bool by_sets = false;
};

// Instances are numbered through all regions in the order of the index, whether a region is attached or not: as in a
// file of the whole scene but for their order. Meshes are numbered in the order in which they came; those
// that no region in memory has are freed, and later ones get their numbers.
class RegionPipeline {
  public:
    // Errors: as RegionStream::open; more than 2^32 - 2 objects.
    [[nodiscard]] static Result<RegionPipeline> open(const std::string& folder, const RegionPipelineOptions& options);
    ~RegionPipeline();
    RegionPipeline(RegionPipeline&&) noexcept;
    RegionPipeline& operator=(RegionPipeline&&) noexcept;

    // Moves the far plane nearer so that the view needs no region beyond the stream's distance, then attaches,
    // detaches, and answers for that camera. Fills what Pipeline::run fills, and FrameStatistics::regions. Errors: an
    // invalid camera; as RegionStream::follow; with a picture, a region that was baked without clusters (unsupported).
    [[nodiscard]] Result<FrameStatistics> run(const Camera& camera, Executor& executor);

    // Counts how often new meshes came: a DrawList is then made anew.
    [[nodiscard]] std::uint64_t mesh_revision() const;
    // The meshes, empty where one was freed, and the instances of attached regions.
    [[nodiscard]] std::shared_ptr<const Drawables> drawables() const;
    // By mesh, as DrawList::Looks.
    [[nodiscard]] std::span<const std::uint8_t> unlit() const;
    [[nodiscard]] std::span<const std::uint8_t> one_sided() const;
    [[nodiscard]] std::span<const std::uint8_t> flat() const;
    [[nodiscard]] std::shared_ptr<const SceneClusters> clusters() const;

    [[nodiscard]] const RegionStream& stream() const;
    // By instance, as of the last run().
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const;
    // The region of an instance, and the instance that is a region's first object.
    [[nodiscard]] std::uint32_t place_of(scene::InstanceId instance) const;
    [[nodiscard]] scene::InstanceId first_of(std::uint32_t place) const;
    // Map objects in answers of stream().world() to instances and back; null if the region is not attached.
    [[nodiscard]] scene::InstanceId instance_of(ObjectHandle object) const;
    [[nodiscard]] ObjectHandle object_of(scene::InstanceId instance) const;
    // A bit set of a region's objects that a camera may see, by the region's sets. Empty: none say it.
    [[nodiscard]] std::span<const std::uint64_t> set_of(std::uint32_t place, const Camera& camera) const;

  private:
    struct State;
    explicit RegionPipeline(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace crofton::pipeline
