// SPDX-License-Identifier: MIT
// Validates flat polygons with holes, and joins their triangles into a mesh.
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/finite.hpp>
#include <crofton/scene/scene.hpp>
#include <glm/geometric.hpp>
#include <string>

namespace crofton::scene {
Result<void> validate(const PlanarPolygon& polygon) {
    const auto& points = polygon.polygon.points;
    const auto& ends = polygon.polygon.ring_ends;
    if (points.empty() || ends.empty()) return fail(ErrorCode::empty, kNoItem, "polygon: it has no points");
    std::uint32_t begin = 0;
    for (std::size_t r = 0; r < ends.size(); ++r) {
        if (ends[r] > points.size())
            return fail(ErrorCode::out_of_range, r, {"polygon: ring ", r, " ends beyond the points"});
        if (ends[r] < begin + 3 || ends[r] < begin)
            return fail(ErrorCode::degenerate, r, {"polygon: ring ", r, " has fewer than three points"});
        begin = ends[r];
    }
    if (begin != points.size())
        return fail(ErrorCode::invalid_argument, begin, {"polygon: point ", begin, " is in no ring"});
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y))
            return fail(ErrorCode::non_finite, i, {"polygon: point ", i, " is NaN or infinite"});
    if (!is_finite(polygon.origin) || !is_finite(polygon.u) || !is_finite(polygon.v) ||
        !is_finite(glm::dvec3(polygon.color)))
        return fail(ErrorCode::non_finite, kNoItem, "polygon: its origin, an axis or its colour is NaN or infinite");
    if (!(glm::length(glm::cross(polygon.u, polygon.v)) > 1e-9 * glm::length(polygon.u) * glm::length(polygon.v)))
        return fail(ErrorCode::degenerate, kNoItem, "polygon: its axes are parallel or zero");
    return {};
}

Result<TriangleMesh> to_mesh(const PlanarPolygon& polygon, std::span<const std::array<std::uint32_t, 3>> triangles) {
    return detail::recover([&]() -> Result<TriangleMesh> {
        if (auto valid = validate(polygon); !valid) return valid.error();
        TriangleMesh mesh;
        mesh.positions.reserve(polygon.polygon.points.size());
        for (const glm::dvec2& p : polygon.polygon.points)
            mesh.positions.emplace_back(polygon.origin + p.x * polygon.u + p.y * polygon.v);
        mesh.colors.assign(mesh.positions.size(), polygon.color);
        mesh.indices.reserve(3 * triangles.size());
        for (const auto& triangle : triangles)
            mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
        if (auto valid = crofton::validate(mesh); !valid) return valid.error();
        return mesh;
    });
}

}  // namespace crofton::scene
