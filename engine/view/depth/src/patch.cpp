// SPDX-License-Identifier: MIT
#include "patch.hpp"

#include <algorithm>
#include <array>

#include "adjacency.hpp"

namespace crofton::depth {

void PatchReader::open(const ClusteredMesh& mesh, std::size_t cluster, Patch& to) {
    const Cluster& range = mesh.clusters_[cluster];
    const std::uint32_t first = mesh.firsts_[cluster];
    to.triangle_count = range.triangle_count;
    to.vertex_count = mesh.boxes_[cluster].vertex_count();
    to.corner_words = mesh.corners_.data() + (first & ~kTwins);
    to.has_twins = (first & kTwins) != 0;
    if (mesh.lent_indices_.empty()) {
        to.indices = nullptr;
        to.positions = mesh.vertices_.data() + mesh.first_vertices_[cluster];
    } else {
        to.indices = mesh.lent_indices_.data() + std::size_t{3} * range.first_triangle;
        to.positions = mesh.lent_positions_.data();
    }
}

bool PatchReader::read(const ClusteredMesh& mesh, std::size_t cluster, Patch& to) {
    open(mesh, cluster, to);
    const std::uint32_t bits = bits_for(to.vertex_count), mask = (1u << bits) - 1;
    std::uint32_t named = 0;
    for (std::uint32_t t = 0, at = 0; t < to.triangle_count; ++t)
        for (std::uint32_t k = 0; k < 3; ++k, at += bits) {
            const std::uint64_t two = to.corner_words[at / 32] | std::uint64_t{to.corner_words[at / 32 + 1]} << 32;
            const std::uint32_t corner = static_cast<std::uint32_t>(two >> at % 32) & mask;
            to.blocks[t / kLanes].corners[k][t % kLanes] = static_cast<std::uint8_t>(corner);
            if (corner > named || corner >= to.vertex_count) return false;
            if (corner < named) continue;
            const glm::vec3& p = to.positions[to.indices != nullptr ? to.indices[3 * t + k] : corner];
            for (glm::length_t axis = 0; axis < 3; ++axis) to.coordinates[axis][named] = p[axis];
            ++named;
        }
    return named == to.vertex_count;
}

void PatchReader::note_twins(ClusteredMesh& mesh, std::size_t cluster, const Patch& read) {
    SmallTable<std::array<std::uint8_t, 2>> edges;
    edges.clear();
    std::uint8_t count = 0;
    bool twins = false;
    for (std::uint32_t t = 0; t < read.triangle_count; ++t)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = read.corner(t, k), to = read.corner(t, k == 2 ? 0 : k + 1);
            const std::array key{static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(to)};
            if (from == to || edges.number_of(key, count) != count)
                twins = true;
            else
                ++count;
        }
    if (twins) mesh.firsts_[cluster] |= kTwins;
}

}  // namespace crofton::depth
