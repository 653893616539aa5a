// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/cull/cull.hpp>

#include "convert.hpp"

namespace crofton::python {

// From a Camera or a Frustum. Raises TypeError for others.
[[nodiscard]] cull::View view_of(const py::handle& given, std::uint32_t layers);

}  // namespace crofton::python
