// Volume, surface area and mean curvature of convex bodies: all that a uniformly random query can see of them.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::measure {

// V, F and M = ∫ mean curvature (M = 2π · mean width), in the cube, square and first power of the coordinates' unit.
struct IntrinsicVolumes {
    double volume = 0.0;
    double area = 0.0;
    double mean_curvature = 0.0;
};

// theory.md section 1. A box of edges a, b, c: abc, 2(ab+bc+ca), π(a+b+c).
[[nodiscard]] IntrinsicVolumes of_box(double a, double b, double c);
[[nodiscard]] IntrinsicVolumes of_box(const Obb& box);
[[nodiscard]] IntrinsicVolumes of_ball(double radius);
[[nodiscard]] IntrinsicVolumes of_segment(double length);
[[nodiscard]] IntrinsicVolumes of_flat_polygon(double area, double perimeter);

// A convex polytope by its surface: triangles (three vertex indices each) that close it, counter-clockwise from
// outside; M = ½ Σ edge length × exterior angle. A flat polygon is given by both its sides. Convexity is the caller's
// promise. Errors: NaN or infinite vertices, indices out of range, an edge that is not shared by exactly two triangles.
[[nodiscard]] Result<IntrinsicVolumes> of_polytope(std::span<const glm::dvec3> vertices,
                                                   std::span<const std::uint32_t> triangles);
[[nodiscard]] Result<IntrinsicVolumes> of_polytope(const TriangleMesh& surface);

// The convex hull of points, whatever its dimension. Errors: as crofton::convex_hull.
[[nodiscard]] Result<IntrinsicVolumes> of_hull(std::span<const glm::dvec3> points);

// The view volume of a camera, a convex polytope with 8 corners. Errors: as validate(Camera); far must be finite.
[[nodiscard]] Result<IntrinsicVolumes> of_frustum(const Camera& camera);

// The principal kinematic formula (1): the measure of motions under which B hits K (rotations normalised to 1).
[[nodiscard]] double kinematic_measure(const IntrinsicVolumes& b, const IntrinsicVolumes& k);

}  // namespace crofton::measure
