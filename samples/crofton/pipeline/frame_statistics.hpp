// SPDX-License-Identifier: MIT
// Costs and results of a frame: the rows of `crofton frames` and of the viewer's panel.
#pragma once
#include <crofton/depth/depth_culler.hpp>
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

// What owns a pixel of the picture: the least that could be drawn, with or without occlusion.
struct Seen {
    std::uint64_t instances = 0, triangles = 0;
};

// The same frame once more, without what other objects hide.
struct OccludedFrame {
    std::uint64_t visible = 0;    // and not hidden
    std::uint64_t occluders = 0;  // drawn into the occlusion buffer
    std::uint64_t triangles_submitted = 0, triangles_passed = 0, triangles_clipped = 0;
    std::optional<render::GpuCounters> gpu;
    // Choosing and drawing the occluders, and asking; in place of cull_us. draw_us: as the frame's.
    double occlude_us = 0.0, draw_us = 0.0;
    std::vector<std::uint32_t> visible_ids;
    bool by_depth = false;                        // found by the depth of what is drawn; else by occluders
    std::vector<depth::VisibleCluster> clusters;  // by depth: the triangles to draw, of instances
};

// The shadow map of a sun, for what the camera sees by depth.
struct ShadowFrame {
    std::uint64_t casters = 0, triangles = 0;                // whose bounds meet the map, and all triangles of them
    std::uint64_t casters_listed = 0, triangles_listed = 0;  // those that change a shadow on what is seen
    double find_us = 0.0;                                    // to list them; in no other time
};

// What came and went before a frame of a world of regions.
struct StreamedFrame {
    std::uint64_t attached = 0;  // regions, in this frame
    std::uint64_t came = 0, went = 0;
    double attach_us = 0.0;        // to attach, to detach, and to update the world: a part of the frame's update_us
    double wait_us = 0.0;          // for regions that are needed and were not prepared; in no other time
    double longest_load_ms = 0.0;  // that a thread prepared a region that came
};

// All but `occlusion` is without occlusion.
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
    std::optional<Seen> seen;               // absent without drawing, and where it was not asked for
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
    std::optional<OccludedFrame> occlusion;
    std::optional<ShadowFrame> shadow;
    std::optional<StreamedFrame> regions;
};

// The result of --verify: mismatches by kind, and a line about each of the first few.
struct Verification {
    std::uint64_t frames = 0;
    std::uint64_t culled_but_visible = 0;
    std::uint64_t wrong_verdicts = 0;
    std::uint64_t wrong_pairs = 0;
    std::uint64_t wrong_counts = 0;
    std::uint64_t hidden_but_seen = 0;   // triangles that own a pixel and were culled as hidden
    std::uint64_t changed_pictures = 0;  // pictures that occlusion changes
    std::uint64_t changed_pixels = 0;    // of those pictures
    std::uint64_t unclear = 0;           // answers that double arithmetic cannot check
    std::vector<std::string> messages;

    [[nodiscard]] std::uint64_t mismatches() const {
        return culled_but_visible + wrong_verdicts + wrong_pairs + wrong_counts + hidden_but_seen + changed_pictures;
    }
};

// The numbers of a frame under the names that CSV and means give them, in that order; GPU counts begin with "gpu_".
// Where a frame has no value, `value` is 0, and CSV leaves the place empty.
struct StatisticsColumn {
    const char* name;
    double (*value)(const FrameStatistics&);
    bool (*has_value)(const FrameStatistics&);
};
[[nodiscard]] std::span<const StatisticsColumn> statistics_columns();
// Those of FrameStatistics::occlusion; their names begin with "occlusion_", those of the GPU with "occlusion_gpu_".
[[nodiscard]] std::span<const StatisticsColumn> occlusion_columns();
// Those of both that at least one of the frames has a value for.
[[nodiscard]] std::vector<StatisticsColumn> columns_of(std::span<const FrameStatistics> frames);

// How many triangles meet the frustum for each that is seen; 0 where that was not counted, or nothing is seen.
[[nodiscard]] double passed_per_seen(std::uint64_t passed, const std::optional<Seen>& seen);

// Over the frames that say what is seen; nothing where none does. `passed`: triangles that meet the frustum, without
// and with occlusion.
struct MeanSeen {
    double instances = 0.0, triangles = 0.0, passed = 0.0, passed_with_occlusion = 0.0;
    [[nodiscard]] double passed_per_seen() const { return triangles > 0.0 ? passed / triangles : 0.0; }
    [[nodiscard]] double passed_per_seen_with_occlusion() const {
        return triangles > 0.0 ? passed_with_occlusion / triangles : 0.0;
    }
};
[[nodiscard]] std::optional<MeanSeen> mean_seen(std::span<const FrameStatistics> frames);

// What streaming costs, over frames of a world of regions; nothing where it is none. Milliseconds are those to update
// and to cull.
struct Hitches {
    std::uint64_t came = 0, went = 0, most_attached = 0;
    double median_ms = 0.0, worst_ms = 0.0, wait_ms = 0.0, longest_load_ms = 0.0;
    std::uint32_t worst_frame = 0;
};
[[nodiscard]] std::optional<Hitches> hitches(std::span<const FrameStatistics> frames);

[[nodiscard]] Json to_json(const FrameStatistics& frame, bool with_ids);
[[nodiscard]] Json summary_json(std::span<const FrameStatistics> frames,
                                const std::optional<Verification>& verification);
[[nodiscard]] std::string to_csv(std::span<const FrameStatistics> frames);

}  // namespace crofton::pipeline
