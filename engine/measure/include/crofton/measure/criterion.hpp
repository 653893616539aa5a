// SPDX-License-Identifier: MIT
// The criterion by which a bound is good for a kind of query: a weighted sum of intrinsic volumes.
#pragma once
#include <crofton/measure/intrinsic_volumes.hpp>

namespace crofton::measure {

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
