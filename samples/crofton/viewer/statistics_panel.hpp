// SPDX-License-Identifier: MIT
// Costs and results of frames, as numbers and plots.
#pragma once
#include "panels.hpp"

namespace crofton::viewer {

// A row of the tables: a column of `crofton frames` as a person reads it.
struct StatisticsRow {
    const char* label;
    const char* column;
    const char* hint;
};
[[nodiscard]] std::span<const StatisticsRow> main_rows();
[[nodiscard]] std::span<const StatisticsRow> more_rows();

// With blanks between thousands.
[[nodiscard]] std::string with_thousands(std::uint64_t value);

// Triangles that clipping leaves, as predicted and as the device counted them. Only where it counts exactly
// (render::Device::counts_exactly) does a difference mean a fault.
[[nodiscard]] std::string clip_counts(std::uint64_t predicted, std::uint64_t counted, bool exactly);

// The main rows: this frame and the mean of the last 60; or A and B where two methods are compared.
void statistics_panel(const PanelInput& input);
void more_statistics(const PanelInput& input);
void history_plots(const FrameHistory& frame_history);

}  // namespace crofton::viewer
