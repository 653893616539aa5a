// SPDX-License-Identifier: MIT
// Intrinsic volumes: the three numbers that say how often uniformly random queries meet a convex body.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::measure {

// Volume V, surface area F, and the integral of mean curvature M = 2π · mean width, in the third, second and first
// power of the coordinates' unit.
struct IntrinsicVolumes {
    double volume = 0.0;
    double area = 0.0;
    double mean_curvature = 0.0;
};

// theory.md section 1. A box of edges a, b, c: abc, 2(ab+bc+ca), π(a+b+c).
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_box(double a, double b, double c);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_box(const Obb& box);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_sphere(double radius);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_segment(double length);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_flat_polygon(double area, double perimeter);

// A convex polytope, given by a closed surface of triangles (three vertex indices each), counter-clockwise from
// outside. A flat polygon is given by both its sides. M = ½ Σ edge length × exterior angle. Convexity is not checked.
// Errors: NaN or infinite vertices, indices out of range, an edge that is not shared by exactly two triangles.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(std::span<const glm::dvec3> vertices,
                                                                     std::span<const std::uint32_t> triangles);
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(const TriangleMesh& surface);

// The convex hull of points, whatever its dimension. Errors: as crofton::convex_hull.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_hull(std::span<const glm::dvec3> points);

// The view volume of a camera, a convex polytope with 8 corners. Errors: as validate(Camera); far must be finite.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_frustum(const Camera& camera);

// The measure of the motions under which B meets K, by the principal kinematic formula, theory.md (1). Rotations have
// measure 1, translations their volume.
[[nodiscard]] double kinematic_measure(const IntrinsicVolumes& b, const IntrinsicVolumes& k);

}  // namespace crofton::measure
