// SPDX-License-Identifier: MIT
// Finds the separating axis of two boxes along which they overlap least, among all fifteen, in double.
#pragma once
#include <cmath>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/geometry/box.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "pair_columns.hpp"

namespace crofton::collide {

// Two boxes about the first one's centre, so that nothing is lost far from the origin.
struct BoxPairInDouble {
    BoxPairInDouble(const Obb& first, const Obb& second) : offset(second.center - first.center) {
        size = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
        for (int side = 0; side < 2; ++side) {
            const Obb& box = side == 0 ? first : second;
            for (int k = 0; k < 3; ++k) {
                axes[side][k] = glm::dvec3(box.axes[k]);
                half[side][k] = static_cast<double>(box.half_extents[k]);
                size += half[side][k];
            }
        }
    }
    // A box and a segment: as a second box that is as wide as it is along one axis alone. About the box's centre.
    BoxPairInDouble(const Obb& box, const glm::dvec3& middle, const glm::dvec3& half_segment)
        : BoxPairInDouble(box, Obb{box.center, glm::mat3(0.0f), glm::vec3(0.0f)}) {
        offset = middle;
        axes[1][0] = half_segment;
        half[1][0] = 1.0;
        for (int k = 0; k < 3; ++k) size += std::abs(middle[k]) + std::abs(half_segment[k]);
    }
    // Across the face's edges; as long as these are.
    [[nodiscard]] glm::dvec3 normal(int side, int k) const {
        return glm::cross(axes[side][(k + 1) % 3], axes[side][(k + 2) % 3]);
    }
    [[nodiscard]] glm::dvec3 axis(int number) const {
        if (number < 6) return normal(number / 3, number % 3);
        return glm::cross(axes[0][(number - 6) / 3], axes[1][(number - 6) % 3]);
    }

    glm::dvec3 offset;      // center_b − center_a
    glm::dvec3 axes[2][3];  // of a and of b
    double half[2][3];
    double size;  // |offset|₁ + all half extents: rounding errors scale with it
};

[[nodiscard]] AxisMeasures measures_of(const Obb& a, const Obb& b);

// The axis of the least overlap, numbered as in narrow_phase.hpp; a face comes before an edge product of equal depth.
[[nodiscard]] inline int least_axis(const AxisMeasures& measures) {
    return measures.edge_is_widest ? measures.edge : measures.face;
}
[[nodiscard]] inline double squared_length(const AxisMeasures& measures, int axis) {
    const AxisPlace place = place_of(axis);
    return measures.squared_length[place.group][place.lane];
}
// How deep the boxes overlap along an axis; negative: the gap.
[[nodiscard]] inline double depth_along(const AxisMeasures& measures, int axis) {
    const AxisPlace place = place_of(axis);
    return -measures.gap[place.group][place.lane] / std::sqrt(measures.squared_length[place.group][place.lane]);
}

}  // namespace crofton::collide
