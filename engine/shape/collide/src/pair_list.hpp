// SPDX-License-Identifier: MIT
// Turns the pairs that were found into a sorted list.
#pragma once
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/memory.hpp>
#include <span>

namespace crofton::collide {

// A counting sort by the first item, then a small sort of each item's partners. Use: begin, count each part, place, add
// each part, finish.
class PairList {
  public:
    void begin(std::size_t item_count);
    // Requires first[i] < second[i].
    void count(std::span<const std::uint32_t> first);
    void place(Vector<IdPair>& sorted);
    void add(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second, Vector<IdPair>& sorted);
    void finish(Vector<IdPair>& sorted) const;
    void release() { *this = {}; }  // gives back all memory

  private:
    Vector<std::uint32_t> place_;  // by item: how many, then where the next goes
};

// Merges two sorted lists: what is only in `now`, and only in `before`.
void compare_pairs(std::span<const IdPair> before, std::span<const IdPair> now, Vector<IdPair>& began,
                   Vector<IdPair>& ended);

}  // namespace crofton::collide
