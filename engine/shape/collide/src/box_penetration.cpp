// SPDX-License-Identifier: MIT
#include "box_penetration.hpp"

#include <crofton/collide/bound_contacts.hpp>

#include "float_pair.hpp"

namespace crofton::collide {

AxisMeasures measures_of(const Obb& a, const Obb& b) {
    AxisMeasures measures;
    measure_axes(columns_of(FloatBox(a), FloatBox(b), b.center - a.center), measures);
    return measures;
}

Penetration penetration(const Obb& a, const Obb& b) {
    const BoxPairInDouble pair(a, b);
    const AxisMeasures measures = measures_of(a, b);
    const int least = least_axis(measures);
    const glm::dvec3 axis = pair.axis(least) / std::sqrt(squared_length(measures, least));
    return {depth_along(measures, least), glm::dot(axis, pair.offset) < 0.0 ? -axis : axis};
}

}  // namespace crofton::collide
