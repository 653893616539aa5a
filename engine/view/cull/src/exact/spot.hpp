// SPDX-License-Identifier: MIT
// Spot light against convex volume, exactly.
#pragma once
#include <crofton/cull/lights.hpp>
#include <crofton/geometry/camera.hpp>

namespace crofton::cull {

// The spot light whose numbers stand for `spot`: what is too small in its axis and cosine is 0.
[[nodiscard]] SpotLight as_read(const SpotLight& spot);

// True iff the frustum and the light share a point. Requires numbers that are usable and of at most 1e12, planes
// without numbers below 2^-60 other than 0, and a light that is as_read().
[[nodiscard]] bool meets(const Frustum& frustum, const SpotLight& spot);

}  // namespace crofton::cull
