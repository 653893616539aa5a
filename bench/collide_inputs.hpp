// SPDX-License-Identifier: MIT
// What Crofton and the peers are measured on: the same boxes, meshes and poses for all.
#pragma once
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <string>
#include <vector>

namespace crofton::bench {

struct BoxPairs {
    std::vector<Obb> a, b;
};
// Random frames and sizes; the spread of the centres makes about 30 % of the pairs meet.
[[nodiscard]] BoxPairs random_pairs(std::size_t count);

// Neighbours in stacks: the same random frame but for rounding to float, face on face but for rounding.
[[nodiscard]] BoxPairs stacked_pairs(std::size_t count);

// Upright neighbours on a grid, of sizes that floats hold exactly, face on face with no gap at all.
[[nodiscard]] BoxPairs grid_pairs(std::size_t count);

// Boxes of random frames in a cube so large that a box meets, by its axis-aligned bound, about 1.2 pairs' worth of
// others.
[[nodiscard]] std::vector<Obb> crowd(std::size_t count);
// Every box moves by a few per cent of its size and turns a little; `frame` picks the direction.
void move(std::vector<Obb>& boxes, int frame);

// A mesh of the shared data, or nothing where that is absent. Polygons are cut into fans.
[[nodiscard]] TriangleMesh shared_mesh(const std::string& name);

// From a sphere around the mesh to points within its bound.
[[nodiscard]] std::vector<Ray> random_rays(const TriangleMesh& mesh, std::size_t count);

// Poses of a mesh relative to a copy of itself: random rotation and direction, moved from first contact by −5 to +2 %
// of the mesh's size.
[[nodiscard]] std::vector<RigidTransform> close_poses(const mesh::MeshTree& tree, std::size_t count);

}  // namespace crofton::bench
