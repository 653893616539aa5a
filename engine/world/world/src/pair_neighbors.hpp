// SPDX-License-Identifier: MIT
// Of a pair of objects that meet: which others lie beside either where they do.
#pragma once
#include <crofton/geometry/box.hpp>

#include "spatial_index.hpp"

namespace crofton::world {

// The objects beside a pair: those that meet the one, where the other is.
struct Neighbors {
    Vector<std::uint32_t> objects[2];  // beside the first, beside the second
    std::uint64_t name = 0;            // differs where the objects do, but for a chance of 2^-64
};

// Tiles of a floor need not be pairs themselves. So objects beside the first are sought among those that meet the
// second.
class PairNeighbors {
  public:
    struct Pair {
        std::uint32_t first, second;  // objects
    };
    void clear() { pairs_.clear(); }
    // In the order of first and second.
    void add(const Pair& pair) { pairs_.push_back(pair); }
    // After the last add(). The boxes of `count` objects are wider by `margin`, and by what counts as flush.
    void list(std::size_t count, const SpatialIndex& index, double margin);
    void find(const Pair& pair, Neighbors& neighbors) const;

  private:
    [[nodiscard]] std::span<const std::uint32_t> partners_of(std::uint32_t object) const {
        return {partners_.data() + first_[object], first_[object + std::size_t{1}] - first_[object]};
    }
    void find_beside(std::uint32_t own, std::uint32_t other, Vector<std::uint32_t>& objects) const;

    Vector<Pair> pairs_;
    Vector<std::uint32_t> first_, next_, partners_;  // by object: whom it meets, ascending
    Vector<Aabb> bounds_;                            // by object, of those that meet several
};

}  // namespace crofton::world
