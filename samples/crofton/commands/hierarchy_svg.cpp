// SPDX-License-Identifier: MIT
#include "hierarchy_svg.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

namespace crofton::cli {
namespace {

constexpr double kChainPanel = 320.0, kChainHeading = 24.0, kChainMargin = 14.0;
constexpr const char* kChainColors[] = {"#1b2a41", "#0a58ca", "#c8553d", "#2a9d8f",
                                        "#8e6bbf", "#b08900", "#777777", "#aaaaaa"};

std::array<glm::dvec2, 4> outline_of(const Rectangle& r) {
    const glm::dvec2 x = r.half_extents.x * r.axis, y = r.half_extents.y * glm::dvec2(-r.axis.y, r.axis.x);
    return {r.center - x - y, r.center + x - y, r.center + x + y, r.center - x + y};
}

class ChainPanel {
  public:
    ChainPanel(const Chain& chain, const glm::dvec2& corner, std::string& svg)
        : chain_(chain), middle_(corner + glm::dvec2(0.5 * kChainPanel, kChainHeading + 0.5 * kChainPanel)), svg_(svg) {
        for (const ChainLevel& level : chain.levels) {
            if (level.disc) {
                include(level.disc->center - glm::dvec2(level.disc->radius));
                include(level.disc->center + glm::dvec2(level.disc->radius));
            } else {
                for (const glm::dvec2& p : outline_of(*level.rectangle)) include(p);
            }
        }
        const double extent = std::max({high_.x - low_.x, high_.y - low_.y, std::numeric_limits<double>::min()});
        scale_ = (kChainPanel - 2.0 * kChainMargin) / extent;
    }

    void draw() {
        path({chain_.object.begin(), chain_.object.end()}, "fill='#dfe6ee' stroke='#555' stroke-width='2'");
        for (std::size_t k = 0; k < chain_.levels.size(); ++k) {
            const ChainLevel& level = chain_.levels[k];
            const std::string style = std::string("fill='none' stroke-width='1.5' stroke='") +
                                      kChainColors[k % std::size(kChainColors)] + "'";
            if (level.disc) {
                char text[96];
                const glm::dvec2 p = at(level.disc->center);
                std::snprintf(text, sizeof text, "<circle cx='%.2f' cy='%.2f' r='%.2f' ", p.x, p.y,
                              level.disc->radius * scale_);
                svg_ += text + style + "/>\n";
            } else {
                const auto corners = outline_of(*level.rectangle);
                path({corners.begin(), corners.end()}, style);
            }
        }
    }

  private:
    void include(const glm::dvec2& p) {
        low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
        high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
    [[nodiscard]] glm::dvec2 at(const glm::dvec2& p) const {
        const glm::dvec2 d = scale_ * (p - (low_ + 0.5 * (high_ - low_)));
        return middle_ + glm::dvec2(d.x, -d.y);
    }
    void path(const std::vector<glm::dvec2>& points, const std::string& style) {
        svg_ += "<path " + style + " d='";
        for (std::size_t i = 0; i < points.size(); ++i) {
            char text[64];
            const glm::dvec2 p = at(points[i]);
            std::snprintf(text, sizeof text, "%c%.2f %.2f", i == 0 ? 'M' : 'L', p.x, p.y);
            svg_ += text;
        }
        svg_ += "Z'/>\n";
    }

    const Chain& chain_;
    glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
    glm::dvec2 middle_;
    std::string& svg_;
    double scale_ = 1.0;
};

}  // namespace

std::string hierarchy_svg(const std::vector<Chain>& chains) {
    char head[256];
    const std::size_t rows = (chains.size() + 2) / 3;
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' width='%g' height='%g' font-family='sans-serif' "
                  "font-size='12'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
                  3.0 * kChainPanel, static_cast<double>(rows) * (kChainPanel + kChainHeading));
    std::string svg = head;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        const glm::dvec2 corner(static_cast<double>(i % 3) * kChainPanel,
                                static_cast<double>(i / 3) * (kChainPanel + kChainHeading));
        char place[64];
        std::snprintf(place, sizeof place, "<text x='%.1f' y='%.1f'>", corner.x + kChainMargin, corner.y + 16.0);
        svg += place;
        for (const char c : chains[i].name) svg += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
        svg += "</text>\n";
        ChainPanel(chains[i], corner, svg).draw();
    }
    return svg + "</svg>\n";
}

}  // namespace crofton::cli
