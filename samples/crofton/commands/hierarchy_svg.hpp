// SPDX-License-Identifier: MIT
// Chains of bounds as a picture.
#pragma once
#include <crofton/geometry/shapes.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

namespace crofton::cli {

struct ChainLevel {
    std::optional<Disc> disc;
    std::optional<Rectangle> rectangle;  // one of both
    double measure = 0.0;                // of the lines that hit this bound and all before it
    double gap = 0.0;                    // proved: no bound of its kind has less than measure − gap
};

struct Chain {
    std::string name;
    std::vector<glm::dvec2> object;
    double own = 0.0;  // the measure of the lines that hit the object
    std::vector<ChainLevel> levels;
};

// A panel a chain, three in a row, and a line that says which level has which colour.
[[nodiscard]] std::string hierarchy_svg(const std::vector<Chain>& chains);

}  // namespace crofton::cli
