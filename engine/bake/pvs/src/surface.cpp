// SPDX-License-Identifier: MIT
#include "surface.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/geometry/cut_at_vertices.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace crofton::pvs {
namespace {

using CornerNumbers = std::array<std::uint32_t, 3>;

// Replaces equal positions by the first of them.
void weld(const TriangleMesh& mesh, Vector<glm::vec3>& positions, Vector<CornerNumbers>& triangles) {
    Vector<std::uint32_t> order(mesh.positions.size()), place(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto at = [&](std::uint32_t v) { return mesh.positions[v] + 0.0f; };  // −0 is 0
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const glm::vec3 p = at(i), q = at(j);
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    });
    for (const std::uint32_t v : order) {
        if (positions.empty() || positions.back() != at(v)) positions.push_back(at(v));
        place[v] = static_cast<std::uint32_t>(positions.size() - 1);
    }
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        triangles.push_back({place[mesh.indices[i]], place[mesh.indices[i + 1]], place[mesh.indices[i + 2]]});
}

// Grows with the angle of (x, y) from −x on, in [0, 4): no library's arctangent.
double turn(double x, double y) {
    const double sum = std::abs(x) + std::abs(y);
    if (!(sum > 0.0)) return 0.0;
    return y < 0.0 ? 1.0 + x / sum : 3.0 - x / sum;
}

struct SideOfFace {
    std::uint32_t from = 0, to = 0;  // from < to
    std::uint32_t face = 0, corner = 0;
    bool along = false;
};

void sort_around(Surface& surface, std::span<const SideOfFace> sides) {
    const glm::dvec3 a = surface.positions[sides[0].from], axis = surface.positions[sides[0].to] - a;
    const glm::dvec3 e = glm::abs(axis);
    const glm::dvec3 other = e.x <= e.y && e.x <= e.z ? glm::dvec3(1, 0, 0)
                             : e.y <= e.z             ? glm::dvec3(0, 1, 0)
                                                      : glm::dvec3(0, 0, 1);
    const glm::dvec3 x = glm::normalize(glm::cross(other, axis)), y = glm::normalize(glm::cross(axis, x));
    const auto edge = static_cast<std::uint32_t>(surface.edges.size());
    const auto first = static_cast<std::uint32_t>(surface.spokes.size());
    struct Placed {
        double turn = 0.0;
        SideOfFace side;
    };
    Vector<Placed> placed;
    for (const SideOfFace& side : sides) {
        const glm::dvec3 r = surface.positions[surface.faces[side.face].corners[(side.corner + 2) % 3]] - a;
        placed.push_back({turn(glm::dot(x, r), glm::dot(y, r)), side});
    }
    // Among coincident faces, those that are turned backwards come first, so that pairs back to back
    // enclose nothing.
    std::sort(placed.begin(), placed.end(), [](const Placed& p, const Placed& q) {
        if (p.turn != q.turn) return p.turn < q.turn;
        return p.side.along != q.side.along ? q.side.along : p.side.face < q.side.face;
    });
    for (const Placed& p : placed) {
        Surface::Face& face = surface.faces[p.side.face];
        face.edges[p.side.corner] = edge;
        face.spokes[p.side.corner] = static_cast<std::uint32_t>(surface.spokes.size());
        surface.spokes.push_back({p.side.face, p.side.along});
    }
    surface.edges.push_back({sides[0].from, sides[0].to, first, static_cast<std::uint32_t>(sides.size())});
}

}  // namespace

Surface surface_of(const TriangleMesh& mesh) {
    Surface surface;
    Vector<glm::vec3> positions;
    Vector<CornerNumbers> triangles;
    weld(mesh, positions, triangles);
    for (const glm::vec3& p : positions) surface.positions.emplace_back(p);
    for (const CornerNumbers& t : cut_at_vertices(positions, triangles)) {
        const glm::dvec3 a = surface.positions[t[0]], b = surface.positions[t[1]], c = surface.positions[t[2]];
        if (glm::cross(b - a, c - a) != glm::dvec3(0.0)) surface.faces.push_back({t, {}, {}});
    }
    Vector<SideOfFace> sides;
    for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
        const CornerNumbers& t = surface.faces[f].corners;
        Aabb box;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            sides.push_back({(std::min)(a, b), (std::max)(a, b), f, k, a < b});
            box.include(surface.positions[a]);
        }
        surface.bounds.push_back(box);
    }
    std::sort(sides.begin(), sides.end(), [](const SideOfFace& s, const SideOfFace& t) {
        return s.from != t.from ? s.from < t.from : s.to != t.to ? s.to < t.to : s.face < t.face;
    });
    for (std::size_t begin = 0; begin < sides.size();) {
        std::size_t end = begin + 1;
        while (end < sides.size() && sides[end].from == sides[begin].from && sides[end].to == sides[begin].to) ++end;
        sort_around(surface, std::span(sides).subspan(begin, end - begin));
        begin = end;
    }
    if (!surface.faces.empty()) surface.tree.emplace(surface.bounds);
    return surface;
}

}  // namespace crofton::pvs
