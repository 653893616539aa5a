// SPDX-License-Identifier: MIT
// `crofton frames --report FILE.html`: one page that needs nothing else, with pictures, charts and the numbers.
#pragma once
#include <crofton/render/rasterizer.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "frames_output.hpp"
#include "pipeline/frame_statistics.hpp"

namespace crofton::cli {

// A line of a chart.
struct Series {
    std::string name;
    std::vector<double> values;  // one a frame
};

// At most five series over the frame's number, from zero up. `id` names the chart in the page.
[[nodiscard]] std::string svg_chart(const std::string& id, const std::string& title, const std::string& unit,
                                    const std::vector<Series>& series);

// Grouped by thousands where whole, else three significant digits.
[[nodiscard]] std::string readable(double value);

struct ReportPicture {
    std::uint32_t frame = 0;
    render::Image image;
};

struct ReportContents {
    SceneFacts scene;
    std::vector<std::pair<std::string, std::string>> settings;  // as the user chose them, in this order
    std::span<const pipeline::FrameStatistics> frames;          // at least one
    std::optional<pipeline::Verification> verification;
    std::vector<ReportPicture> pictures;  // any number, also none
};

// Self-contained HTML with inline SVG charts and PNG pictures: no script is needed to read it and nothing is loaded.
// Fits phones and desktops, light and dark. The caller writes it to a file.
[[nodiscard]] std::string html_report(const ReportContents& contents);

}  // namespace crofton::cli
