// SPDX-License-Identifier: MIT
// Small scenes with known answers.
#pragma once
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace shapes {

// A mesh with a patch number for each triangle.
struct Shape {
    crofton::TriangleMesh mesh;
    std::vector<std::uint32_t> patches;

    void triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t patch) {
        for (const glm::vec3& p : {a, b, c}) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(p);
        }
        patches.push_back(patch);
    }
    // Counter-clockwise seen from its front.
    void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, std::uint32_t patch) {
        triangle(a, b, c, patch);
        triangle(a, c, d, patch);
    }
    // corner + s·u + t·v for s, t in [0, 1]; front toward cross(u, v).
    void parallelogram(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, std::uint32_t patch) {
        quad(corner, corner + u, corner + u + v, corner + v, patch);
    }
    // Six patches first, … first + 5 that look into the box: x low, x high, y low, y high, z low, z high.
    void room(const glm::vec3& low, const glm::vec3& high, std::uint32_t first) {
        const glm::vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
        parallelogram(low, y, z, first);
        parallelogram(low + x, z, y, first + 1);
        parallelogram(low, z, x, first + 2);
        parallelogram(low + y, x, z, first + 3);
        parallelogram(low, x, y, first + 4);
        parallelogram(low + z, y, x, first + 5);
    }
    // A sphere of rings × 2·rings quads; `inward` turns its front to the centre.
    void sphere(const glm::vec3& center, float radius, int rings, bool inward, std::uint32_t patch) {
        const auto at = [&](int i, int j) {
            const double a = std::numbers::pi * i / rings, b = std::numbers::pi * j / rings;
            return center + radius * glm::vec3(static_cast<float>(std::sin(a) * std::cos(b)),
                                               static_cast<float>(std::cos(a)),
                                               static_cast<float>(std::sin(a) * std::sin(b)));
        };
        for (int i = 0; i < rings; ++i)
            for (int j = 0; j < 2 * rings; ++j) {
                const glm::vec3 p[4] = {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)};
                const auto add = [&](int a, int b, int c) {
                    if (inward)
                        triangle(p[a], p[c], p[b], patch);
                    else
                        triangle(p[a], p[b], p[c], patch);
                };
                if (i > 0) add(0, 1, 2);
                if (i + 1 < rings) add(0, 2, 3);
            }
    }
};

// Triangles of about `size`, their middles in [-1, 1]³.
inline crofton::TriangleMesh soup(int triangles, float size, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    const auto vector = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    crofton::TriangleMesh mesh;
    for (int t = 0; t < triangles; ++t) {
        const glm::vec3 center = vector();
        for (int k = 0; k < 3; ++k) {
            mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(center + size * vector());
        }
    }
    return mesh;
}

// Edges used by one triangle only, as position pairs: a T-junction leaves unmatched ones inside a closed surface.
inline std::size_t unmatched_edges(const crofton::TriangleMesh& mesh) {
    using Point = std::tuple<float, float, float>;
    std::map<std::pair<Point, Point>, int> edges;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
        for (std::size_t e = 0; e < 3; ++e) {
            const glm::vec3 &a = mesh.positions[mesh.indices[3 * t + e]],
                            &b = mesh.positions[mesh.indices[3 * t + (e + 1) % 3]];
            const Point p(a.x, a.y, a.z), q(b.x, b.y, b.z);
            p < q ? ++edges[{p, q}] : --edges[{q, p}];
        }
    std::size_t count = 0;
    for (const auto& [edge, balance] : edges) count += balance != 0 ? 1u : 0u;
    return count;
}

}  // namespace shapes
