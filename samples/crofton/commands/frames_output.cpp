// SPDX-License-Identifier: MIT
#include "frames_output.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "assets/print.hpp"
#include "frames_table.hpp"
#include "json/json.hpp"
#include "pipeline/png.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using pipeline::FrameStatistics;

constexpr std::size_t kMaxRows = 24;

std::string picture_name(std::uint32_t index) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "frame_%04u.png", index);
    return text.data();
}

}  // namespace

Result<ImageSize> image_size_from(const std::string& text, const char* option, std::uint32_t least,
                                  std::uint32_t most) {
    ImageSize size;
    const char* end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    bool good = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
    if (good) {
        const auto height = std::from_chars(width.ptr + 1, end, size.height);
        good = height.ec == std::errc{} && height.ptr == end;
    }
    const auto fits = [&](std::uint32_t pixels) { return pixels >= least && pixels <= most; };
    if (!good || !fits(size.width) || !fits(size.height))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    std::string(option) + " '" + text + "' is not WIDTHxHEIGHT with both in " + std::to_string(least) +
                        " to " + std::to_string(most));
    return size;
}

Result<void> make_picture_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder, error))
        return fail(ErrorCode::io, kNoItem, folder + ": cannot make this folder for the pictures");
    return {};
}

Result<void> remove_old_pictures(const std::string& folder) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        const std::size_t digits = name.rfind("frame_", 0) == 0 ? name.find_first_not_of("0123456789", 6) : 0;
        if (digits < 10 || digits == name.npos) continue;
        const std::string rest = name.substr(digits);
        if (rest == ".png" || rest == ".png.partial") std::filesystem::remove(entry.path(), error);
        if (error) break;
    }
    if (error) return fail(ErrorCode::io, kNoItem, folder + ": cannot remove old pictures: " + error.message());
    return {};
}

Result<void> write_picture(const std::string& folder, std::uint32_t index, const render::Image& image) {
    return write_file((std::filesystem::path(folder) / picture_name(index)).string(), pipeline::encode_png(image));
}

FramesStream::FramesStream(const FramesOutput& output, const SceneFacts& scene, std::size_t count)
    : table_(output.json != "-" && output.csv != "-"),
      csv_(output.csv == "-"),
      step_(std::max<std::size_t>(1, (count + kMaxRows - 1) / kMaxRows)),
      scene_(scene) {}

void FramesStream::add(const FrameStatistics& frame) {
    const std::size_t number = added_++;
    if (table_ && number == 0) print_text_to(stdout, table_header(scene_, frame.occlusion.has_value()));
    if (table_ && number % step_ == 0) print_text_to(stdout, table_row(frame));
    if (csv_) {
        const std::string lines = pipeline::to_csv({&frame, 1});
        print_text_to(stdout, std::string_view(lines).substr(number == 0 ? 0 : lines.find('\n') + 1));
    }
    if (table_ || csv_) std::fflush(stdout);
}

Result<void> write_results(const FramesOutput& output, const SceneFacts& scene, std::span<const FrameStatistics> frames,
                           const std::optional<pipeline::Verification>& verification) {
    if (!output.json.empty()) {
        Json document = {{"scene",
                          {{"name", scene.name},
                           {"nodes", scene.nodes},
                           {"instances", scene.instances},
                           {"triangles", scene.triangles ? Json(*scene.triangles) : Json(nullptr)}}},
                         {"frames", Json::array()},
                         {"summary", pipeline::summary_json(frames, verification)}};
        for (const FrameStatistics& frame : frames) document["frames"].push_back(to_json(frame, output.ids));
        if (auto written = write_json(output.json, document); !written) return written;
    }
    if (!output.csv.empty() && output.csv != "-")
        if (auto written = write_file(output.csv, pipeline::to_csv(frames)); !written) return written;
    if (output.json != "-" && output.csv != "-") print_text_to(stdout, table_means(scene, frames, verification));
    return {};
}

}  // namespace crofton::cli
