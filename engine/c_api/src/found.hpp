// SPDX-License-Identifier: MIT
// What the last query of a World has found, of the C API.
#pragma once
#include <crofton/capi/crofton.h>
#include <crofton/world/object_manifold.hpp>
#include <crofton/world/world.hpp>

#include <crofton/capi/call.hpp>

// One of the lists has elements.
struct crofton_found {
    static constexpr std::uint32_t kKind = 0x43724f0a;
    crofton::capi::Header header;
    crofton::Vector<crofton::ObjectRef> objects{};
    crofton::Vector<crofton::ObjectHit> hits{};
    crofton::Vector<crofton_shape_hit> shape_hits{};
    crofton::Vector<crofton::ObjectManifold> manifolds{};

    void clear() {
        objects.clear();
        hits.clear();
        shape_hits.clear();
        manifolds.clear();
    }
};
