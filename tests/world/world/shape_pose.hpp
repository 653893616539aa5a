// SPDX-License-Identifier: MIT
// Where a World's object with a shape stands: its box's frame.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>

namespace crofton::testing {

[[nodiscard]] inline RigidTransform pose_of(const Obb& box) {
    return {glm::dmat3(box.axes), box.center};
}

}  // namespace crofton::testing
