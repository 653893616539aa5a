// When an edge is the better diagonal of the two triangles beside it.
#pragma once
#include <glm/vec2.hpp>
#include <span>

#include "half_edge_mesh.hpp"

namespace crofton::triangulate {

// Whether edge ab comes before pq: the shorter one does, exactly; of equal ones that with the smaller pair of vertices.
[[nodiscard]] bool shorter(std::span<const glm::dvec2> points, Index a, Index b, Index p, Index q);

// Whether flipping pq between triangles with apexes left and right of it would not improve on it: the flip is longer or
// impossible, as the two form no strictly convex quadrilateral.
[[nodiscard]] bool locally_minimal(std::span<const glm::dvec2> points, Index p, Index q, Index left, Index right);

// Whether two candidates cross. They contain no vertex inside, so unless they share an end all sides are strict.
[[nodiscard]] bool candidates_cross(std::span<const glm::dvec2> points, Index a, Index b, Index c, Index d);

}  // namespace crofton::triangulate
