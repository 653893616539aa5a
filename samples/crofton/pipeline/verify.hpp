// SPDX-License-Identifier: MIT
// `crofton frames --verify`: one frame against brute force.
#pragma once
#include <crofton/scene/scene.hpp>
#include <span>

#include "bounds.hpp"
#include "drawables.hpp"
#include "frame_statistics.hpp"
#include "owner_picture.hpp"
#include "pipeline.hpp"
#include "region_pipeline.hpp"

namespace crofton::pipeline {

// Adds to `verification` what differs in `frame`, which `pipeline` has just produced. Every triangle of every instance
// that is not hidden is clipped: nothing visible may be culled, triangles_passed must agree. Every bound is clipped
// (verdicts), and every pair of movers is tested. The GPU's counts are compared where they were predicted exactly
// (`gpu_counts_exactly`).
void verify_frame(const scene::Scene& scene, const Pipeline& pipeline, const PipelineOptions& options,
                  const FrameStatistics& frame, bool gpu_counts_exactly, Verification& verification);
// The same of attached regions, whose triangles and transforms are those of their files. A region that is not attached
// must not meet the frustum.
void verify_frame(const RegionPipeline& pipeline, const FrameStatistics& frame, bool gpu_counts_exactly,
                  Verification& verification);

// The owners of pixels, ascending: with all visible objects, and without hidden ones.
struct BothOwners {
    std::span<const OwnerTriangle> of_all, of_shown;
};
// Adds what is wrong with `frame.occlusion`: triangles that own a pixel in one picture and not in the other; pixels
// that occlusion changes; counts.
void verify_occlusion(const Drawables& drawables, const BothOwners& owners, std::uint64_t changed_pixels,
                      bool gpu_counts_exactly, const FrameStatistics& frame, Verification& verification);

}  // namespace crofton::pipeline
