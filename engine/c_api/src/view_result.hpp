// SPDX-License-Identifier: MIT
// What views of a World have found, as the functions of several files see it.
#pragma once
#include <crofton/capi/crofton.h>

#include "world.hpp"

// Of one view or of many: the other of the two members is that of an earlier call. Objects are looked up in the world:
// `serial` says in which, and after which update.
struct crofton_view_result {
    static constexpr std::uint32_t kKind = 0x43724f09;
    crofton::capi::Header header;
    crofton::ViewResult one{};
    crofton::MultiViewResult many{};
    bool is_many = false;
    std::uint64_t serial = 0;
};

namespace crofton::capi {

[[nodiscard]] inline crofton_status check_viewed(const crofton_view_result& result, const crofton_world& world,
                                                 const char* function) {
    if (result.serial == world.serial) return CROFTON_OK;
    return report(CROFTON_INVALID_ARGUMENT, function,
                  "the result is not of a view of this world, or the world has been updated since");
}

}  // namespace crofton::capi
