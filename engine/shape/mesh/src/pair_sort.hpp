// SPDX-License-Identifier: MIT
// Sorts a few hundred pairs of triangles.
#pragma once
#include <crofton/mesh/mesh_query.hpp>
#include <span>

namespace crofton::mesh {

// Sorts by first, then second. Allocates nothing.
void sort_pairs(std::span<IdPair> pairs);
// The same of contacts, by their triangles.
void sort_by_triangles(std::span<MeshContact> contacts);

}  // namespace crofton::mesh
