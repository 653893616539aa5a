// SPDX-License-Identifier: MIT
// Finds which triangles of a cluster share an edge.
#pragma once
#include <array>
#include <crofton/depth/clustered_mesh.hpp>
#include <cstdint>

#include "patch.hpp"

namespace crofton::depth {

// Numbers different keys in the order in which they come: at most as many as a cluster has corners.
template <class Key>
class SmallTable {
  public:
    void clear() { slots_.fill(kEmpty); }

    // The number of an equal key, or `next`, which the key has from now on.
    std::uint8_t number_of(const Key& key, std::uint8_t next) {
        for (std::uint32_t at = hash_of(key);; at = (at + 1) % kSlots) {
            if (slots_[at] == kEmpty) {
                slots_[at] = next;
                keys_[next] = key;
                return next;
            }
            if (keys_[slots_[at]] == key) return slots_[at];
        }
    }

  private:
    static constexpr std::uint32_t kSlots = 512;  // more than twice as many as keys
    static constexpr std::uint8_t kEmpty = 0xff;

    static std::uint32_t hash_of(const Key& key) {
        std::uint32_t hash = 0;
        for (const auto part : key) hash = (hash ^ part) * 0x9e3779b1u, hash ^= hash >> 15;
        return hash % kSlots;
    }

    std::array<std::uint8_t, kSlots> slots_;
    std::array<Key, 3 * Cluster::kMaxTriangles> keys_;
};

// Writes for each edge (corner k to k + 1) of each triangle 4 · neighbour + the neighbour's edge, or
// kNoNeighbor. Two triangles are neighbours where just these two of the cluster share the edge, in opposite
// directions.
void find_neighbors(const std::uint8_t* corners, std::uint32_t triangle_count, std::uint8_t* neighbors);

}  // namespace crofton::depth
