// SPDX-License-Identifier: MIT
// A square of an SVG picture in which figures of the plane are drawn to one scale.
#pragma once
#include <algorithm>
#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <string>

namespace crofton::cli {

[[nodiscard]] std::string svg_head(double width, double height);
// `color` may be empty: black.
void svg_text(std::string& svg, double x, double y, const std::string& color, const std::string& text);

// First include() all that is to fit, then draw. y goes up.
class SvgPanel {
  public:
    SvgPanel(const glm::dvec2& middle, double side, std::string& svg) : middle_(middle), side_(side), svg_(svg) {}

    void include(const glm::dvec2& p);
    void include_disc(const glm::dvec2& center, double radius);
    void path(std::span<const glm::dvec2> points, const std::string& style);
    void disc(const glm::dvec2& center, double radius, const std::string& style) {
        circle(center, radius * scale(), style);
    }
    void dot(const glm::dvec2& center, const std::string& style) { circle(center, 3.0, style); }

  private:
    void circle(const glm::dvec2& center, double pixels, const std::string& style);
    [[nodiscard]] double scale() const {
        return side_ / std::max({high_.x - low_.x, high_.y - low_.y, std::numeric_limits<double>::min()});
    }
    [[nodiscard]] glm::dvec2 at(const glm::dvec2& p) const {
        const glm::dvec2 d = scale() * (p - (low_ + 0.5 * (high_ - low_)));
        return middle_ + glm::dvec2(d.x, -d.y);
    }

    glm::dvec2 middle_;
    double side_;
    std::string& svg_;
    glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
};

}  // namespace crofton::cli
