// SPDX-License-Identifier: MIT
// Finds points that are certainly inside the hull of a few others, and so are no support points.
#pragma once
#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::fit {

// Half-spaces by normal.x, normal.y, normal.z, offset: inside where dot(normal, p) < offset.
struct InteriorTest {
    static constexpr std::size_t kMost = 64;
    std::array<std::array<double, 4>, kMost> planes;
    std::size_t count = 0;  // 0: no point is known to be inside
};

// Half-spaces whose common points lie in the hull of `points`, each with a sphere of 9e-7 around it. Heights may be
// sums of three products in double, of coordinates of at most 1 in magnitude. `points` are as large at most. There are
// no half-spaces where they are too flat or too many.
[[nodiscard]] InteriorTest interior_test(std::span<const glm::dvec3> points);

}  // namespace crofton::fit
