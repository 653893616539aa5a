// SPDX-License-Identifier: MIT
// The fifteen separating axes of two boxes in double: along which do they overlap least?
#pragma once
#include <cmath>
#include <crofton/collide/obb_obb.hpp>
#include <crofton/geometry/box.hpp>
#include <glm/vec3.hpp>

namespace crofton::collide {

// Two boxes about the first one's centre, so that nothing is lost far from the origin.
struct BoxPairInDouble {
    BoxPairInDouble(const Obb& first, const Obb& second);

    glm::dvec3 offset;      // center_b − center_a
    glm::dvec3 axes[2][3];  // of a and of b
    double half[2][3];
    glm::dvec3 normals[2][3];  // cross products of the other two axes
    double size;               // |offset|₁ + all half extents: rounding errors scale with it
};

// An axis, numbered as in obb_obb.hpp, and the overlap along it times the axis's length.
struct AxisOverlap {
    glm::dvec3 axis{0.0};
    double scaled_depth = 0.0, squared_length = 1.0;
    int number = kNotSeparated;

    [[nodiscard]] double depth() const { return scaled_depth / std::sqrt(squared_length); }
    // Without dividing.
    [[nodiscard]] bool is_less_than(const AxisOverlap& other) const {
        return scaled_depth * std::abs(scaled_depth) * other.squared_length <
               other.scaled_depth * std::abs(other.scaled_depth) * squared_length;
    }
};

struct BoxOverlap {
    AxisOverlap faces[6];
    AxisOverlap edge;          // the least of the edges' that are not parallel; number is −1 where all are
    double error_bound = 0.0;  // of the scaled depths
    double least = 0.0;        // scaled depth of all axes, parallel edges too

    // Boxes whose depths are all beyond the error bound surely meet; where one is below it, they surely do not.
    [[nodiscard]] bool surely_meet() const { return least > error_bound; }
    [[nodiscard]] bool surely_apart() const { return least < -error_bound; }
};
[[nodiscard]] BoxOverlap overlap_of(const Obb& a, const Obb& b, const BoxPairInDouble& pair);
// The least of all; a face comes before an edge product of equal depth.
[[nodiscard]] const AxisOverlap& least_of(const BoxOverlap& overlap);

}  // namespace crofton::collide
