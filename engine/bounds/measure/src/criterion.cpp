// SPDX-License-Identifier: MIT
// Defines the criteria that fits and trees minimise.
#include <cmath>
#include <crofton/measure/measure.hpp>
#include <numbers>

namespace crofton::measure {

using std::numbers::pi;

Criterion minimal_volume() {
    return {1.0, 0.0, 0.0};
}
Criterion minimal_area() {
    return {0.0, 1.0, 0.0};
}
Criterion minimal_perimeter() {
    return {0.0, 0.0, 1.0 / pi};
}
Criterion for_rays(double length) {
    return for_partner(intrinsic_volumes_of_segment(length));
}
Criterion for_partner(const IntrinsicVolumes& b) {
    return {1.0, b.mean_curvature / (4.0 * pi), b.area / (4.0 * pi)};
}

Result<Criterion> for_frustum(const Camera& camera) {
    const auto of_frustum = intrinsic_volumes_of_frustum(camera);
    if (!of_frustum) return of_frustum.error();
    return for_partner(*of_frustum);
}

Result<void> validate(const Criterion& criterion) {
    const double weights[] = {criterion.volume_weight, criterion.area_weight, criterion.mean_curvature_weight};
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!std::isfinite(weights[i])) return fail(ErrorCode::non_finite, i, "criterion: a weight is NaN or infinite");
        if (weights[i] < 0.0) return fail(ErrorCode::invalid_argument, i, "criterion: a weight is negative");
        sum += weights[i];
    }
    if (sum == 0.0) return fail(ErrorCode::invalid_argument, kNoItem, "criterion: all weights are zero");
    return {};
}

}  // namespace crofton::measure
