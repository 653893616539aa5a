// SPDX-License-Identifier: MIT
#include "hierarchy_svg.hpp"

#include <algorithm>
#include <array>

#include "svg_panel.hpp"

namespace crofton::cli {
namespace {

constexpr double kChainPanel = 320.0, kChainHeading = 24.0, kChainMargin = 14.0;
constexpr const char* kChainColors[] = {"#1b2a41", "#0a58ca", "#c8553d", "#2a9d8f",
                                        "#8e6bbf", "#b08900", "#777777", "#aaaaaa"};

const char* color_of(std::size_t level) {
    return kChainColors[level % std::size(kChainColors)];
}

std::array<glm::dvec2, 4> outline_of(const Rectangle& r) {
    const glm::dvec2 x = r.half_extents.x * r.axis, y = r.half_extents.y * glm::dvec2(-r.axis.y, r.axis.x);
    return {r.center - x - y, r.center + x - y, r.center + x + y, r.center - x + y};
}

void draw(const Chain& chain, const glm::dvec2& corner, std::string& svg) {
    SvgPanel panel(corner + glm::dvec2(0.5 * kChainPanel, kChainHeading + 0.5 * kChainPanel),
                   kChainPanel - 2.0 * kChainMargin, svg);
    for (const ChainLevel& level : chain.levels) {
        if (level.disc) {
            panel.include_disc(level.disc->center, level.disc->radius);
            continue;
        }
        for (const glm::dvec2& p : outline_of(*level.rectangle)) panel.include(p);
    }
    panel.path(chain.object, "fill='#dfe6ee' stroke='#555' stroke-width='2'");
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
        const ChainLevel& level = chain.levels[k];
        const std::string style = std::string("fill='none' stroke-width='1.5' stroke='") + color_of(k) + "'";
        if (level.disc)
            panel.disc(level.disc->center, level.disc->radius, style);
        else
            panel.path(outline_of(*level.rectangle), style);
    }
}

// Draws a line with the meaning of each colour.
void draw_legend(std::size_t levels, double y, std::string& svg) {
    svg_text(svg, kChainMargin, y, "", "filled: the object");
    for (std::size_t k = 0; k < levels; ++k)
        svg_text(svg, kChainMargin + 130.0 + 80.0 * static_cast<double>(k), y, color_of(k),
                 "level " + std::to_string(k + 1));
}

}  // namespace

std::string hierarchy_svg(const std::vector<Chain>& chains) {
    const std::size_t rows = (chains.size() + 2) / 3;
    const double legend = static_cast<double>(rows) * (kChainPanel + kChainHeading);
    std::string svg = svg_head(3.0 * kChainPanel, legend + kChainHeading);
    for (std::size_t i = 0; i < chains.size(); ++i) {
        const glm::dvec2 corner(static_cast<double>(i % 3) * kChainPanel,
                                static_cast<double>(i / 3) * (kChainPanel + kChainHeading));
        svg_text(svg, corner.x + kChainMargin, corner.y + 16.0, "", chains[i].name);
        draw(chains[i], corner, svg);
    }
    std::size_t levels = 0;
    for (const Chain& chain : chains) levels = std::max(levels, chain.levels.size());
    draw_legend(levels, legend + 8.0, svg);
    return svg + "</svg>\n";
}

}  // namespace crofton::cli
