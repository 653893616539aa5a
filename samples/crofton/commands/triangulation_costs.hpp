// SPDX-License-Identifier: MIT
// Costs of a triangulation for a frustum, a rasterizer and its pixels: predicted and measured.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/triangulate/triangulate.hpp>
#include <cstdint>
#include <span>
#include <vector>

namespace crofton::cli {

// A polygon with one triangulation for each method, moved and scaled to width and height of at most 1.
struct TriangulatedPolygon {
    Polygon polygon;
    std::vector<triangulate::Triangulation> results;
};

// Means over trials, one for each method; `error` is the standard error of measured − predicted.
struct Comparison {
    std::vector<double> predicted, measured, error;
};

// Trial i takes polygon i modulo their number and a uniformly random perspective frustum, as deep as the polygon is
// large, among those near it; counted are the triangles that meet it, predicted by theory.md (6).
[[nodiscard]] Comparison triangles_passed(std::span<const TriangulatedPolygon> polygons, std::uint64_t trials);

// The polygon is laid at random on a pixel grid, `size` pixels large. Counted are the 2 × 2 quads whose square of pixel
// centres a triangle meets, for which A/4 + P/2π + 1/4 is the exact mean; `covered` are those of which it covers a
// centre, which a GPU shades.
struct QuadComparison {
    Comparison met;
    std::vector<double> covered;
};
[[nodiscard]] QuadComparison pixel_quads(std::span<const TriangulatedPolygon> polygons, std::uint64_t trials,
                                         double size);

// All polygons side by side on a wall, drawn on a software Vulkan device from cameras before it; per frame.
struct DrawCost {
    double submitted = 0.0, clipped = 0.0, milliseconds = 0.0;
};
[[nodiscard]] Result<std::vector<DrawCost>> draw_wall(std::span<const TriangulatedPolygon> polygons, int frames);

}  // namespace crofton::cli
