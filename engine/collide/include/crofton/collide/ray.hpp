// Rays and segments against boxes, triangles and meshes.
#pragma once
#include <crofton/collide/triangle_triangle.hpp>
#include <crofton/core/error.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/tree/mesh_tree.hpp>
#include <cstdint>
#include <limits>
#include <optional>

namespace crofton::collide {

// The points origin + t · direction, 0 ≤ t ≤ max_t; a segment from p to q is {p, q − p, 1}. `direction` need not be of
// unit length, max_t may be infinite. A ray that fails validate hits nothing.
struct Ray {
    glm::dvec3 origin{0.0}, direction{0.0, 0.0, 1.0};
    double max_t = std::numeric_limits<double>::infinity();
};

// Errors: an origin or direction that is not finite; no direction; max_t negative or NaN.
[[nodiscard]] Result<void> validate(const Ray& ray, std::uint64_t item = kNoItem);

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
[[nodiscard]] std::optional<RayHit> raycast(const Ray& ray, const tree::MeshTree& mesh);
[[nodiscard]] bool hits_any(const Ray& ray, const tree::MeshTree& mesh);

}  // namespace crofton::collide
