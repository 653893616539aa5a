// SPDX-License-Identifier: MIT
// Closed meshes with known insides, and poses for them.
#pragma once
#include <doctest/doctest.h>
#include <box_mesh.hpp>
#include <cmath>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <numbers>
#include <utility>

#include "shape/collide/random_boxes.hpp"

namespace crofton::testing {

// A torus around z with a wavy tube, or a sphere where ring = 0: closed, counter-clockwise from outside.
inline TriangleMesh wavy_torus(double ring, double tube, double wave, std::uint32_t around = 24,
                               std::uint32_t across = 12) {
    TriangleMesh mesh;
    const double turn = 2.0 * std::numbers::pi;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double u = turn * i / around, v = turn * j / across;
            const double r = tube * (1.0 + wave * std::sin(3.0 * u + 2.0 * v));
            const double x = ring + r * std::cos(v);
            mesh.positions.push_back(glm::vec3(x * std::cos(u), x * std::sin(u), r * std::sin(v)));
        }
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t a = i * across + j, b = (i + 1) % around * across + j;
            const std::uint32_t c = (i + 1) % around * across + (j + 1) % across, d = i * across + (j + 1) % across;
            for (const std::uint32_t index : {a, b, c, a, c, d}) mesh.indices.push_back(index);
        }
    return mesh;
}

inline RigidTransform random_pose(std::mt19937_64& random, double distance) {
    return {glm::mat3_cast(random_rotation(random)), distance * random_vector(random)};
}

inline glm::dvec3 vertex(const TriangleMesh& mesh, std::size_t triangle, std::size_t v) {
    return glm::dvec3(mesh.positions[mesh.indices[3 * triangle + v]]);
}

inline mesh::MeshTree tree_of(const TriangleMesh& mesh) {
    return mesh::MeshTree::build(mesh).value();
}

inline Triangle triangle(const TriangleMesh& mesh, std::size_t t, const RigidTransform& pose) {
    return {transform(pose, vertex(mesh, t, 0)), transform(pose, vertex(mesh, t, 1)),
            transform(pose, vertex(mesh, t, 2))};
}

}  // namespace crofton::testing
