// SPDX-License-Identifier: MIT
// Computes the box around a transformed box.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/transform.hpp>
#include <crofton/measure/measure.hpp>

namespace crofton::scene {

// Returns a box that contains the exact image of every point of `box` under the stored numbers of `transform`.
//
// Similarities keep the box's shape up to rounding. Other maps turn it into a parallelepiped; the result is then the
// best box around it by `criterion` with two adjacent flush faces (docs/theory.md, section 3). A flat image gets a flat
// box, up to the rounding of its float axes. The result is right-handed, also for reflections. Errors: as validate(Obb)
// for the result: not finite or too large.
[[nodiscard]] Result<Obb> transformed_box(const Transform& transform, const Obb& box,
                                          const measure::Criterion& criterion);

}  // namespace crofton::scene
