// SPDX-License-Identifier: MIT
// Crofton's broadphase beside a plain loop over all boxes.
#pragma once
#include <string>

#include "scene.hpp"

namespace crofton::bullet {

// What is wrong now: a pair of boxes that meet and is not listed, a ray or box query that misses a box. Empty: nothing.
[[nodiscard]] std::string find_fault(Scene& scene, unsigned seed);

}  // namespace crofton::bullet
