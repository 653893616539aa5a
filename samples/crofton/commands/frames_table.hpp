// SPDX-License-Identifier: MIT
// The table that `crofton frames` shows: a row a frame, and means below. With occlusion, two columns of each number.
#pragma once
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frames_output.hpp"
#include "pipeline/frame_statistics.hpp"

namespace crofton::cli {

[[nodiscard]] std::string table_header(const SceneFacts& scene, bool occlusion);
[[nodiscard]] std::string table_row(const pipeline::FrameStatistics& frame);
// Requires at least one frame.
[[nodiscard]] std::string table_means(const SceneFacts& scene, std::span<const pipeline::FrameStatistics> frames,
                                      const std::optional<pipeline::Verification>& verification);

// Returns the milliseconds of a frame: updating, finding what to draw, colliding, drawing.
[[nodiscard]] double frame_ms(const pipeline::FrameStatistics& frame);
[[nodiscard]] double frame_ms_with_occlusion(const pipeline::FrameStatistics& frame);

template <class Value>
[[nodiscard]] double mean_of(std::span<const pipeline::FrameStatistics> frames, Value value) {
    double sum = 0.0;
    for (const pipeline::FrameStatistics& frame : frames) sum += static_cast<double>(value(frame));
    return frames.empty() ? 0.0 : sum / static_cast<double>(frames.size());
}

// The value that a share of the frames stays below.
template <class Value>
[[nodiscard]] double quantile_of(std::span<const pipeline::FrameStatistics> frames, double share, Value value) {
    std::vector<double> values;
    for (const pipeline::FrameStatistics& frame : frames) values.push_back(static_cast<double>(value(frame)));
    if (values.empty()) return 0.0;
    const auto below = static_cast<std::size_t>(share * static_cast<double>(values.size()));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(below, values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// Times are told by medians: a frame that the system interrupts does not count.
template <class Value>
[[nodiscard]] double median_of(std::span<const pipeline::FrameStatistics> frames, Value value) {
    return quantile_of(frames, 0.5, value);
}

}  // namespace crofton::cli
