// SPDX-License-Identifier: MIT
// A view whose rays can be told apart: where they start, and the pixel that each belongs to.
#pragma once
#include <array>
#include <crofton/core/error.hpp>
#include <crofton/geometry/camera.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace crofton::occlude {

// Maps x to (column, row, w, z) = rows · (x − origin, 1): the ray through x is the point (column / w, row / w) of the
// window [−1, 1]², and z / w falls along each ray. In a perspective view `origin` is the eye, exactly; the first three
// rows then have no fourth number and z is 1. In a parallel view w is 1.
struct OcclusionView {
    Frustum frustum;
    glm::dvec3 origin{0.0};
    std::array<std::array<double, 4>, 4> rows{};
    bool perspective = true;
    double least_w = 0.0;     // w of all that the view sees is above it
    double near_reach = 0.0;  // no point of the near face is farther from the eye; perspective only
    double eye_error = 0.0;   // the eye is within this of `origin`
};

// Errors: as frustum_of(Camera).
[[nodiscard]] Result<OcclusionView> occlusion_view_of(const Camera& camera);

// From a matrix, as frustum_of(matrix): perspective, parallel, off-centre, with an oblique near plane, reversed, with
// an infinite far. The eye is computed from it, and rounded once; it is exact where the matrix takes positions relative
// to the eye. Errors: as frustum_of(matrix); unsupported: no near plane.
[[nodiscard]] Result<OcclusionView> occlusion_view_of(const glm::dmat4& to_clip, DepthRange depth,
                                                      const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace crofton::occlude
