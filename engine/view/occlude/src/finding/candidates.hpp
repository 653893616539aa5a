// SPDX-License-Identifier: MIT
// Finds candidates for occluders of a mesh: bodies in its closed pieces, flat parts of its surface.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/occlude/occluder.hpp>

#include "finding/inscribed_box.hpp"
#include "finding/pieces.hpp"

namespace crofton::occlude {

// Data for all searches.
struct Search {
    const PieceMesh& mesh;
    const FindOptions& options;
    double least_shadow;  // what throws a smaller mean shadow is of no use
    double size;          // of the mesh: the diagonal of its bounds
};

// Appends the piece itself if it is convex and closed, with few triangles, and returns whether it is.
bool add_convex_piece(const Search& search, const Piece& piece, Vector<FoundOccluder>& found);

// Appends boxes in a closed piece, the best first.
void add_boxes(const Search& search, const Piece& piece, Vector<FoundOccluder>& found);

// Appends the box behind the mesh's largest axis-aligned walls, if at least four of its sides are walled.
void add_walled_box(const Search& search, Vector<FoundOccluder>& found);

// Appends patches of the whole mesh, each of triangles that belong to no other.
void add_patches(const Search& search, Vector<FoundOccluder>& found);

// Appends all triangles as surfaces of up to level_triangles, cut to each other where they meet.
void add_level_surfaces(const Search& search, Vector<FoundOccluder>& found);

[[nodiscard]] bool is_closed(const Piece& piece, Sides sides);
[[nodiscard]] bool is_inside(const Search& search, const Piece& piece, const glm::dvec3& point);
[[nodiscard]] Aabb bounds_of(const PieceMesh& mesh, const Piece& piece);
[[nodiscard]] TriangleMesh surface_of(const StoredBox& box);
// The triangles with the vertices they use.
[[nodiscard]] TriangleMesh part_of(const PieceMesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace crofton::occlude
