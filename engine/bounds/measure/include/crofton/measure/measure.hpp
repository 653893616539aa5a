// SPDX-License-Identifier: MIT
// Intrinsic volumes of bodies, the kinematic formula, and criteria made of them.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::measure {

// Intrinsic volumes: the three numbers that determine how often uniformly random queries meet a convex body.

// Volume V, surface area F, and the integral of mean curvature M = 2π · mean width, in the third, second and first
// power of the coordinates' unit.
struct IntrinsicVolumes {
    double volume = 0.0;
    double area = 0.0;
    double mean_curvature = 0.0;
};

// Return the intrinsic volumes of simple bodies (docs/theory.md, section 1). A box of edges a, b, c has abc,
// 2(ab+bc+ca), π(a+b+c).
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_box(double a, double b, double c);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_box(const Obb& box);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_sphere(double radius);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_segment(double length);
[[nodiscard]] IntrinsicVolumes intrinsic_volumes_of_flat_polygon(double area, double perimeter);

// Returns the intrinsic volumes of a convex polytope, with M = ½ Σ edge length × exterior angle.
//
// The polytope is a closed surface of triangles (three vertex indices each), counter-clockwise from outside. A flat
// polygon consists of both its sides. Convexity is not checked. Errors: NaN or infinite vertices, indices out of range,
// an edge that is not shared by exactly two triangles.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(std::span<const glm::dvec3> vertices,
                                                                     std::span<const std::uint32_t> triangles);
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(const TriangleMesh& surface);

// Returns the intrinsic volumes of the convex hull of points, of any dimension. Errors: as crofton::convex_hull.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_hull(std::span<const glm::dvec3> points);

// Returns the intrinsic volumes of a camera's view volume, a convex polytope with 8 corners. Errors: as
// validate(Camera); an infinite far distance.
[[nodiscard]] Result<IntrinsicVolumes> intrinsic_volumes_of_frustum(const Camera& camera);

// Returns the measure of the motions under which B meets K, by the principal kinematic formula (docs/theory.md, (1)).
// Rotations have measure 1, translations their volume.
[[nodiscard]] double kinematic_measure(const IntrinsicVolumes& b, const IntrinsicVolumes& k);

// Describes a triangulated flat polygon for random queries. `boundary` is the length of all its rings, `weight` that of
// the diagonals, each counted once. Any set of flat triangles will do: set `boundary` to the sum of their perimeters
// and `weight` to 0.
struct TriangulationMeasures {
    double triangles = 0.0;  // how many
    double area = 0.0;
    double boundary = 0.0;
    double weight = 0.0;
};

// Returns the sum over the triangles of the measure of the motions under which B meets the triangle (docs/theory.md,
// (6)).
//
// Divide it by the measure of all possible motions to get the mean number of triangles passed. It is exact for convex
// B: perspective, orthographic, near and far plane included.
[[nodiscard]] double triangles_met(const IntrinsicVolumes& b, const TriangulationMeasures& triangulation);

// In the plane, area and perimeter determine how often uniformly random queries meet a convex figure.

// The area and perimeter of a figure. A segment's perimeter is twice its length, the limit of thin rectangles.
struct PlanarMeasures {
    double area = 0.0;
    double perimeter = 0.0;
};

[[nodiscard]] PlanarMeasures planar_measures_of_disc(double radius);
[[nodiscard]] PlanarMeasures planar_measures_of_rectangle(double a, double b);
[[nodiscard]] PlanarMeasures planar_measures_of_segment(double length);
// Takes points in counter-clockwise order; one or two are a point or a segment. Convexity is not checked.
[[nodiscard]] PlanarMeasures planar_measures_of_convex_polygon(std::span<const glm::dvec2> points);

// Returns the corners of the convex hull, counter-clockwise from the lowest of the leftmost points (Andrew's monotone
// chain).
//
// No corner lies on a segment between two others. There is one corner if all points are equal, and two if all are
// collinear. Errors: no points (empty); a NaN or infinite coordinate, by its index.
[[nodiscard]] Result<Vector<glm::dvec2>> convex_hull(std::span<const glm::dvec2> points);

// Returns the measure of the motions of the plane under which B meets K, by Blaschke's formula: A_B + A_K + L_B·L_K/2π.
// Rotations have measure 1, translations their area.
[[nodiscard]] double kinematic_measure(const PlanarMeasures& b, const PlanarMeasures& k);

// Returns the measure of the undirected lines that hit a convex figure: its perimeter (Crofton).
[[nodiscard]] inline double measure_of_lines(const PlanarMeasures& k) {
    return k.perimeter;
}

// Measures of false answers of a bound: the query meets the bound but not the object, or contains the object but not
// the bound.

// Returns m_o, the measure of motions under which `query` hits the bound and misses the object (its hull), exactly, by
// (1).
//
// A ray of length ℓ is intrinsic_volumes_of_segment(ℓ), with α = V − V₀ and β = (F − F₀)·ℓ/4. Requires object ⊂ bound,
// both convex.
[[nodiscard]] double improper_outside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                      const IntrinsicVolumes& object);
[[nodiscard]] double improper_outside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                      const PlanarMeasures& object);

// Returns an upper bound of m_i, the measure of motions under which `query` contains the object but not the bound.
// Intrinsic volumes do not determine m_i. The bound is the lesser of two:
// - To first order, F_B·(M − M₀)/4π in space, L_B·(L − L₀)/2π in the plane. The relative error goes to 0 as the query
//   grows. It is an upper bound, because no face of the part that the query leaves of itself is larger than the query's
//   own.
// - The measure of motions that contain the object, by the inequality of Brunn and Minkowski, for bounds as large as
//   the query. A ray contains nothing, so it is 0.
//
// Requires object ⊂ bound, both convex.
[[nodiscard]] double improper_inside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                     const IntrinsicVolumes& object);
[[nodiscard]] double improper_inside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                     const PlanarMeasures& object);

// Criteria for bounds: weighted sums of intrinsic volumes.

// The criterion α·V + β·F + γ·M, with all weights ≥ 0 and not all 0.
//
// The body that minimises it minimises the expected number of hits (kinematic formula, docs/theory.md, section 2). By
// Hadwiger's theorem every criterion for uniformly random queries has this form.
struct Criterion {
    double volume_weight = 0.0;          // α
    double area_weight = 0.0;            // β
    double mean_curvature_weight = 0.0;  // γ

    [[nodiscard]] double operator()(const IntrinsicVolumes& k) const {
        return volume_weight * k.volume + area_weight * k.area + mean_curvature_weight * k.mean_curvature;
    }
    // Returns the criterion of a box of edges a, b, c.
    [[nodiscard]] double operator()(double a, double b, double c) const {
        return (*this)(intrinsic_volumes_of_box(a, b, c));
    }
};

// Returns the criterion for random points: α = 1.
[[nodiscard]] Criterion minimal_volume();
// Returns the criterion for rays that are long compared with the objects: β = 1.
[[nodiscard]] Criterion minimal_area();
// Returns the criterion for frusta that are large compared with the objects: γ = 1/π. For a box this is the sum of its
// three edges, a + b + c, which the paper calls its perimeter; it is twice the mean width.
[[nodiscard]] Criterion minimal_perimeter();
// Returns the criterion for segments of this length: α = 1, β = length/4.
[[nodiscard]] Criterion for_rays(double length);
// Returns the criterion for a convex body B that moves uniformly, such as a collision partner: α = 1, β = M_B/4π, γ =
// F_B/4π (docs/theory.md, (2)).
[[nodiscard]] Criterion for_partner(const IntrinsicVolumes& b);
// Returns the criterion for a camera's view volume. Errors: as intrinsic_volumes_of_frustum.
[[nodiscard]] Result<Criterion> for_frustum(const Camera& camera);

// Checks a criterion. Errors: NaN, infinite or negative weights, all weights zero.
[[nodiscard]] Result<void> validate(const Criterion& criterion);

}  // namespace crofton::measure
