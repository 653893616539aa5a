// SPDX-License-Identifier: MIT
// What `crofton frames` leaves behind: JSON, CSV, pictures, and a table for the person who waits.
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
[[nodiscard]] Result<ImageSize> image_size_from(const std::string& text);  // "1280x720"

struct SceneFacts {
    std::string name;
    std::uint64_t nodes = 0, instances = 0, triangles = 0;
};

// Before the work: no two outputs go to the same place, and the pictures' folder is made. `report`: the page's file.
[[nodiscard]] Result<void> check_writable(const FramesOutput& output, const std::string& report);

// FOLDER/frame_0000.png
[[nodiscard]] Result<void> write_picture(const std::string& folder, std::uint32_t index, const render::Image& image);

// JSON and CSV where wanted, and the table to stdout unless one of them goes there.
[[nodiscard]] Result<void> write_results(const FramesOutput& output, const SceneFacts& scene,
                                         std::span<const pipeline::FrameStatistics> frames,
                                         const std::optional<pipeline::Verification>& verification);

}  // namespace crofton::cli
