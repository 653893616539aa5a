// SPDX-License-Identifier: MIT
// The handles that several sources see: a scene, and a hierarchy over boxes.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/capi/call.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>

struct crofton_scene {
    static constexpr std::uint32_t kKind = 0x43724f01;
    crofton::capi::Header header;
    crofton::scene::Scene scene{};
};

struct crofton_tree {
    static constexpr std::uint32_t kKind = 0x43724f02;
    crofton::capi::Header header;
    crofton::boxtree::BoxTree tree;
};
