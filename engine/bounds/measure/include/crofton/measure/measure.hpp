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

// Intrinsic volumes: the three numbers that say how often uniformly random queries meet a convex body.

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

// A triangulated flat polygon, as far as random queries see it. `boundary`: the length of all its rings; `weight`: of
// the diagonals, each counted once. Any flat triangles fit: put the sum of their perimeters into `boundary`, weight 0.
struct TriangulationMeasures {
    double triangles = 0.0;  // how many
    double area = 0.0;
    double boundary = 0.0;
    double weight = 0.0;
};

// Σ over the triangles of the measure of the motions under which B meets the triangle, theory.md (6). Divided by the
// measure of all motions drawn from, it is the mean number of triangles passed. Exact for convex B: perspective,
// orthographic, near and far plane included.
[[nodiscard]] double triangles_met(const IntrinsicVolumes& b, const TriangulationMeasures& triangulation);

// The plane: area and perimeter say how often uniformly random queries meet a convex figure.

// A segment's perimeter is twice its length: the limit of thin rectangles.
struct PlanarMeasures {
    double area = 0.0;
    double perimeter = 0.0;
};

[[nodiscard]] PlanarMeasures planar_measures_of_disc(double radius);
[[nodiscard]] PlanarMeasures planar_measures_of_rectangle(double a, double b);
[[nodiscard]] PlanarMeasures planar_measures_of_segment(double length);
// Points in counter-clockwise order; one or two are a point or a segment. Convexity is not checked.
[[nodiscard]] PlanarMeasures planar_measures_of_convex_polygon(std::span<const glm::dvec2> points);

// The convex hull's corners, counter-clockwise from the lowest of the leftmost points, none within a segment of two
// others (Andrew's monotone chain). One corner where all points are equal, two where all are collinear. Errors: no
// points (empty); a NaN or infinite coordinate, by its index.
[[nodiscard]] Result<Vector<glm::dvec2>> convex_hull(std::span<const glm::dvec2> points);

// The measure of the motions of the plane under which B meets K, by Blaschke's formula: A_B + A_K + L_B·L_K/2π.
// Rotations have measure 1, translations their area.
[[nodiscard]] double kinematic_measure(const PlanarMeasures& b, const PlanarMeasures& k);

// The measure of the lines, without direction, that hit a convex figure: its perimeter (Crofton).
[[nodiscard]] inline double measure_of_lines(const PlanarMeasures& k) {
    return k.perimeter;
}

// How often a bound misleads: a query meets the bound but not the object, or contains the object but not the bound.

// m_o: the measure of motions under which `query` hits the bound and misses the object (its hull), exactly, by (1).
// Rays of length ℓ are intrinsic_volumes_of_segment(ℓ): α = V − V₀ and β = (F − F₀)·ℓ/4. Requires object ⊂ bound, both
// convex.
[[nodiscard]] double improper_outside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                      const IntrinsicVolumes& object);
[[nodiscard]] double improper_outside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                      const PlanarMeasures& object);

// m_i: the measure of motions under which `query` contains the object but not the bound. Intrinsic volumes do not
// determine it; this is an upper bound, the lesser of two:
// - to first order F_B·(M − M₀)/4π in space, L_B·(L − L₀)/2π in the plane. The relative error goes to 0 as the query
//   grows. It is an upper bound, since no face of what a query leaves of itself is larger than the query's own.
// - the measure of motions that contain the object, by Brunn's and Minkowski's inequality: for bounds as large as the
//   query. Rays contain nothing: 0.
// Requires object ⊂ bound, both convex.
[[nodiscard]] double improper_inside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound,
                                     const IntrinsicVolumes& object);
[[nodiscard]] double improper_inside(const PlanarMeasures& query, const PlanarMeasures& bound,
                                     const PlanarMeasures& object);

// The criterion by which a bound is good for a kind of query: a weighted sum of intrinsic volumes.

// α·V + β·F + γ·M, all weights ≥ 0 and not all 0. Minimising it minimises the expected number of hits (kinematic
// formula, theory.md section 2). By Hadwiger's theorem every criterion for uniformly random queries has this form.
struct Criterion {
    double volume_weight = 0.0;          // α
    double area_weight = 0.0;            // β
    double mean_curvature_weight = 0.0;  // γ

    [[nodiscard]] double operator()(const IntrinsicVolumes& k) const {
        return volume_weight * k.volume + area_weight * k.area + mean_curvature_weight * k.mean_curvature;
    }
    // For a box of edges a, b, c.
    [[nodiscard]] double operator()(double a, double b, double c) const {
        return (*this)(intrinsic_volumes_of_box(a, b, c));
    }
};

// α = 1: for random points.
[[nodiscard]] Criterion minimal_volume();
// β = 1: for rays that are long beside the objects.
[[nodiscard]] Criterion minimal_area();
// γ = 1/π: for frusta that are large beside the objects. Of a box this is the sum of its three edges, a + b + c, which
// the paper calls its perimeter; it is twice the mean width.
[[nodiscard]] Criterion minimal_perimeter();
// For segments of this length: α = 1, β = length/4.
[[nodiscard]] Criterion for_rays(double length);
// For a convex body B that moves uniformly, such as a collision partner: α = 1, β = M_B/4π, γ = F_B/4π, theory.md (2).
[[nodiscard]] Criterion for_partner(const IntrinsicVolumes& b);
// The same for the view volume of a camera. Errors: as intrinsic_volumes_of_frustum.
[[nodiscard]] Result<Criterion> for_frustum(const Camera& camera);

// Errors: NaN, infinite or negative weights, all weights zero.
[[nodiscard]] Result<void> validate(const Criterion& criterion);

}  // namespace crofton::measure
