// SPDX-License-Identifier: MIT
// Surfaces to ask shapes about: soups, floors of many triangles, fields of heights.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <functional>
#include <vector>

#include "random_shapes.hpp"

namespace crofton::testing {

struct Surface {
    TriangleMesh mesh;
    mesh::MeshTree tree;

    [[nodiscard]] std::size_t size() const { return mesh.indices.size() / 3; }
    [[nodiscard]] convex::Shape triangle(std::size_t i) const {
        const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[3 * i + k]]; };
        return convex::Shape::triangle(corner(0), corner(1), corner(2)).value();
    }
    [[nodiscard]] convex::Shape shape(convex::Sides sides = convex::Sides::both) const {
        return convex::Shape::mesh(tree, sides).value();
    }
    void build() { tree = mesh::MeshTree::build(mesh).value(); }
};

// Triangles that share nothing.
inline Surface soup(RandomShapes& random, int count, double extent, double size) {
    Surface s;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 at = extent * glm::dvec3(random.number(-1, 1), random.number(-1, 1), random.number(-1, 1));
        for (int k = 0; k < 3; ++k) {
            s.mesh.positions.emplace_back(at + size * random.direction());
            s.mesh.indices.push_back(static_cast<std::uint32_t>(3 * i + k));
        }
    }
    s.build();
    return s;
}

// n × n oblong cells around the origin, with corners moved along the plane; height(x, z).
inline Surface ground(RandomShapes& random, int n, double cell, const std::function<double(double, double)>& height,
                      double jitter = 0.3) {
    Surface s;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const glm::vec3 p(glm::dvec3(cell * (i - 0.5 * n + jitter * random.number(-1, 1)), 0.0,
                                         cell * (j - 0.5 * n + jitter * random.number(-1, 1))));
            s.mesh.positions.emplace_back(p.x, static_cast<float>(height(double(p.x), double(p.z))), p.z);
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto at = [&](int x, int z) { return static_cast<std::uint32_t>((j + z) * (n + 1) + i + x); };
            const std::uint32_t cells[2][6] = {{at(0, 0), at(0, 1), at(1, 0), at(1, 1), at(1, 0), at(0, 1)},
                                               {at(0, 0), at(0, 1), at(1, 1), at(1, 1), at(1, 0), at(0, 0)}};
            for (const std::uint32_t index : cells[random.index(2)]) s.mesh.indices.push_back(index);
        }
    s.build();
    return s;
}

// Triangles among a few vertices: edges and vertices are shared by many.
inline Surface tangle(RandomShapes& random, int vertices, int count) {
    Surface s;
    for (int i = 0; i < vertices; ++i) s.mesh.positions.emplace_back(random.direction());
    while (s.mesh.indices.size() < 3 * static_cast<std::size_t>(count)) {
        const int i = random.index(vertices), j = random.index(vertices), k = random.index(vertices);
        if (i == j || j == k || k == i) continue;
        for (const int v : {i, j, k}) s.mesh.indices.push_back(static_cast<std::uint32_t>(v));
    }
    s.build();
    return s;
}

// b's pose next to one of the triangles, `gap` from it along a random direction.
inline RigidTransform next_to(RandomShapes& random, const Surface& s, const RigidTransform& pose,
                              const convex::Shape& b, double gap) {
    const convex::Shape triangle = s.triangle(static_cast<std::size_t>(random.index(static_cast<int>(s.size()))));
    const glm::dvec3 d = random.direction();
    const RigidTransform turned{random.rotation(), {}};
    const glm::dvec3 from =
        pose.translation + pose.rotation * convex::support_point(triangle, glm::transpose(pose.rotation) * d);
    const glm::dvec3 own = turned.rotation * convex::support_point(b, glm::transpose(turned.rotation) * -d);
    return {turned.rotation, from - own + gap * d};
}

inline convex::Shape any_shape(RandomShapes& random, double size = 1.0) {
    const float r = static_cast<float>(size * random.number(0.2, 1)),
                h = static_cast<float>(size * random.number(0.2, 1));
    switch (random.index(7)) {
        case 0:
            return convex::Shape::sphere(r).value();
        case 1:
            return convex::Shape::capsule(h, 0.5f * r).value();
        case 2:
            return convex::Shape::cylinder(h, r).value();
        case 3:
            return convex::Shape::cone(h, r).value();
        case 4:
            return convex::Shape::rounded(random.box(size), 0.1f * r).value();
        default:
            return random.polytope(24, size);
    }
}

}  // namespace crofton::testing
