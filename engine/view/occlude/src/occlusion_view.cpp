// SPDX-License-Identifier: MIT
// occlusion_view_of: the view of a camera or of a matrix.
#include <algorithm>
#include <cmath>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/occlude/occlusion.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "exact_turn.hpp"

namespace crofton::occlude {
namespace {

using Row = std::array<double, 4>;

Row row_of(const glm::dvec3& v, double constant) {
    return {v.x, v.y, v.z, constant};
}
glm::dvec3 direction_of(const Row& row) {
    return {row[0], row[1], row[2]};
}
Row row_of(const glm::dmat4& m, int r) {
    return {m[0][r], m[1][r], m[2][r], m[3][r]};
}

constexpr std::size_t kNearPlane = 4;  // of a camera's frustum

// A corner of the view's near face, relative to the view's origin.
glm::dvec3 near_corner(const OcclusionView& view, unsigned i) {
    const auto& p = view.frustum.planes;
    const Plane &a = p[i & 1u], &b = p[2 + (i >> 1)], &c = p[kNearPlane];
    const glm::dvec3 bc = glm::cross(b.normal, c.normal), ca = glm::cross(c.normal, a.normal),
                     ab = glm::cross(a.normal, b.normal);
    return -(a.offset * bc + b.offset * ca + c.offset * ab) / glm::dot(a.normal, bc) +
           (view.frustum.origin - view.origin);
}

// Half of the least w at the corners; every point in the view has a larger w.
double least_w_of(const OcclusionView& view) {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned i = 0; i < 4; ++i)
        least = std::min(least, glm::dot(direction_of(view.rows[2]), near_corner(view, i)) + view.rows[2][3]);
    return 0.5 * least;
}

// Whether a row is constant over the frustum to within 1e-12, the share that rounding may leave.
bool is_constant(const Row& row, const Frustum& frustum, const glm::dvec3& origin) {
    if (direction_of(row) == glm::dvec3(0.0)) return true;
    const auto corners = frustum_corners(frustum);
    return corners && std::all_of(corners->begin(), corners->end(), [&](const glm::dvec3& corner) {
               return std::fabs(glm::dot(direction_of(row), corner + (frustum.origin - origin))) <=
                      1e-12 * std::fabs(row[3]);
           });
}

double near_radius_of(const OcclusionView& view) {
    double radius = 0.0;
    for (unsigned i = 0; i < 4; ++i) radius = std::max(radius, glm::length(near_corner(view, i)));
    return radius * (1.0 + 1e-9);
}

}  // namespace

Result<OcclusionView> occlusion_view_of(const Camera& camera) {
    auto frustum = frustum_of(camera);
    if (!frustum) return frustum.error();
    const glm::dmat3 rotation = world_to_view_rotation(camera);
    const glm::dvec3 right(rotation[0][0], rotation[1][0], rotation[2][0]);
    const glm::dvec3 up(rotation[0][1], rotation[1][1], rotation[2][1]);
    const glm::dvec3 forward = -glm::dvec3(rotation[0][2], rotation[1][2], rotation[2][2]);
    OcclusionView view;
    view.frustum = *frustum;
    view.origin = camera.position;
    view.perspective = camera.projection == Projection::perspective;
    const double half_y = view.perspective ? tangent(0.5 * camera.fov_y) : 0.5 * camera.height;
    view.rows[0] = row_of(right / (half_y * camera.aspect), 0.0);
    view.rows[1] = row_of(up / half_y, 0.0);
    if (view.perspective) {
        view.rows[2] = row_of(forward, 0.0);
        view.rows[3] = row_of(glm::dvec3(0.0), 1.0);
        view.least_w = 0.5 * camera.near_distance;
    } else {
        view.rows[2] = row_of(glm::dvec3(0.0), 1.0);
        view.rows[3] = row_of(-forward, 0.0);
        view.least_w = 0.5;
    }
    view.near_radius = near_radius_of(view);
    return view;
}

Result<OcclusionView> occlusion_view_of(const glm::dmat4& to_clip, DepthRange depth, const glm::dvec3& origin) {
    auto frustum = frustum_of(to_clip, depth, origin);
    if (!frustum) return frustum.error();
    OcclusionView view;
    view.frustum = *frustum;
    const Row x = row_of(to_clip, 0), y = row_of(to_clip, 1), w = row_of(to_clip, 3);
    // A near plane at infinity has been left out, which changes the order of the planes.
    const Row z = row_of(to_clip, 2);
    const bool reversed = depth == DepthRange::reversed_zero_to_one;
    glm::dvec3 near_normal = direction_of(z);
    if (reversed) near_normal = direction_of(w) - near_normal;
    if (depth == DepthRange::minus_one_to_one) near_normal += direction_of(w);
    if (frustum->plane_count < 5 ||
        !(glm::dot(near_normal, frustum->planes[kNearPlane].normal) > 0.999 * glm::length(near_normal)))
        return fail(ErrorCode::unsupported, kNoItem, "occlusion view: the matrix has no near plane");
    // Rays are the lines through the point where the first two rows and w are 0. Where w is constant they are parallel.
    const glm::dvec3 across = glm::cross(direction_of(x), direction_of(y));
    const double turn = glm::dot(across, direction_of(w));
    const double size_x = glm::length(direction_of(x)), size_y = glm::length(direction_of(y)),
                 size_w = glm::length(direction_of(w)), scale = size_x * size_y * size_w;
    view.perspective = !is_constant(w, *frustum, origin);
    if (view.perspective) {
        if (!(std::fabs(turn) > 1e-12 * scale))
            return fail(ErrorCode::unsupported, kNoItem, "occlusion view: the matrix has no eye, and is not parallel");
        const glm::dvec3 eye = -(x[3] * glm::cross(direction_of(y), direction_of(w)) +
                                 y[3] * glm::cross(direction_of(w), direction_of(x)) + w[3] * across) /
                               turn;
        view.origin = origin + eye;
        view.rows = {row_of(direction_of(x), 0.0), row_of(direction_of(y), 0.0), row_of(direction_of(w), 0.0),
                     row_of(glm::dvec3(0.0), 1.0)};
    } else {
        // In each component, so that may_use() knows from which side rays reach a plane.
        glm::dvec3 away = direction_across(direction_of(x), direction_of(y));
        if (glm::dot(away, frustum->planes[kNearPlane].normal) < 0.0) away = -away;
        view.origin = origin;
        view.rows = {row_of(direction_of(x) / w[3], x[3] / w[3]), row_of(direction_of(y) / w[3], y[3] / w[3]),
                     row_of(glm::dvec3(0.0), 1.0), row_of(-away, 0.0)};
    }
    view.least_w = least_w_of(view);
    if (!(view.least_w > 0.0) || !std::isfinite(view.least_w))
        return fail(ErrorCode::unsupported, kNoItem, "occlusion view: the near plane reaches the eye");
    view.near_radius = near_radius_of(view);
    if (view.perspective) {
        // The eye is a quotient. With u = 2^-53 its dividend is within 8 u of `sizes`, and `turn` within 8 u of
        // `scale`: of that a cross product takes 4 u. What one is off by moves the eye by that share of `turn`. 2^-49
        // is 16 u.
        const glm::dvec3 relative = view.origin - origin;
        const double sizes =
            std::fabs(x[3]) * size_y * size_w + std::fabs(y[3]) * size_w * size_x + std::fabs(w[3]) * size_x * size_y;
        view.eye_error =
            0x1p-49 * (sizes + scale * glm::length(relative)) / std::fabs(turn) + 0x1p-50 * glm::length(origin);
    }
    return view;
}

}  // namespace crofton::occlude
