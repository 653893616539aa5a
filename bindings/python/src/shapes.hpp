// SPDX-License-Identifier: MIT
// The keywords box=, sphere=, aligned= and capsule=, of which a call takes one.
#pragma once
#include <crofton/collide/narrow_phase.hpp>
#include <variant>

#include "convert.hpp"

namespace crofton::python {

// Returns the bound of a Box, a sphere (center, radius) or an aligned box (low, high); no bound if none is given.
// Raises TypeError for more than one. World::add checks the numbers.
[[nodiscard]] Bound bound_of(const py::object& box, const py::object& sphere, const py::object& aligned);

// A shape to ask with, its numbers checked: queries find nothing for bad ones, and say nothing.
using Shape = std::variant<Obb, Sphere, collide::Capsule>;
[[nodiscard]] Shape shape_of(const py::object& box, const py::object& sphere, const py::object& capsule);

// Raises Error for a limit that is NaN or negative; it may be infinite.
void check_limit(double value, const char* name);

}  // namespace crofton::python
