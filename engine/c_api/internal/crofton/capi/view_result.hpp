// SPDX-License-Identifier: MIT
// The result of a view, whatever was viewed.
#pragma once
#include <crofton/capi/view.h>

#include <crofton/cull/cull.hpp>
#include <crofton/world/answers.hpp>

#include <crofton/capi/call.hpp>

// One of the three answers; the others are those of earlier calls. A World's objects are looked up in it: `serial` says
// in which, and after which update.
struct crofton_view_result {
    static constexpr std::uint32_t kKind = 0x43724f09;
    enum class Of : std::uint8_t { world, many_of_world, boxes };
    crofton::capi::Header header;
    crofton::ViewResult one{};
    crofton::MultiViewResult many{};
    crofton::cull::VisibleSet boxes{};  // of a list or a tree
    crofton::cull::View view{};         // that they were asked with: planes that it does not use need no clearing
    Of of = Of::boxes;
    bool is_counted = true;  // whether a World's view went through its volume, with statistics of that
    std::uint64_t serial = 0;
};
