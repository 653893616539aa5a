// SPDX-License-Identifier: MIT
// What views of a World have found, as the functions of several headers see it.
#pragma once
#include <crofton/capi/crofton.h>

#include <array>

#include "world.hpp"

// Results look their objects up in the world: `serial` says in which, and after which update.
struct crofton_visible_objects {
    static constexpr std::uint32_t kKind = 0x43724f09;
    crofton::capi::Header header;
    crofton::ViewResult visible{};
    std::uint64_t serial = 0;
};
struct crofton_visible_in_views {
    static constexpr std::uint32_t kKind = 0x43724f0b;
    crofton::capi::Header header;
    crofton::MultiViewResult visible{};
    std::uint64_t serial = 0;
};

namespace crofton::capi {

// `visible` is a result of either type.
template <class Visible>
[[nodiscard]] crofton_status check_viewed(const Visible& visible, const crofton_world& world, const char* function) {
    if (visible.serial == world.serial) return CROFTON_OK;
    return report(CROFTON_INVALID_ARGUMENT, function,
                  "the result is not of a view of this world, or the world has been updated since");
}

}  // namespace crofton::capi
