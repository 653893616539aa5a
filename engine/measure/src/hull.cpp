#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/predicates.hpp>
#include <crofton/measure/intrinsic_volumes.hpp>
#include <crofton/measure/planar.hpp>
#include <glm/geometric.hpp>

namespace crofton::measure {
namespace {

using Face = std::array<std::uint32_t, 3>;

// Points of a plane or a line, by their hull within it.
IntrinsicVolumes of_flat_hull(std::span<const glm::dvec3> points, const glm::dvec3& origin, const glm::dvec3& u,
                              const glm::dvec3& v) {
    Vector<glm::dvec2> flat;
    for (const glm::dvec3& p : points) flat.emplace_back(glm::dot(p - origin, u), glm::dot(p - origin, v));
    const PlanarMeasures k = of_convex_polygon(*convex_hull(flat));
    return of_flat_polygon(k.area, k.perimeter);
}

// Replaces the faces that see the point by a fan over the edge of what it sees. Signs are exact, so the surface stays
// closed.
void add_point(std::span<const glm::dvec3> points, std::uint32_t p, Vector<Face>& faces,
               Vector<std::array<std::uint32_t, 2>>& edges) {
    edges.clear();
    std::size_t kept = 0;
    for (const Face& f : faces) {
        const bool sees = orientation(points[f[0]], points[f[1]], points[f[2]], points[p]) < 0;
        if (sees)
            for (std::size_t k = 0; k < 3; ++k) edges.push_back({f[k], f[(k + 1) % 3]});
        else
            faces[kept++] = f;
    }
    if (edges.empty()) return;
    faces.resize(kept);
    std::sort(edges.begin(), edges.end());
    for (const auto& [a, b] : edges)
        if (!std::binary_search(edges.begin(), edges.end(), std::array<std::uint32_t, 2>{b, a}))
            faces.push_back({a, b, p});
}

}  // namespace

Result<IntrinsicVolumes> of_hull(std::span<const glm::dvec3> points) {
    if (points.empty()) return fail(ErrorCode::empty, kNoItem, "hull: no points");
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z))
            return fail(ErrorCode::non_finite, i, "hull: a point is NaN or infinite");
    // A first tetrahedron of far corners, so that most points are inside it at once.
    const auto farthest = [&](auto distance) {
        std::uint32_t best = 0;
        for (std::uint32_t i = 1; i < points.size(); ++i)
            if (distance(points[i]) > distance(points[best])) best = i;
        return best;
    };
    const std::uint32_t a = farthest([&](const glm::dvec3& p) { return glm::length(p - points[0]); });
    const glm::dvec3 origin = points[a];
    const std::uint32_t b = farthest([&](const glm::dvec3& p) { return glm::length(p - origin); });
    if (points[b] == origin) return IntrinsicVolumes{};
    const glm::dvec3 u = glm::normalize(points[b] - origin);
    const std::uint32_t c = farthest([&](const glm::dvec3& p) { return glm::length(glm::cross(p - origin, u)); });
    const glm::dvec3 normal = glm::cross(u, points[c] - origin);
    if (normal == glm::dvec3(0.0)) return of_segment(glm::length(points[b] - origin));
    const glm::dvec3 n = glm::normalize(normal);
    const std::uint32_t d = farthest([&](const glm::dvec3& p) { return std::abs(glm::dot(p - origin, n)); });
    const int side = orientation(points[a], points[b], points[c], points[d]);
    if (side == 0) return of_flat_hull(points, origin, u, glm::cross(n, u));

    Vector<Face> faces = {{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}};  // outward where d lies below a, b, c
    if (side < 0)
        for (Face& f : faces) std::swap(f[1], f[2]);
    Vector<std::array<std::uint32_t, 2>> edges;
    for (std::uint32_t p = 0; p < points.size(); ++p) add_point(points, p, faces, edges);
    Vector<std::uint32_t> triangles;
    for (const Face& f : faces) triangles.insert(triangles.end(), f.begin(), f.end());
    return of_polytope(points, triangles);
}

}  // namespace crofton::measure
