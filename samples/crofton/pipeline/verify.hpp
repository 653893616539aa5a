// SPDX-License-Identifier: MIT
// `crofton frames --verify`: one frame against brute force.
#pragma once
#include <crofton/scene/scene.hpp>
#include <span>

#include "bounds.hpp"
#include "frame_statistics.hpp"
#include "pipeline.hpp"

namespace crofton::pipeline {

// Adds to `verification` what differs in `frame`, which `pipeline` has just produced: every triangle of every instance
// is clipped (nothing visible may be culled, triangles_passed must agree), every bound is clipped (verdicts), every
// pair of movers is tested, the GPU's counts are compared where they were predicted exactly (`gpu_counts_exactly`).
void verify_frame(const scene::Scene& scene, const Pipeline& pipeline, const PipelineOptions& options,
                  const FrameStatistics& frame, bool gpu_counts_exactly, Verification& verification);

}  // namespace crofton::pipeline
