// SPDX-License-Identifier: MIT
// Disjoint sets of the numbers below a count, each represented by its lowest number.
#pragma once
#include <algorithm>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <numeric>

namespace crofton {

// Halves paths on the way (Tarjan, van Leeuwen 1984).
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    [[nodiscard]] std::uint32_t find(std::uint32_t item) {
        while (parent_[item] != item) {
            parent_[item] = parent_[parent_[item]];
            item = parent_[item];
        }
        return item;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    Vector<std::uint32_t> parent_;
};

}  // namespace crofton
