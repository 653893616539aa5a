// SPDX-License-Identifier: MIT
// A list of objects or of hits, as the functions of several sources see it.
#pragma once
#include <crofton/capi/crofton.h>

#include <crofton/world/world.hpp>

#include <crofton/capi/call.hpp>

struct crofton_found {
    static constexpr std::uint32_t kKind = 0x43724f0a;
    crofton::capi::Header header;
    crofton::Vector<crofton::ObjectRef> objects{};
    crofton::Vector<crofton::ObjectHit> hits{};
};
