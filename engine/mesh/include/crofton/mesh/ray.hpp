// SPDX-License-Identifier: MIT
// Rays and segments against boxes, triangles and meshes.
#pragma once
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/ray.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <crofton/mesh/triangle_triangle.hpp>
#include <cstdint>
#include <optional>

namespace crofton::mesh {

// Where a ray enters a box, or 0 where it starts inside. Rounded: a grazing hit within 1e-14 of the coordinates' size
// may be told either way.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Obb& box);

// Whether the ray's line passes through a triangle, edges and corners included, is decided exactly, so nothing slips
// through between triangles that share an edge; t is rounded. A ray within the plane of a triangle does not hit that
// triangle.
[[nodiscard]] std::optional<double> raycast(const Ray& ray, const Triangle& triangle);

struct RayHit {
    double t = 0.0;
    std::uint32_t triangle = 0;
};
// The nearest triangle, decided likewise; of hits with equal t that of the lowest index.
[[nodiscard]] std::optional<RayHit> raycast(const Ray& ray, const mesh::MeshTree& mesh);
[[nodiscard]] bool hits_any(const Ray& ray, const mesh::MeshTree& mesh);

}  // namespace crofton::mesh
