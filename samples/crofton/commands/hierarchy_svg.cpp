// SPDX-License-Identifier: MIT
#include "hierarchy_svg.hpp"

#include <array>

#include "svg_panel.hpp"

namespace crofton::cli {
namespace {

constexpr double kPanel = 320.0, kHeading = 24.0, kMargin = 14.0;
constexpr const char* kColors[] = {"#1b2a41", "#0a58ca", "#c8553d", "#2a9d8f",
                                   "#8e6bbf", "#b08900", "#777777", "#aaaaaa"};

std::array<glm::dvec2, 4> corners_of(const Rectangle& r) {
    const glm::dvec2 x = r.half_extents.x * r.axis, y = r.half_extents.y * glm::dvec2(-r.axis.y, r.axis.x);
    return {r.center - x - y, r.center + x - y, r.center + x + y, r.center - x + y};
}

void draw(const Chain& chain, const glm::dvec2& corner, std::string& svg) {
    SvgPanel panel(corner + glm::dvec2(0.5 * kPanel, kHeading + 0.5 * kPanel), kPanel - 2.0 * kMargin, svg);
    for (const ChainLevel& level : chain.levels) {
        if (level.disc) {
            panel.include_disc(level.disc->center, level.disc->radius);
            continue;
        }
        for (const glm::dvec2& p : corners_of(*level.rectangle)) panel.include(p);
    }
    panel.path(chain.object, "fill='#dfe6ee' stroke='#555' stroke-width='2'");
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
        const ChainLevel& level = chain.levels[k];
        const std::string style =
            std::string("fill='none' stroke-width='1.5' stroke='") + kColors[k % std::size(kColors)] + "'";
        if (level.disc)
            panel.disc(level.disc->center, level.disc->radius, style);
        else
            panel.path(corners_of(*level.rectangle), style);
    }
}

}  // namespace

std::string hierarchy_svg(const std::vector<Chain>& chains) {
    const std::size_t rows = (chains.size() + 2) / 3;
    std::string svg = svg_head(3.0 * kPanel, static_cast<double>(rows) * (kPanel + kHeading));
    for (std::size_t i = 0; i < chains.size(); ++i) {
        const glm::dvec2 corner(static_cast<double>(i % 3) * kPanel, static_cast<double>(i / 3) * (kPanel + kHeading));
        svg_text(svg, corner.x + kMargin, corner.y + 16.0, "", chains[i].name);
        draw(chains[i], corner, svg);
    }
    return svg + "</svg>\n";
}

}  // namespace crofton::cli
