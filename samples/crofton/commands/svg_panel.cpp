// SPDX-License-Identifier: MIT
#include "svg_panel.hpp"

#include <cstdio>

#include "assets/print.hpp"

namespace crofton::cli {

std::string svg_head(double width, double height) {
    char head[256];
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' width='%g' height='%g' font-family='sans-serif' "
                  "font-size='12'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
                  width, height);
    return head;
}

void svg_text(std::string& svg, double x, double y, const std::string& color, const std::string& text) {
    char place[64];
    std::snprintf(place, sizeof place, "<text x='%.1f' y='%.1f'", x, y);
    svg += place + (color.empty() ? std::string(">") : " fill='" + color + "'>");
    svg += markup_text(text) + "</text>\n";
}

void SvgPanel::include(const glm::dvec2& p) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
}

void SvgPanel::include_disc(const glm::dvec2& center, double radius) {
    include(center - glm::dvec2(radius));
    include(center + glm::dvec2(radius));
}

void SvgPanel::path(std::span<const glm::dvec2> points, const std::string& style) {
    svg_ += "<path " + style + " d='";
    for (std::size_t i = 0; i < points.size(); ++i) {
        char text[64];
        const glm::dvec2 p = at(points[i]);
        std::snprintf(text, sizeof text, "%c%.2f %.2f", i == 0 ? 'M' : 'L', p.x, p.y);
        svg_ += text;
    }
    svg_ += "Z'/>\n";
}

void SvgPanel::circle(const glm::dvec2& center, double pixels, const std::string& style) {
    char text[96];
    const glm::dvec2 p = at(center);
    std::snprintf(text, sizeof text, "<circle cx='%.2f' cy='%.2f' r='%.2f' ", p.x, p.y, pixels);
    svg_ += text + style + "/>\n";
}

}  // namespace crofton::cli
