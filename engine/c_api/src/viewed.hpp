// SPDX-License-Identifier: MIT
// The result of a view of a World, whose objects are looked up in it.
#pragma once
#include <crofton/capi/crofton.h>

#include <crofton/capi/view_result.hpp>
#include "world.hpp"

namespace crofton::capi {

[[nodiscard]] inline crofton_status check_viewed(const crofton_view_result& result, const crofton_world& world,
                                                 const char* function) {
    if (result.serial == world.serial) return CROFTON_OK;
    return report(CROFTON_INVALID_ARGUMENT, function,
                  "the result is not of a view of this world, or the world has been updated since");
}

}  // namespace crofton::capi
