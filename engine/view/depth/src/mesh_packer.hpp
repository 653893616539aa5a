// SPDX-License-Identifier: MIT
// Writes the lists of a mesh's clusters into one block.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>
#include <span>

namespace crofton::depth {

class MeshPacker {
  public:
    // A cluster of `vertices` vertices; three corners for each of its triangles.
    void add(const ClusteredMesh::PackedBox& box, std::span<const std::uint8_t> corners, std::uint32_t vertices);
    void pack(ClusteredMesh& mesh) const;

    // As they are stored. False if the counts tell of another number of corner words.
    static bool set_lists(ClusteredMesh& mesh, std::span<const std::uint32_t> words,
                          std::span<const ClusteredMesh::PackedBox> boxes, std::span<const std::uint8_t> counts);
    // True if two of the triangles have an edge in the same direction, or one has equal corners.
    static bool has_twins(std::span<const std::uint8_t> corners);
    static void set_twins(ClusteredMesh::PackedBox& box, bool twins) {
        box.words[4] = (box.words[4] & 0x00ffffff) | std::uint32_t{twins} << 24;
    }

  private:
    Vector<ClusteredMesh::PackedBox> boxes_;
    Vector<std::uint8_t> corners_, triangles_, bits_;
};

}  // namespace crofton::depth
