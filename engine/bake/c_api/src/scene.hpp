// SPDX-License-Identifier: MIT
// A scene, as the functions of several headers see it.
#pragma once
#include <crofton/scene/scene.hpp>

#include <crofton/capi/call.hpp>

struct crofton_scene {
    static constexpr std::uint32_t kKind = 0x43724f01;
    crofton::capi::Header header;
    crofton::scene::Scene scene{};
};
