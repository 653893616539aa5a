// SPDX-License-Identifier: MIT
// A polygon with holes, standing in space.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/geometry/polygon.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::scene {

// The polygon's (x, y) lies at origin + x·u + y·v; it is seen from the side of cross(u, v).
struct PlanarPolygon {
    Polygon polygon;
    glm::dvec3 origin{0.0};
    glm::dvec3 u{1.0, 0.0, 0.0};
    glm::dvec3 v{0.0, 1.0, 0.0};
    glm::vec3 color{0.8f};  // linear RGB
};

// Errors: no points; ring ends that do not ascend to the number of points or rings of fewer than three points; NaN or
// infinite numbers; u and v parallel.
[[nodiscard]] Result<void> validate(const PlanarPolygon& polygon);

// Its triangles in space; vertex i is polygon.points[i], rounded to float. Errors: as validate; an index out of range.
[[nodiscard]] Result<TriangleMesh> to_mesh(const PlanarPolygon& polygon,
                                           std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace crofton::scene
