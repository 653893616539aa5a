// SPDX-License-Identifier: MIT
// Measures the queries that a bound answers wrongly for its object.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <numbers>

namespace crofton::measure {

using std::numbers::pi;

double improper_outside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound, const IntrinsicVolumes& object) {
    return kinematic_measure(query, bound) - kinematic_measure(query, object);
}
double improper_outside(const PlanarMeasures& query, const PlanarMeasures& bound, const PlanarMeasures& object) {
    return kinematic_measure(query, bound) - kinematic_measure(query, object);
}
namespace {

// Returns the rest of a length after another is subtracted.
double rest(double a, double b) {
    return std::max(0.0, a - b);
}

// At most so many motions bring the object into the query. For a fixed rotation its places are the body
// K' = { x : x + object ⊂ query }, and K' + object ⊂ query. By Brunn and Minkowski the cube root of the volume, the
// square root of the area and the mean width of K' and object therefore sum to no more than the query's. Area and mean
// width bound a volume (isoperimetric inequality, Urysohn).
double containing(const IntrinsicVolumes& query, const IntrinsicVolumes& object) {
    const double by_volume = rest(cube_root(query.volume), cube_root(object.volume));
    const double by_area = rest(std::sqrt(query.area), std::sqrt(object.area)) / cube_root(6.0 * std::sqrt(pi));
    const double by_width = rest(query.mean_curvature, object.mean_curvature) / (4.0 * pi) * cube_root(4.0 / 3.0 * pi);
    const double least = std::min({by_volume, by_area, by_width});
    return least * least * least;
}
double containing(const PlanarMeasures& query, const PlanarMeasures& object) {
    const double by_area = rest(std::sqrt(query.area), std::sqrt(object.area));
    const double by_length = rest(query.perimeter, object.perimeter) / std::sqrt(4.0 * pi);
    const double least = std::min(by_area, by_length);
    return least * least;
}

}  // namespace

double improper_inside(const IntrinsicVolumes& query, const IntrinsicVolumes& bound, const IntrinsicVolumes& object) {
    const double first_order = query.area * (bound.mean_curvature - object.mean_curvature) / (4.0 * pi);
    return std::min(first_order, containing(query, object));
}
double improper_inside(const PlanarMeasures& query, const PlanarMeasures& bound, const PlanarMeasures& object) {
    const double first_order = query.perimeter * (bound.perimeter - object.perimeter) / (2.0 * pi);
    return std::min(first_order, containing(query, object));
}

}  // namespace crofton::measure
