// SPDX-License-Identifier: MIT
// A hierarchy over boxes, as the functions of several headers see it.
#pragma once
#include <crofton/boxtree/box_tree.hpp>

#include <crofton/capi/call.hpp>

struct crofton_tree {
    static constexpr std::uint32_t kKind = 0x43724f02;
    crofton::capi::Header header;
    crofton::boxtree::BoxTree tree;
};
