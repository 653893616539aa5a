// SPDX-License-Identifier: MIT
#include "fit_planar_svg.hpp"

#include <algorithm>
#include <span>

#include "svg_panel.hpp"

namespace crofton::cli {
namespace {

constexpr double kPlanarPanel = 300.0, kPlanarHeading = 22.0, kPlanarMargin = 14.0;
constexpr const char* kPlanarColors[] = {"#0a58ca", "#c8553d"};  // by perimeter, by area

void draw(const PlanarFit& fit, std::size_t first, std::size_t count, const glm::dvec2& corner, std::string& svg) {
    const std::span shapes = std::span(fit.shapes).subspan(first, count);
    SvgPanel panel(corner + 0.5 * kPlanarPanel, kPlanarPanel - 2.0 * kPlanarMargin, svg);
    for (const glm::dvec2& p : fit.hull) panel.include(p);
    for (const PlanarShape& shape : shapes) {
        for (const glm::dvec2& p : shape.outline) panel.include(p);
        if (shape.outline.empty()) panel.include_disc(shape.disc.center, shape.disc.radius);
    }
    panel.path(fit.ring, "fill='#dfe6ee' stroke='none'");
    panel.path(fit.hull, "fill='none' stroke='#555' stroke-width='1' stroke-dasharray='3 2'");
    for (std::size_t s = 0; s < count; ++s) {
        const std::string color = kPlanarColors[s];
        const std::string style = "fill='none' stroke-width='1.5' stroke='" + color + "'";
        if (shapes[s].outline.empty())
            panel.disc(shapes[s].disc.center, shapes[s].disc.radius, style);
        else
            panel.path(shapes[s].outline, style);
        for (const glm::dvec2& p : shapes[s].contacts) panel.dot(p, "fill='" + color + "'");
    }
}

}  // namespace

std::string planar_fits_svg(const std::vector<PlanarFit>& fits, std::size_t most) {
    std::vector<const PlanarFit*> shown;
    for (const PlanarFit& fit : fits) shown.push_back(&fit);
    std::stable_sort(shown.begin(), shown.end(),
                     [](const PlanarFit* a, const PlanarFit* b) { return a->hull.size() > b->hull.size(); });
    shown.resize(std::min(most, shown.size()));
    std::string svg = svg_head(3.0 * kPlanarPanel,
                               static_cast<double>(shown.size()) * (kPlanarPanel + kPlanarHeading) + kPlanarHeading);
    svg_text(svg, kPlanarMargin, 15.0, kPlanarColors[0], "least perimeter; least disc");
    svg_text(svg, kPlanarMargin + 200.0, 15.0, kPlanarColors[1], "least area");
    svg_text(svg, kPlanarMargin + 320.0, 15.0, "#555", "hull dashed; dots: where a best bound touches");
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double top = kPlanarHeading + static_cast<double>(i) * (kPlanarPanel + kPlanarHeading);
        svg_text(svg, kPlanarMargin, top + 15.0, "#000", shown[i]->name);
        constexpr std::size_t first[] = {0, 2, 3}, count[] = {2, 1, 2};
        for (std::size_t k = 0; k < 3; ++k)
            draw(*shown[i], first[k], count[k], {static_cast<double>(k) * kPlanarPanel, top + kPlanarHeading}, svg);
    }
    return svg + "</svg>\n";
}

}  // namespace crofton::cli
