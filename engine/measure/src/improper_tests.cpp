// SPDX-License-Identifier: MIT
#include <crofton/measure/intrinsic_volumes.hpp>
#include <numbers>

namespace crofton::measure {

using std::numbers::pi;

double improper_outside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound, const IntrinsicVolumes& object) {
    return kinematic_measure(query, bound) - kinematic_measure(query, object);
}
double improper_outside(const PlanarMeasures& query, const PlanarMeasures& bound, const PlanarMeasures& object) {
    return kinematic_measure(query, bound) - kinematic_measure(query, object);
}
double improper_inside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound, const IntrinsicVolumes& object) {
    return query.area * (bound.mean_curvature - object.mean_curvature) / (4.0 * pi);
}
double improper_inside(const PlanarMeasures& query, const PlanarMeasures& bound, const PlanarMeasures& object) {
    // A figure without area contains nothing, and its boundary is passed twice.
    return query.area > 0.0 ? query.perimeter * (bound.perimeter - object.perimeter) / (2.0 * pi) : 0.0;
}

}  // namespace crofton::measure
