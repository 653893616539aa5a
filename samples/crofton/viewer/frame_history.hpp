// SPDX-License-Identifier: MIT
// The history of frames, for plots and for export.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "json/json.hpp"
#include "occlusion.hpp"
#include "pipeline/frame_statistics.hpp"

namespace crofton::viewer {

struct HistoryEntry {
    pipeline::FrameStatistics frame;  // without ids
    double frame_us = 0.0;            // the whole frame, drawing included
    double ui_us = 0.0;               // building and recording the user interface, CPU time
    OcclusionCounts occlusion;        // of the frame's own method
    std::uint32_t scene_frame = 0;    // where the movers were: what to replay this frame with
};

class FrameHistory {
  public:
    static constexpr std::size_t kHistory = 240;

    void add(HistoryEntry entry);
    [[nodiscard]] const std::vector<HistoryEntry>& entries() const { return entries_; }

    // The last kHistory values of one quantity, oldest first, for a plot.
    [[nodiscard]] std::vector<float> history(double (*value)(const HistoryEntry&)) const;
    [[nodiscard]] double mean(double (*value)(const HistoryEntry&), std::size_t last) const;
    [[nodiscard]] double mean_of_frames(double (*value)(const pipeline::FrameStatistics&), std::size_t last) const;
    [[nodiscard]] double mean_of_occlusion(double (*value)(const OcclusionCounts&), std::size_t last) const;
    // How many of the last kHistory frames took 0–5, 5–10, … ms; the last bin holds all beyond.
    [[nodiscard]] std::array<float, 20> frame_time_histogram() const;

    [[nodiscard]] Json json() const;  // {"frames": […], "summary": {…}}
    [[nodiscard]] std::string csv() const;
    [[nodiscard]] std::string chrome_trace() const;  // for chrome://tracing and Perfetto

  private:
    std::vector<HistoryEntry> entries_;
};

}  // namespace crofton::viewer
