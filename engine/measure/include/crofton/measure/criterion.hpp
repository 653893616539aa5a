// What "a good bound" means for the queries that will meet it: a weighted sum of intrinsic volumes.
#pragma once
#include <crofton/measure/intrinsic_volumes.hpp>

namespace crofton::measure {

// α·V + β·F + γ·M, all weights ≥ 0 and not all 0. By Hadwiger's theorem every criterion for uniformly random queries
// has this form; minimising it minimises the expected number of hits (kinematic formula, theory.md section 2).
struct Criterion {
    double volume_weight = 0.0;          // α
    double area_weight = 0.0;            // β
    double mean_curvature_weight = 0.0;  // γ

    [[nodiscard]] double operator()(const IntrinsicVolumes& k) const {
        return volume_weight * k.volume + area_weight * k.area + mean_curvature_weight * k.mean_curvature;
    }
    // For a box of edges a, b, c.
    [[nodiscard]] double operator()(double a, double b, double c) const { return (*this)(of_box(a, b, c)); }
};

[[nodiscard]] Criterion minimal_volume();     // α = 1
[[nodiscard]] Criterion minimal_area();       // β = 1: long rays
[[nodiscard]] Criterion minimal_perimeter();  // γ = 1/π: the edge sum a + b + c; frusta large beside the objects
// Segments of this length: α = 1, β = length/4.
[[nodiscard]] Criterion for_rays(double length);
// A body B that moves uniformly, a collision partner or a frustum: α = 1, β = M_B/4π, γ = F_B/4π (2).
[[nodiscard]] Criterion for_partner(const IntrinsicVolumes& b);
[[nodiscard]] Result<Criterion> for_frustum(const Camera& camera);

// Errors: NaN, infinite or negative weights, all weights zero.
[[nodiscard]] Result<void> validate(const Criterion& criterion);

}  // namespace crofton::measure
