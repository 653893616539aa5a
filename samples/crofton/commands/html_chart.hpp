// SPDX-License-Identifier: MIT
// A line chart as inline SVG.
#pragma once
#include <string>
#include <vector>

namespace crofton::cli {

struct Series {
    std::string name;
    std::vector<double> values;  // one a frame
};

// At most five series over the frame's number, from zero up. `id` names the chart in the page.
[[nodiscard]] std::string svg_chart(const std::string& id, const std::string& title, const std::string& unit,
                                    const std::vector<Series>& series);

// Text made safe between tags and within quotes.
[[nodiscard]] std::string html_escape(const std::string& text);
// Grouped by thousands where whole, else three significant digits.
[[nodiscard]] std::string readable(double value);

}  // namespace crofton::cli
