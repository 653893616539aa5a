// SPDX-License-Identifier: MIT
// Meshes with insides, and what must hold of the occluders found in them.
#pragma once
#include <doctest/doctest.h>
#include <algorithm>
#include <box_mesh.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/occlude/occluder.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "oracle/inscribed_bodies.hpp"
#include "shape/mesh/meshes.hpp"

namespace crofton::testing {

inline TriangleMesh turned_inside_out(TriangleMesh mesh) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i], mesh.indices[i + 1]);
    return mesh;
}

inline int sign_of_volume(const TriangleMesh& mesh) {
    double volume = 0.0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        volume += glm::dot(vertex(mesh, t, 0), glm::cross(vertex(mesh, t, 1), vertex(mesh, t, 2)));
    return (volume > 0.0) - (volume < 0.0);
}

// A polygon in the plane, counter-clockwise and given with its triangles, swept from z = 0 to `depth`.
inline TriangleMesh prism(const std::vector<glm::vec2>& outline, const std::vector<std::uint32_t>& triangles,
                          float depth) {
    TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(outline.size());
    for (const float z : {0.0f, depth})
        for (const glm::vec2& p : outline) mesh.positions.push_back({p.x, p.y, z});
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        for (const std::uint32_t index : {triangles[i], triangles[i + 2], triangles[i + 1], n + triangles[i],
                                          n + triangles[i + 1], n + triangles[i + 2]})
            mesh.indices.push_back(index);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        for (const std::uint32_t index : {i, j, n + j, i, n + j, n + i}) mesh.indices.push_back(index);
    }
    return mesh;
}

inline TriangleMesh l_shape() {
    return prism({{0, 0}, {10, 0}, {10, 3}, {3, 3}, {3, 8}, {0, 8}}, {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5}, 4.0f);
}

// A sphere of points in random distance around the origin, which sees them all.
inline TriangleMesh star(std::mt19937_64& random, double least, std::uint32_t around, std::uint32_t across) {
    std::uniform_real_distribution<double> distance(least, 1.0);
    TriangleMesh mesh;
    mesh.positions.push_back({0, 0, static_cast<float>(distance(random))});
    for (std::uint32_t j = 1; j < across; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double u = 2.0 * std::numbers::pi * i / around, v = std::numbers::pi * j / across,
                         r = distance(random);
            mesh.positions.push_back(
                glm::vec3(r * std::sin(v) * std::cos(u), r * std::sin(v) * std::sin(u), r * std::cos(v)));
        }
    mesh.positions.push_back({0, 0, static_cast<float>(-distance(random))});
    const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (j - 1) * around + i % around; };
    for (std::uint32_t i = 0; i < around; ++i) {
        for (const std::uint32_t index : {0u, at(i, 1), at(i + 1, 1), last, at(i + 1, across - 1), at(i, across - 1)})
            mesh.indices.push_back(index);
        for (std::uint32_t j = 1; j + 1 < across; ++j)
            for (const std::uint32_t index :
                 {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)})
                mesh.indices.push_back(index);
    }
    return mesh;
}

inline TriangleMesh sphere_mesh(std::uint32_t around, std::uint32_t across) {
    std::mt19937_64 unused;
    return star(unused, 1.0, around, across);
}

inline TriangleMesh moved(TriangleMesh mesh, const glm::dmat3& linear, const glm::dvec3& offset) {
    for (glm::vec3& p : mesh.positions) p = glm::vec3(linear * glm::dvec3(p) + offset);
    return mesh;
}

// Tetrahedra of four of a body's corners: their union is its hull.
inline std::vector<std::vector<oracle::HalfSpaceQ>> tetrahedra_of(const Vector<glm::vec3>& corner) {
    std::vector<std::vector<oracle::HalfSpaceQ>> result;
    const std::size_t n = corner.size();
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = a + 1; b < n; ++b)
            for (std::size_t c = b + 1; c < n; ++c)
                for (std::size_t d = c + 1; d < n; ++d) {
                    const oracle::Vec3q p[4] = {oracle::rational(corner[a]), oracle::rational(corner[b]),
                                                oracle::rational(corner[c]), oracle::rational(corner[d])};
                    std::vector<oracle::HalfSpaceQ> sides;
                    for (std::size_t k = 0; k < 4; ++k) {
                        const auto& o = p[(k + 1) % 4];
                        oracle::Vec3q normal =
                            oracle::cross(oracle::minus(p[(k + 2) % 4], o), oracle::minus(p[(k + 3) % 4], o));
                        const int side = sgn(oracle::dot(normal, oracle::minus(p[k], o)));
                        if (side == 0) break;
                        if (side > 0)
                            for (auto& x : normal) x = -x;
                        sides.push_back({normal, oracle::dot(normal, o)});
                    }
                    if (sides.size() == 4) result.push_back(sides);
                }
    return result;
}

// Triangles joined by edges between equal positions, of those with valid corners.
inline std::vector<TriangleMesh> pieces_by_edges(const TriangleMesh& mesh) {
    using Key = std::array<float, 3>;
    const auto key = [&](std::size_t t, std::size_t k) {
        const glm::vec3 p = mesh.positions[mesh.indices[3 * t + k]] + glm::vec3(0.0f);
        return Key{p.x, p.y, p.z};
    };
    std::map<std::pair<Key, Key>, std::vector<std::size_t>> triangles_at;
    std::vector<bool> done(mesh.triangle_count(), false);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t i = mesh.indices[3 * t + k];
            if (i >= mesh.positions.size() || !(glm::length(mesh.positions[i]) < 1e13f)) done[t] = true;
        }
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        for (std::size_t k = 0; k < 3 && !done[t]; ++k)
            if (const Key a = key(t, k), b = key(t, (k + 1) % 3); a != b) triangles_at[std::minmax(a, b)].push_back(t);
    std::vector<TriangleMesh> pieces;
    for (std::size_t seed = 0; seed < done.size(); ++seed) {
        if (done[seed]) continue;
        std::vector<std::size_t> members{seed};
        done[seed] = true;
        for (std::size_t i = 0; i < members.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                if (const auto at = triangles_at.find(std::minmax(key(members[i], k), key(members[i], (k + 1) % 3)));
                    at != triangles_at.end())
                    for (const std::size_t t : at->second)
                        if (!done[t]) {
                            done[t] = true;
                            members.push_back(t);
                        }
        TriangleMesh& piece = pieces.emplace_back();
        piece.positions = mesh.positions;
        for (const std::size_t t : members)
            piece.indices.insert(piece.indices.end(), &mesh.indices[3 * t], &mesh.indices[3 * t] + 3);
    }
    return pieces;
}

inline Aabb bounds_of_triangles(const TriangleMesh& mesh) {
    Aabb bounds;
    for (const std::uint32_t i : mesh.indices) bounds.include(glm::dvec3(mesh.positions[i]));
    return bounds;
}

inline bool may_meet(const TriangleMesh& mesh, std::size_t t, const Aabb& bounds) {
    Aabb of;
    for (std::size_t k = 0; k < 3; ++k) of.include(vertex(mesh, t, k));
    return intersects(of, bounds);
}

inline bool is_inside_by_rays(const TriangleMesh& mesh, const oracle::Vec3q& point, occlude::Sides sides,
                              std::mt19937_64& random) {
    const oracle::WindingQ winding = oracle::winding_by_rays(mesh, point, random);
    return sides == occlude::Sides::front ? winding.number > 0 : winding.odd;
}

// Neither the open box nor the open hull of its rounded corners meets a triangle of the piece; points of it are inside:
// its centre, and its surface a little inward.
inline bool is_box_inside(const TriangleMesh& piece, const occlude::FoundOccluder& found, occlude::Sides sides,
                          std::mt19937_64& random, int samples) {
    const auto body = oracle::half_spaces_of(found.box);
    const auto tetrahedra = tetrahedra_of(found.surface.positions);
    Aabb bounds = aabb_of(found.box);
    for (const glm::vec3& p : found.surface.positions) bounds.include(glm::dvec3(p));
    for (std::size_t t = 0; t < piece.triangle_count(); ++t) {
        if (!may_meet(piece, t, bounds)) continue;
        const auto triangle = oracle::rational_triangle(piece, t);
        if (oracle::meets_interior(body, triangle)) return false;
        for (const auto& tetrahedron : tetrahedra)
            if (oracle::meets_interior(tetrahedron, triangle)) return false;
    }
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int i = 0; i < samples; ++i) {
        glm::dvec3 at(any(random), any(random), any(random));
        at[i % 3] = at[i % 3] > 0.0 ? 0x1.fffffp-1 : -0x1.fffffp-1;
        oracle::Vec3q point = oracle::rational(found.box.center);
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c)
                point[static_cast<std::size_t>(c)] += oracle::Rational(i == 0 ? 0.0 : at[k]) *
                                                      oracle::Rational(double(found.box.half_extents[k])) *
                                                      oracle::Rational(double(found.box.axes[k][c]));
        if (!is_inside_by_rays(piece, point, sides, random)) return false;
    }
    return true;
}

inline void check_box(const std::vector<TriangleMesh>& pieces, const occlude::FoundOccluder& found,
                      occlude::Sides sides, std::mt19937_64& random, int samples) {
    CHECK(validate(found.box).has_value());
    CHECK(std::any_of(pieces.begin(), pieces.end(), [&](const TriangleMesh& piece) {
        const Aabb bounds = bounds_of_triangles(piece);
        return bounds.min == found.piece_bounds.min && bounds.max == found.piece_bounds.max &&
               is_box_inside(piece, found, sides, random, samples);
    }));
}

// Its triangles are the mesh's, in their orientation (or turned, for a body that is inside out and drawn from both
// sides), each at most as often.
inline void check_subset(const TriangleMesh& mesh, const occlude::FoundOccluder& found) {
    const auto key = [](const TriangleMesh& m, std::size_t t) {
        std::array<std::array<float, 3>, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 p = m.positions[m.indices[3 * t + k]] + glm::vec3(0.0f);
            corner[k] = {p.x, p.y, p.z};
        }
        std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
        return corner;
    };
    std::map<std::array<std::array<float, 3>, 3>, int> count;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        if (std::all_of(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3,
                        [&](std::uint32_t i) { return i < mesh.positions.size(); }))
            ++count[key(mesh, t)];
    for (std::size_t t = 0; t < found.surface.triangle_count(); ++t) CHECK(--count[key(found.surface, t)] >= 0);
}

inline void check_found(const TriangleMesh& mesh, const occlude::FoundOccluders& found, occlude::Sides sides,
                        std::mt19937_64& random, int samples = 20) {
    const std::vector<TriangleMesh> pieces = pieces_by_edges(mesh);
    for (const occlude::FoundOccluder& o : found.occluders) {
        CHECK(o.mean_shadow > 0.0);
        CHECK(o.edges >= 3);
        if (o.kind == occlude::OccluderKind::walled) continue;  // in no closed piece: tested by rays
        if (o.kind == occlude::OccluderKind::box)
            check_box(pieces, o, sides, random, samples);
        else
            check_subset(mesh, o);
    }
}

inline std::size_t count_of(const occlude::FoundOccluders& found, occlude::OccluderKind kind) {
    return static_cast<std::size_t>(std::count_if(found.occluders.begin(), found.occluders.end(),
                                                  [&](const occlude::FoundOccluder& o) { return o.kind == kind; }));
}

inline occlude::FoundOccluders found_in(const TriangleMesh& mesh, const occlude::FindOptions& options = {}) {
    auto found = occlude::find_occluders(mesh, options);
    REQUIRE(found.has_value());
    CHECK(found->occluders.size() <= options.max_occluders);
    CHECK(found->share() <= 1.0 + 1e-12);
    return std::move(*found);
}

}  // namespace crofton::testing
