// Polygons with holes to triangles: minimum weight, because that is what a frustum pays for (THEORY.md section 5).
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/polygon.hpp>
#include <array>
#include <cstdint>

namespace crofton::triangulate {

enum class Method : std::uint8_t { ear, delaunay, minimum_weight };

struct Options {
    Method method = Method::minimum_weight;
};

// Triangles hold indices into polygon.points, counter-clockwise. Conforming: every vertex is used, collinear ones too.
struct Triangulation {
    Vector<std::array<std::uint32_t, 3>> triangles;
    double weight = 0.0;   // total length of the diagonals
    bool optimal = false;  // weight is proven minimal
    double gap = 0.0;      // proven bound on (weight − minimum) / minimum, 0 when optimal, infinity when unknown
};

// Errors name ring, index and position: NaN/infinite points, fewer than three points, rings that cross, zero area, ….
[[nodiscard]] Result<Triangulation> triangulate(const Polygon& polygon, const Options& options = {});

}  // namespace crofton::triangulate
