// SPDX-License-Identifier: MIT
// Output of `crofton frames`: JSON, CSV, pictures, and a table on the terminal.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/render/rasterizer.hpp>
#include <optional>
#include <span>
#include <string>

#include "pipeline/frame_statistics.hpp"

namespace crofton::cli {

struct FramesOutput {
    std::string json, csv, png;  // empty: not wanted; "-" is stdout
    bool ids = false;
};

struct ImageSize {
    std::uint32_t width = 0, height = 0;
};
// "1280x720"; each within the limits. The error names the option.
[[nodiscard]] Result<ImageSize> image_size_from(const std::string& text, const char* option = "--size",
                                                std::uint32_t least = 1, std::uint32_t most = 16384);

struct SceneFacts {
    std::string name;
    std::uint64_t nodes = 0, instances = 0;
    std::optional<std::uint64_t> triangles = {};  // nothing for regions: their files are not all read
};

[[nodiscard]] Result<void> make_picture_folder(const std::string& folder);

// Pictures of an earlier run (frame_0000.png and so on, also unfinished ones) are removed from the folder, so that they
// do not pass for this one's.
[[nodiscard]] Result<void> remove_old_pictures(const std::string& folder);

// FOLDER/frame_0000.png
[[nodiscard]] Result<void> write_picture(const std::string& folder, std::uint32_t index, const render::Image& image);

// Writes to stdout frame by frame, the table or the CSV, so that an interrupted run leaves its frames.
class FramesStream {
  public:
    FramesStream(const FramesOutput& output, const SceneFacts& scene, std::size_t count);
    void add(const pipeline::FrameStatistics& frame);

  private:
    bool table_, csv_;
    std::size_t step_, added_ = 0;  // so many frames to a row of the table
    SceneFacts scene_;
};

// JSON and CSV into files where wanted; JSON, or the means below the table, to stdout.
[[nodiscard]] Result<void> write_results(const FramesOutput& output, const SceneFacts& scene,
                                         std::span<const pipeline::FrameStatistics> frames,
                                         const std::optional<pipeline::Verification>& verification);

}  // namespace crofton::cli
