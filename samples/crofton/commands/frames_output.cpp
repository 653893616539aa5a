// SPDX-License-Identifier: MIT
#include "frames_output.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "json/json.hpp"
#include "pipeline/png.hpp"
#include "report.hpp"

namespace crofton::cli {
namespace {

using pipeline::FrameStatistics;

constexpr std::size_t kMaxRows = 24;

using Text = std::array<char, 512>;

template <class... Args>
std::string format(const char* pattern, Args... args) {
    Text text;
    std::snprintf(text.data(), text.size(), pattern, args...);
    return text.data();
}

std::string row_of(const FrameStatistics& f) {
    return format("%6u %9llu %8llu %10llu %9llu %10llu %10llu %10llu %6llu %9.0f %8.0f %8.0f %9.0f\n", f.index,
                  static_cast<unsigned long long>(f.visible), static_cast<unsigned long long>(f.straddling),
                  static_cast<unsigned long long>(f.improper), static_cast<unsigned long long>(f.nodes_tested),
                  static_cast<unsigned long long>(f.triangles_submitted),
                  static_cast<unsigned long long>(f.triangles_passed),
                  static_cast<unsigned long long>(f.gpu ? f.gpu->clipping_primitives : f.triangles_clipped),
                  static_cast<unsigned long long>(f.colliding_pairs), f.update_us, f.cull_us, f.collide_us, f.draw_us);
}

void print_means(const SceneFacts& scene, std::span<const FrameStatistics> frames,
                 const std::optional<pipeline::Verification>& verification) {
    const auto mean = [&](auto value) {
        double sum = 0.0;
        for (const FrameStatistics& frame : frames) sum += static_cast<double>(value(frame));
        return sum / static_cast<double>(frames.size());
    };
    std::string text = format(
        "\nmean of %zu frames: %.1f of %llu instances visible, %.1f straddling (%.1f improperly)\n", frames.size(),
        mean([](const auto& f) { return f.visible; }), static_cast<unsigned long long>(scene.instances),
        mean([](const auto& f) { return f.straddling; }), mean([](const auto& f) { return f.improper; }));
    text += format("triangles: %.0f submitted, %.0f meet the frustum; colliding pairs: %.2f\n",
                   mean([](const auto& f) { return f.triangles_submitted; }),
                   mean([](const auto& f) { return f.triangles_passed; }),
                   mean([](const auto& f) { return f.colliding_pairs; }));
    text += format(
        "collisions: %.1f pairs of boxes tested; early outs: %.1f by faces of the first, %.1f of the second, %.1f by "
        "edges; "
        "%.1f refined, %.1f contact points\n",
        mean([](const auto& f) { return f.pairs_tested; }), mean([](const auto& f) { return f.separated_by_face_a; }),
        mean([](const auto& f) { return f.separated_by_face_b; }),
        mean([](const auto& f) { return f.separated_by_edges; }), mean([](const auto& f) { return f.pairs_refined; }),
        mean([](const auto& f) { return f.contacts; }));
    text += format("microseconds: update %.0f, cull %.0f, collide %.0f, draw %.0f\n",
                   mean([](const auto& f) { return f.update_us; }), mean([](const auto& f) { return f.cull_us; }),
                   mean([](const auto& f) { return f.collide_us; }), mean([](const auto& f) { return f.draw_us; }));
    if (!frames.front().gpu) text += "nothing was drawn: counts are the CPU's alone\n";
    if (verification)
        text += format(
            "verified by brute force: %llu mismatches in %llu frames (%llu answers too close for double to check)\n",
            static_cast<unsigned long long>(verification->mismatches()),
            static_cast<unsigned long long>(verification->frames),
            static_cast<unsigned long long>(verification->unclear));
    std::fputs(text.c_str(), stdout);
}

}  // namespace

Result<ImageSize> image_size_from(const std::string& text) {
    ImageSize size;
    const char* end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    bool good = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
    if (good) {
        const auto height = std::from_chars(width.ptr + 1, end, size.height);
        good = height.ec == std::errc{} && height.ptr == end;
    }
    if (!good || size.width == 0 || size.height == 0 || size.width > 16384 || size.height > 16384)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "--size '" + text + "' is not WIDTHxHEIGHT with both in 1 to 16384");
    return size;
}

Result<void> check_writable(const FramesOutput& output, const std::string& report) {
    if (output.json == "-" && output.csv == "-")
        return fail(ErrorCode::invalid_argument, kNoItem, "--json and --csv cannot both go to stdout");
    for (const auto& [a, b] : {std::pair(output.json, output.csv), {output.json, report}, {output.csv, report}})
        if (!a.empty() && a == b)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        a + ": named for two outputs, of which one would be lost");
    if (output.png.empty()) return {};
    std::error_code error;
    std::filesystem::create_directories(output.png, error);
    if (!std::filesystem::is_directory(output.png, error))
        return fail(ErrorCode::io, kNoItem, output.png + ": cannot make this folder for the pictures");
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
    return write_file((std::filesystem::path(folder) / format("frame_%04u.png", index)).string(),
                      pipeline::encode_png(image));
}

FramesStream::FramesStream(const FramesOutput& output, const SceneFacts& scene, std::size_t count)
    : table_(output.json != "-" && output.csv != "-"),
      csv_(output.csv == "-"),
      step_(std::max<std::size_t>(1, (count + kMaxRows - 1) / kMaxRows)) {
    if (!table_) return;
    std::printf(
        "%s: %llu nodes, %llu instances, %llu triangles\n\n"
        " frame   visible straddle   improper     nodes  submitted     passed    clipped  pairs update us  cull us  "
        "hits us   draw us\n",
        scene.name.c_str(), static_cast<unsigned long long>(scene.nodes),
        static_cast<unsigned long long>(scene.instances), static_cast<unsigned long long>(scene.triangles));
}

void FramesStream::add(const FrameStatistics& frame) {
    const std::size_t number = added_++;
    if (table_ && number % step_ == 0) std::fputs(row_of(frame).c_str(), stdout);
    if (csv_) {
        const std::string lines = pipeline::to_csv({&frame, 1});
        std::fputs(lines.c_str() + (number == 0 ? 0 : lines.find('\n') + 1), stdout);
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
                           {"triangles", scene.triangles}}},
                         {"frames", Json::array()},
                         {"summary", pipeline::summary_json(frames, verification)}};
        for (const FrameStatistics& frame : frames) document["frames"].push_back(to_json(frame, output.ids));
        if (auto written = write_json(output.json, document); !written) return written;
    }
    if (!output.csv.empty() && output.csv != "-")
        if (auto written = write_file(output.csv, pipeline::to_csv(frames)); !written) return written;
    if (output.json != "-" && output.csv != "-") print_means(scene, frames, verification);
    return {};
}

}  // namespace crofton::cli
