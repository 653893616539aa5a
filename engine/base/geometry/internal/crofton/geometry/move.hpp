// SPDX-License-Identifier: MIT
// Boxes that are stored relative to an origin far away, and what filters must allow for.
#pragma once
#include <crofton/geometry/box.hpp>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace crofton {

// A translation. Moved boxes have centers of one rounded sum for each axis.
struct Move {
    glm::dvec3 by{0.0};
    double most = 0.0;  // no coordinate of a center that is moved exceeds it in magnitude

    [[nodiscard]] Obb operator()(const Obb& box) const {
        Obb result = box;
        result.center += by;
        return result;
    }
    // Returns `point` in the coordinates before the move.
    [[nodiscard]] glm::dvec3 back(const glm::dvec3& point) const { return point - by; }
    // Bounds the L1 norm of the error of comparing back(point), instead of `point`, with boxes before the move, instead
    // of moved boxes. On each axis the center's sum rounds by 2^-53 (most + |by|), and the point's difference by 2^-53
    // (|point| + |by|). Four times that.
    [[nodiscard]] double rounding(const glm::dvec3& point) const {
        const glm::dvec3 sizes = most + 2.0 * glm::abs(by) + glm::abs(point);
        return 0x1p-51 * (sizes.x + sizes.y + sizes.z);
    }
};

}  // namespace crofton
