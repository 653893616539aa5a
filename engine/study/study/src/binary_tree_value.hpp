// SPDX-License-Identifier: MIT
// The value of a node's box.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>

namespace crofton::study {

[[nodiscard]] inline double value(const measure::Criterion& criterion, const Aabb& box) {
    const glm::dvec3 size = box.max - box.min;
    return criterion(size.x, size.y, size.z);
}

[[nodiscard]] inline double value(const measure::Criterion& criterion, const Obb& box) {
    return criterion(measure::intrinsic_volumes_of_box(box));
}

}  // namespace crofton::study
