// SPDX-License-Identifier: MIT
// Who may throw a shadow into a view? The view volume, drawn out towards the light.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/frustum.hpp>
#include <glm/vec3.hpp>

namespace crofton::cull {

// All points from which going away from a far light one may come into `view`: { x + s · toward_light : x in view, s ≥ 0
// }. The planes, at most 12 for a camera's 6, come from eliminating s (Fourier, Motzkin): those that look along the
// light stay, and every pair of one that does and one that does not makes one parallel to the light. Exact up to the
// rounding of the new planes. Errors: a direction that is zero or not finite; a view of more than 6 planes; a volume
// that is all of space.
[[nodiscard]] Result<Frustum> shadow_volume(const Frustum& view, const glm::dvec3& toward_light);

// As above for a light at a point: the convex hull of the view and the light.
[[nodiscard]] Result<Frustum> shadow_volume_of_point(const Frustum& view, const glm::dvec3& light_position);

}  // namespace crofton::cull
