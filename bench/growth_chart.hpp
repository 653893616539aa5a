// SPDX-License-Identifier: MIT
// Costs over sizes as an SVG picture, both scales logarithmic.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace crofton::bench {

struct GrowthLine {
    std::string name;
    const char* color;
    std::vector<std::pair<double, double>> points;  // (size, cost), both positive
};

// Lines are named at their ends, and lines without points left out; `cost` and `size` name the axes.
[[nodiscard]] std::string growth_chart(const std::string& cost, const std::string& size,
                                       const std::vector<GrowthLine>& lines);

// False if the file cannot be written.
[[nodiscard]] bool write_growth_chart(const char* path, const std::string& svg);

}  // namespace crofton::bench
