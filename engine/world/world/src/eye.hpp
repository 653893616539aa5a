// SPDX-License-Identifier: MIT
// What a view request is resolved to before the query.
#pragma once
#include <crofton/cull/cull.hpp>
#include <crofton/occlude/occlusion.hpp>

namespace crofton::world {

// The volume of a view, and for occlusion its eye.
struct Eye {
    cull::View plain;
    occlude::OcclusionView occluding;  // if the request asks for occlusion
};

}  // namespace crofton::world
