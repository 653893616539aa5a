// SPDX-License-Identifier: MIT
// Directions of any length.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace crofton {

// The direction times the power of two that brings its largest component to [1/2, 1), so that its square neither
// overflows nor vanishes. It is finite; zero stays zero.
[[nodiscard]] inline glm::dvec3 of_moderate_length(const glm::dvec3& direction) {
    int exponent = 0;
    (void)std::frexp(std::max({std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)}), &exponent);
    return {std::ldexp(direction.x, -exponent), std::ldexp(direction.y, -exponent), std::ldexp(direction.z, -exponent)};
}

}  // namespace crofton
