// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/camera.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace crofton {
namespace {

void add(Frustum& frustum, const glm::dvec3& normal, double offset) {
    const double length = glm::length(normal);
    frustum.planes[frustum.plane_count++] = Plane{normal / length, offset / length};
}

glm::dvec4 row(const glm::dmat4& m, int r) {
    return {m[0][r], m[1][r], m[2][r], m[3][r]};
}

// Up to rounding. Rows count by their directions, and the last column in units of the distance at which planes lie.
// Seen from a far origin, all rows are mostly translation, and nearly parallel.
bool is_singular(const std::array<glm::dvec4, 4>& rows) {
    double distance = 1.0;
    for (const glm::dvec4& r : rows)
        if (const double size = glm::length(glm::dvec3(r)); size > 0.0)
            distance = std::max(distance, std::abs(r.w) / size);
    glm::dmat4 scaled(0.0);
    for (int r = 0; r < 4; ++r) {
        const glm::dvec4& row = rows[static_cast<std::size_t>(r)];
        const glm::dvec4 in_units(glm::dvec3(row), row.w / distance);
        scaled[r] = in_units / glm::length(in_units);
    }
    return !(std::abs(glm::determinant(scaled)) > 1e-14);
}

// The point where three planes meet. Requires that they do.
glm::dvec3 meet(const Plane& a, const Plane& b, const Plane& c) {
    const glm::dvec3 bc = glm::cross(b.normal, c.normal);
    const glm::dvec3 ca = glm::cross(c.normal, a.normal);
    const glm::dvec3 ab = glm::cross(a.normal, b.normal);
    return -(a.offset * bc + b.offset * ca + c.offset * ab) / glm::dot(a.normal, bc);
}

}  // namespace

Result<Frustum> frustum_of(const Camera& camera) {
    if (auto valid = validate(camera); !valid) return valid.error();
    const glm::dmat3 rotation = world_to_view_rotation(camera);
    const glm::dvec3 right(rotation[0][0], rotation[1][0], rotation[2][0]);
    const glm::dvec3 up(rotation[0][1], rotation[1][1], rotation[2][1]);
    const glm::dvec3 forward = -glm::dvec3(rotation[0][2], rotation[1][2], rotation[2][2]);
    Frustum frustum;
    frustum.origin = camera.position;
    if (camera.projection == Projection::perspective) {
        const double tan_y = tangent(0.5 * camera.fov_y);
        const double tan_x = tan_y * camera.aspect;
        add(frustum, right + tan_x * forward, 0.0);
        add(frustum, -right + tan_x * forward, 0.0);
        add(frustum, up + tan_y * forward, 0.0);
        add(frustum, -up + tan_y * forward, 0.0);
    } else {
        const double half_y = 0.5 * camera.height;
        const double half_x = half_y * camera.aspect;
        add(frustum, right, half_x);
        add(frustum, -right, half_x);
        add(frustum, up, half_y);
        add(frustum, -up, half_y);
    }
    add(frustum, forward, -camera.near_distance);
    if (std::isfinite(camera.far_distance)) add(frustum, -forward, camera.far_distance);
    return frustum;
}

Result<Frustum> frustum_of(const glm::dmat4& to_clip, DepthRange depth, const glm::dvec3& origin) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(to_clip[c][r]))
                return fail(ErrorCode::non_finite, static_cast<std::uint64_t>(4 * c + r),
                            "view matrix: an entry is NaN or infinite");
    if (!std::isfinite(origin.x) || !std::isfinite(origin.y) || !std::isfinite(origin.z))
        return fail(ErrorCode::non_finite, kNoItem, "view matrix: the origin is NaN or infinite");
    const glm::dvec4 x = row(to_clip, 0), y = row(to_clip, 1), z = row(to_clip, 2), w = row(to_clip, 3);
    if (is_singular({x, y, z, w}))
        return fail(ErrorCode::degenerate, kNoItem, "view matrix: singular, it projects space onto a plane or less");
    const glm::dvec4 low_z = depth == DepthRange::minus_one_to_one ? w + z : z;
    const glm::dvec4 high_z = w - z;
    const bool reversed = depth == DepthRange::reversed_zero_to_one;
    Frustum frustum;
    frustum.origin = origin;
    for (const glm::dvec4& half_space :
         {w + x, w - x, w + y, w - y, reversed ? high_z : low_z, reversed ? low_z : high_z}) {
        const double size = glm::length(glm::dvec3(half_space));
        // A plane at infinity: 0·x + offset ≥ 0, up to the rounding of the row sums.
        const double rounding = 4e-16 * (glm::length(glm::dvec3(w)) + glm::length(glm::dvec3(z)));
        if (size <= rounding) {
            if (half_space.w <= 0.0) return fail(ErrorCode::empty, kNoItem, "view matrix: the view volume is empty");
            continue;
        }
        add(frustum, glm::dvec3(half_space), half_space.w);
    }
    return frustum;
}

Result<std::array<glm::dvec3, 8>> frustum_corners(const Frustum& frustum) {
    if (frustum.plane_count != 6)
        return fail(ErrorCode::invalid_argument, kNoItem, "frustum: corners need a camera's six planes");
    const auto& p = frustum.planes;
    std::array<glm::dvec3, 8> result;
    for (unsigned i = 0; i < 8; ++i) result[i] = meet(p[i & 1u], p[2 + ((i >> 1) & 1u)], p[4 + ((i >> 2) & 1u)]);
    for (std::size_t i = 0; i < 8; ++i)
        if (!std::isfinite(result[i].x + result[i].y + result[i].z))
            return fail(ErrorCode::degenerate, i, "frustum: two planes that should meet are parallel");
    return result;
}

}  // namespace crofton
