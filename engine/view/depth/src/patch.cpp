// SPDX-License-Identifier: MIT
#include "patch.hpp"

namespace crofton::depth {

void PatchReader::open(const ClusteredMesh& mesh, std::size_t cluster, Patch& to) {
    const ClusteredMesh::Place place = mesh.place_of(cluster);
    to.triangle_count = mesh.triangles_of(cluster);
    to.corner_bits = mesh.bits_of(cluster);
    to.corner_words = mesh.corner_words() + place.first_word + place.first_bit / 32;
    to.first_bit = place.first_bit % 32;
    to.has_twins = mesh.boxes()[cluster].has_twins();
    to.indices = to.order = nullptr;
    if (mesh.lent_indices_ == nullptr) {
        to.positions = mesh.own_->vertices.data() + mesh.own_->first_vertices[cluster];
        return;
    }
    to.positions = mesh.lent_positions_;
    to.indices = mesh.lent_indices_;
    if (mesh.own_)
        to.order = mesh.own_->order.data() + place.first_triangle;
    else
        to.indices += std::size_t{3} * place.first_triangle;
}

bool PatchReader::read_corners(const ClusteredMesh& mesh, std::size_t cluster, Patch& to) {
    open(mesh, cluster, to);
    const std::uint32_t bits = to.corner_bits, mask = (1u << bits) - 1;
    to.vertex_count = 0;
    for (std::uint32_t t = 0, at = to.first_bit; t < to.triangle_count; ++t)
        for (std::uint32_t k = 0; k < 3; ++k, at += bits) {
            const std::uint64_t two = to.corner_words[at / 32] | std::uint64_t{to.corner_words[at / 32 + 1]} << 32;
            const std::uint32_t corner = static_cast<std::uint32_t>(two >> at % 32) & mask;
            to.blocks[t / kLanes].corners[k][t % kLanes] = static_cast<std::uint8_t>(corner);
            if (corner > to.vertex_count) return false;
            to.vertex_count += corner == to.vertex_count;
        }
    return true;
}

void PatchReader::read(const ClusteredMesh& mesh, std::size_t cluster, Patch& to) {
    (void)read_corners(mesh, cluster, to);
    for (std::uint32_t t = 0, named = 0; t < to.triangle_count; ++t)
        for (std::uint32_t k = 0; k < 3; ++k) {
            if (to.corner(t, k) != named) continue;
            const glm::vec3& p = to.position_of(t, k, named);
            for (glm::length_t axis = 0; axis < 3; ++axis) to.coordinates[axis][named] = p[axis];
            ++named;
        }
}

}  // namespace crofton::depth
