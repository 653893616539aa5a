// SPDX-License-Identifier: MIT
// `crofton frames --verify`: one frame against brute force.
#pragma once
#include <crofton/scene/scene.hpp>
#include <span>

#include "bounds.hpp"
#include "frame_statistics.hpp"
#include "pipeline.hpp"

namespace crofton::pipeline {

// Adds to `verification` what differs in `frame`, which `pipeline` has just produced. Every triangle of every instance
// that is not hidden is clipped: nothing visible may be culled, triangles_passed must agree. Every bound is clipped
// (verdicts), and every pair of movers is tested. The GPU's counts are compared where they were predicted exactly
// (`gpu_counts_exactly`).
void verify_frame(const scene::Scene& scene, const Pipeline& pipeline, const PipelineOptions& options,
                  const FrameStatistics& frame, bool gpu_counts_exactly, Verification& verification);

// Adds what is wrong with `frame.occlusion`: an instance of `owners`, which own a pixel in the picture of all that is
// visible, that counts as hidden; pixels that occlusion changes; counts. Sets frame.occlusion->owners.
void verify_occlusion(const scene::Scene& scene, std::span<const scene::InstanceId> owners,
                      std::uint64_t changed_pixels, bool gpu_counts_exactly, FrameStatistics& frame,
                      Verification& verification);

}  // namespace crofton::pipeline
