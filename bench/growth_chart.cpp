// SPDX-License-Identifier: MIT
#include "growth_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace crofton::bench {
namespace {

constexpr double kWidth = 800.0, kHeight = 420.0, kLeft = 80.0, kRight = 290.0, kTop = 18.0, kBottom = 50.0;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

// 0.1, 1, …, 100, 1k, …, 1M, …: as short as an axis wants it.
std::string short_number(double value) {
    char text[32];
    const bool mega = value >= 1e6, kilo = value >= 1e3;
    std::snprintf(text, sizeof text, "%g%s",
                  mega   ? value / 1e6
                  : kilo ? value / 1e3
                         : value,
                  mega   ? "M"
                  : kilo ? "k"
                         : "");
    return text;
}

std::string text(double x, double y, const char* anchor, const std::string& words, const std::string& attributes = "") {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + attributes + ">" +
           words + "</text>\n";
}

std::string grid_line(double x0, double y0, double x1, double y1) {
    return "<line x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) + "\" y2=\"" + number(y1) +
           "\" stroke=\"#ddd\"/>\n";
}

// From the value to a place between two ends; whole powers of ten where `whole`.
class LogAxis {
  public:
    LogAxis(double least, double largest, bool whole, double begin, double end)
        : low_(std::log10(least)), high_(std::log10(largest)), begin_(begin), end_(end) {
        if (whole) low_ = std::floor(low_), high_ = std::ceil(high_);
        if (high_ <= low_) high_ = low_ + 1.0;
    }
    [[nodiscard]] double at(double value) const {
        return begin_ + (end_ - begin_) * (std::log10(value) - low_) / (high_ - low_);
    }
    [[nodiscard]] std::vector<double> powers() const {
        std::vector<double> result;
        for (double p = std::ceil(low_ - 1e-9); p <= high_ + 1e-9; p += 1.0) result.push_back(std::pow(10.0, p));
        return result;
    }

  private:
    double low_, high_, begin_, end_;
};

}  // namespace

std::string growth_chart(const std::string& cost, const std::string& size, const std::vector<GrowthLine>& lines) {
    double least[2] = {1e300, 1e300}, largest[2] = {0.0, 0.0};
    for (const GrowthLine& line : lines)
        for (const auto& [x, y] : line.points) {
            least[0] = std::min(least[0], x), largest[0] = std::max(largest[0], x);
            least[1] = std::min(least[1], y), largest[1] = std::max(largest[1], y);
        }
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kWidth) + " " +
                      number(kHeight) + "\" font-family=\"sans-serif\" font-size=\"13\" fill=\"#333\">\n" +
                      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    if (largest[0] == 0.0) return svg + "</svg>\n";
    const LogAxis across(least[0], largest[0], false, kLeft, kWidth - kRight);
    const LogAxis up(least[1], largest[1], true, kHeight - kBottom, kTop);
    for (const double x : across.powers()) {
        svg += grid_line(across.at(x), kTop, across.at(x), kHeight - kBottom);
        svg += text(across.at(x), kHeight - kBottom + 18.0, "middle", short_number(x));
    }
    for (const double y : up.powers()) {
        svg += grid_line(kLeft, up.at(y), kWidth - kRight, up.at(y));
        svg += text(kLeft - 8.0, up.at(y) + 4.0, "end", short_number(y));
    }
    svg += text(0.5 * (kLeft + kWidth - kRight), kHeight - 10.0, "middle", size);
    const std::string middle = number(0.5 * (kTop + kHeight - kBottom));
    svg += text(20.0, 0.5 * (kTop + kHeight - kBottom), "middle", cost, " transform=\"rotate(-90 20 " + middle + ")\"");

    std::vector<std::pair<double, const GrowthLine*>> ends;
    for (const GrowthLine& line : lines) {
        if (line.points.empty()) continue;
        std::string path;
        for (const auto& [x, y] : line.points) {
            path += number(across.at(x)) + "," + number(up.at(y)) + " ";
            svg += "<circle cx=\"" + number(across.at(x)) + "\" cy=\"" + number(up.at(y)) + "\" r=\"3\" fill=\"" +
                   line.color + "\"/>\n";
        }
        svg += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + std::string(line.color) + "\" points=\"" +
               path + "\"/>\n";
        ends.emplace_back(up.at(line.points.back().second), &line);
    }
    std::sort(ends.begin(), ends.end());
    double free_below = 0.0;  // names do not overlap
    for (const auto& [y, line] : ends) {
        const double at = std::max(y + 4.0, free_below);
        svg += text(kWidth - kRight + 10.0, at, "start", line->name, " fill=\"" + std::string(line->color) + "\"");
        free_below = at + 16.0;
    }
    return svg + "</svg>\n";
}

bool write_growth_chart(const char* path, const std::string& svg) {
    std::ofstream file(path);
    file << svg;
    return file.good();
}

}  // namespace crofton::bench
