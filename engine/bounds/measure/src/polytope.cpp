// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/trigonometry.hpp>
#include <crofton/measure/measure.hpp>
#include <glm/geometric.hpp>

namespace crofton::measure {
namespace {

// One side of an edge: sorting brings the two sides of an edge together.
struct HalfEdge {
    std::uint32_t low, high;
    std::uint32_t triangle;
};

bool same_edge(const HalfEdge& a, const HalfEdge& b) {
    return a.low == b.low && a.high == b.high;
}

}  // namespace

Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(std::span<const glm::dvec3> vertices,
                                                       std::span<const std::uint32_t> triangles) {
    return detail::recover([&]() -> Result<IntrinsicVolumes> {
        for (std::size_t i = 0; i < vertices.size(); ++i)
            if (!std::isfinite(vertices[i].x) || !std::isfinite(vertices[i].y) || !std::isfinite(vertices[i].z))
                return fail(ErrorCode::non_finite, i, "polytope: a vertex is NaN or infinite");
        if (triangles.empty() || triangles.size() % 3 != 0)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "polytope: the number of indices is no positive multiple of three");
        for (std::size_t i = 0; i < triangles.size(); ++i)
            if (triangles[i] >= vertices.size())
                return fail(ErrorCode::out_of_range, i, "polytope: an index is out of range");

        IntrinsicVolumes result;
        Vector<glm::dvec3> normals;
        Vector<HalfEdge> edges;
        normals.reserve(triangles.size() / 3);
        edges.reserve(triangles.size());
        const glm::dvec3 origin = vertices[triangles[0]];
        for (std::size_t t = 0; t < triangles.size(); t += 3) {
            const glm::dvec3 a = vertices[triangles[t]], b = vertices[triangles[t + 1]], c = vertices[triangles[t + 2]];
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            result.area += 0.5 * glm::length(normal);
            result.volume += glm::dot(a - origin, normal) / 6.0;
            normals.push_back(normal);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t i = triangles[t + k], j = triangles[t + (k + 1) % 3];
                edges.push_back({std::min(i, j), std::max(i, j), static_cast<std::uint32_t>(t / 3)});
            }
        }
        std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
            return a.low != b.low ? a.low < b.low : (a.high != b.high ? a.high < b.high : a.triangle < b.triangle);
        });
        for (std::size_t e = 0; e < edges.size(); e += 2) {
            const bool pair = e + 1 < edges.size() && same_edge(edges[e], edges[e + 1]) &&
                              !(e + 2 < edges.size() && same_edge(edges[e], edges[e + 2]));
            if (!pair)
                return fail(ErrorCode::degenerate, edges[e].triangle,
                            "polytope: an edge is not shared by exactly two triangles");
            const glm::dvec3& m = normals[edges[e].triangle];
            const glm::dvec3& n = normals[edges[e + 1].triangle];
            const double angle = arc_tangent(glm::length(glm::cross(m, n)), glm::dot(m, n));
            result.mean_curvature += 0.5 * glm::length(vertices[edges[e].high] - vertices[edges[e].low]) * angle;
        }
        return result;
    });
}

Result<IntrinsicVolumes> intrinsic_volumes_of_polytope(const TriangleMesh& surface) {
    return detail::recover([&]() -> Result<IntrinsicVolumes> {
        Vector<glm::dvec3> vertices;
        vertices.reserve(surface.positions.size());
        for (const glm::vec3& p : surface.positions) vertices.emplace_back(p);
        return intrinsic_volumes_of_polytope(vertices, surface.indices);
    });
}

}  // namespace crofton::measure
