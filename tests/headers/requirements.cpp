// SPDX-License-Identifier: MIT
// Compiled by refused.cmake with flags that must be refused, and with some that must not.
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/shapes.hpp>

#if CROFTON_CPLUSPLUS  // what the check itself defines does not stay
#error
#endif
