// SPDX-License-Identifier: MIT
#include "fit_planar_svg.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace crofton::cli {
namespace {

constexpr double kPlanarPanel = 300.0, kPlanarHeading = 22.0, kPlanarMargin = 14.0;
constexpr const char* kPlanarColors[] = {"#0a58ca", "#c8553d"};  // by perimeter, by area

class PlanarPanel {
  public:
    PlanarPanel(const PlanarFit& fit, std::size_t first, std::size_t count, const glm::dvec2& corner, std::string& svg)
        : fit_(fit), first_(first), count_(count), svg_(svg) {
        for (const glm::dvec2& p : fit.hull) include(p);
        for (std::size_t s = first; s < first + count; ++s) {
            for (const glm::dvec2& p : fit.shapes[s].outline) include(p);
            if (fit.shapes[s].outline.empty())
                for (const double sign : {-1.0, 1.0})
                    include(fit.shapes[s].disc.center + glm::dvec2(sign * fit.shapes[s].disc.radius));
        }
        const double extent = std::max({high_.x - low_.x, high_.y - low_.y, std::numeric_limits<double>::min()});
        scale_ = (kPlanarPanel - 2.0 * kPlanarMargin) / extent;
        middle_ = corner + 0.5 * kPlanarPanel;
    }

    void draw() {
        path(fit_.ring, "fill='#dfe6ee' stroke='none'");
        path(fit_.hull, "fill='none' stroke='#555' stroke-width='1' stroke-dasharray='3 2'");
        for (std::size_t s = first_; s < first_ + count_; ++s) {
            const PlanarShape& shape = fit_.shapes[s];
            const char* color = kPlanarColors[count_ == 1 ? 0 : s - first_];
            const std::string style = std::string("fill='none' stroke-width='1.5' stroke='") + color + "'";
            if (shape.outline.empty())
                circle(shape.disc.center, shape.disc.radius * scale_, style);
            else
                path(shape.outline, style);
            for (const glm::dvec2& p : shape.contacts) circle(p, 3.0, std::string("fill='") + color + "'");
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
    void circle(const glm::dvec2& center, double radius, const std::string& style) {
        char text[96];
        const glm::dvec2 p = at(center);
        std::snprintf(text, sizeof text, "<circle cx='%.2f' cy='%.2f' r='%.2f' ", p.x, p.y, radius);
        svg_ += text + style + "/>\n";
    }

    const PlanarFit& fit_;
    std::size_t first_, count_;
    std::string& svg_;
    glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()},
        middle_{0.0};
    double scale_ = 1.0;
};

void text_at(std::string& svg, double x, double y, const char* color, const std::string& text) {
    char head[96];
    std::snprintf(head, sizeof head, "<text x='%.1f' y='%.1f' fill='%s'>", x, y, color);
    svg += head;
    for (const char c : text) svg += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    svg += "</text>\n";
}

}  // namespace

std::string planar_fits_svg(const std::vector<PlanarFit>& fits, std::size_t most) {
    std::vector<const PlanarFit*> shown;
    for (const PlanarFit& fit : fits) shown.push_back(&fit);
    std::stable_sort(shown.begin(), shown.end(),
                     [](const PlanarFit* a, const PlanarFit* b) { return a->hull.size() > b->hull.size(); });
    shown.resize(std::min(most, shown.size()));
    char head[256];
    std::snprintf(head, sizeof head,
                  "<svg xmlns='http://www.w3.org/2000/svg' width='%g' height='%g' font-family='sans-serif' "
                  "font-size='12'>\n<rect width='100%%' height='100%%' fill='white'/>\n",
                  3.0 * kPlanarPanel,
                  static_cast<double>(shown.size()) * (kPlanarPanel + kPlanarHeading) + kPlanarHeading);
    std::string svg = head;
    text_at(svg, kPlanarMargin, 15.0, kPlanarColors[0], "least perimeter; least disc");
    text_at(svg, kPlanarMargin + 200.0, 15.0, kPlanarColors[1], "least area");
    text_at(svg, kPlanarMargin + 320.0, 15.0, "#555", "hull dashed; dots: where a best bound touches");
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double top = kPlanarHeading + static_cast<double>(i) * (kPlanarPanel + kPlanarHeading);
        text_at(svg, kPlanarMargin, top + 15.0, "#000", shown[i]->name);
        constexpr std::size_t first[] = {0, 2, 3}, count[] = {2, 1, 2};
        for (std::size_t k = 0; k < 3; ++k)
            PlanarPanel(*shown[i], first[k], count[k], {static_cast<double>(k) * kPlanarPanel, top + kPlanarHeading},
                        svg)
                .draw();
    }
    return svg + "</svg>\n";
}

}  // namespace crofton::cli
