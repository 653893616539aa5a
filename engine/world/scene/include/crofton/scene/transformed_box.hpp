// SPDX-License-Identifier: MIT
// The box of a box after an affine map.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>

namespace crofton::scene {

// A box that contains the exact image of every point of `box` under the stored numbers of `transform`. Similarities
// keep the box's shape but for rounding. Other maps turn it into a parallelepiped. Around that the best box by
// `criterion` with two adjacent flush faces is taken (theory.md section 3). A flat image gets a flat box, up to the
// rounding of its float axes. Always right-handed, also for reflections. Errors: as validate(Obb) for the result: not
// finite or too large.
[[nodiscard]] Result<Obb> transformed_box(const Transform& transform, const Obb& box,
                                          const measure::Criterion& criterion);

}  // namespace crofton::scene
