// Signs of determinants, exactly: a filter with Shewchuk's proven bounds first, expansions where it cannot tell.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// Inputs must be finite; exact while |coordinates| lie in [1e-70, 1e70] or are 0 (degree-4 products stay within
// double).

// > 0 if a, b, c turn counter-clockwise, < 0 if clockwise, 0 if collinear.
[[nodiscard]] int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

// > 0 if d lies inside the circle through the counter-clockwise a, b, c, < 0 outside, 0 on it.
[[nodiscard]] int in_circle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d);

// > 0 if d lies below the plane through a, b, c (a, b, c counter-clockwise seen from above), < 0 above, 0 on it.
[[nodiscard]] int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

}  // namespace crofton
