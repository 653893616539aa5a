// SPDX-License-Identifier: MIT
// Cross products of differences of points of the plane, where rounding may not decide.
#pragma once
#include <crofton/geometry/expansion.hpp>
#include <glm/vec2.hpp>

namespace crofton::study {

// (b − a) × (d − c), exactly: an expansion.
[[nodiscard]] inline auto exact_cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c,
                                      const glm::dvec2& d) {
    return exact_difference(b.x, a.x) * exact_difference(d.y, c.y) -
           exact_difference(b.y, a.y) * exact_difference(d.x, c.x);
}

}  // namespace crofton::study
