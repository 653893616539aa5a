// SPDX-License-Identifier: MIT
// What one frame cost and found; the rows of `crofton frames` and of the viewer's panel.
#pragma once
#include <crofton/geometry/camera.hpp>
#include <crofton/render/rasterizer.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "json/json.hpp"

namespace crofton::pipeline {

struct FrameStatistics {
    std::uint32_t index = 0;
    Camera camera;
    std::uint64_t instances = 0;   // alive
    std::uint64_t visible = 0;     // inside + straddling
    std::uint64_t inside = 0;      // the bound lies in the frustum
    std::uint64_t straddling = 0;  // the bound meets the frustum's boundary
    std::uint64_t improper = 0;    // the bound straddles, the object itself does not
    std::uint64_t nodes_tested = 0;
    std::uint64_t triangles_submitted = 0;  // of the visible instances
    std::uint64_t triangles_passed = 0;     // that meet the frustum
    std::uint64_t triangles_clipped = 0;    // predicted Σ (vertices of the clipped polygon − 2)
    std::optional<render::GpuCounters>
        gpu;  // absent without drawing; docs/notes/render.md: what each counts on lavapipe
    std::uint64_t colliding_pairs = 0;
    // Pairs whose axis-aligned bounds meet, and what told their boxes apart: early outs, by group of axes. Of the last
    // frame in which anything moved, those with one that moved; where many moved, all: the first then equals the sum of
    // the next three and colliding_pairs.
    std::uint64_t pairs_tested = 0;
    std::uint64_t separated_by_face_a = 0, separated_by_face_b = 0, separated_by_edges = 0;
    std::uint64_t pairs_refined = 0;  // of all: decided in double or exactly, where float could not
    std::uint64_t contacts = 0;       // points of the contact manifolds of the colliding pairs
    double update_us = 0.0, cull_us = 0.0, collide_us = 0.0, draw_us = 0.0;
    std::vector<std::uint32_t> visible_ids;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> colliding_ids;
};

// What --verify found: mismatches by kind, with a line on each of the first few.
struct Verification {
    std::uint64_t frames = 0;
    std::uint64_t culled_but_visible = 0;
    std::uint64_t wrong_verdicts = 0;
    std::uint64_t wrong_pairs = 0;
    std::uint64_t wrong_counts = 0;
    std::uint64_t unclear = 0;  // answers that double arithmetic cannot check
    std::vector<std::string> messages;

    [[nodiscard]] std::uint64_t mismatches() const {
        return culled_but_visible + wrong_verdicts + wrong_pairs + wrong_counts;
    }
};

// The numbers of a frame under the names that CSV and means give them, in that order; GPU counts begin with "gpu_", and
// are 0 where nothing was drawn.
struct StatisticsColumn {
    const char* name;
    double (*value)(const FrameStatistics&);
};
[[nodiscard]] std::span<const StatisticsColumn> statistics_columns();

[[nodiscard]] Json to_json(const FrameStatistics& frame, bool with_ids);
[[nodiscard]] Json summary_json(std::span<const FrameStatistics> frames,
                                const std::optional<Verification>& verification);
[[nodiscard]] std::string to_csv(std::span<const FrameStatistics> frames);

}  // namespace crofton::pipeline
