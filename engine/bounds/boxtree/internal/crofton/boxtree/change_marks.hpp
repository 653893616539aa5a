// SPDX-License-Identifier: MIT
// Marks the lanes of a tree's leaves that have changed since the last refit, and those that had changed before it.
#pragma once
#include <crofton/boxtree/layout.hpp>
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <span>

namespace crofton::boxtree {

// Bits of lanes, by leaf. The cost follows the leaves that change, not how many there are.
class ChangeMarks {
  public:
    void reset(std::size_t leaves);  // nothing has changed
    void reserve(std::size_t leaves);
    void add_leaf();

    void mark(std::uint32_t slot) { add(slot / kWidth, 1u << slot % kWidth); }
    void mark(std::span<const std::uint32_t> slots);

    // A move writes up to so many changed boxes of a leaf into their lanes. Where more have changed, the next refit
    // writes them all.
    [[nodiscard]] bool has_few_changes(LeafId leaf) const {
        unsigned lanes = dirty_.lanes[leaf];
        for (int few = 3; few > 0; --few) lanes &= lanes - 1;
        return lanes == 0;
    }
    void list_dirty_leaves(Vector<LeafId>& leaves) const;  // ascending

    // Dirty lanes are clean, and remembered for two refits more.
    void finish_refit();
    // Changed before both of the last two refits.
    [[nodiscard]] bool moves_often(std::uint32_t slot) const {
        const unsigned lanes = last_refit_.lanes[slot / kWidth] & two_refits_ago_.lanes[slot / kWidth];
        return (lanes >> slot % kWidth & 1) != 0;
    }

  private:
    struct Marks {
        Vector<std::uint16_t> lanes;  // by leaf, one bit a lane
        Vector<LeafId> leaves;        // those with bits, in no order
        void clear();
    };
    void add(LeafId leaf, std::uint32_t lanes) {
        std::uint16_t& all = dirty_.lanes[leaf];
        if (all == 0) dirty_.leaves.push_back(leaf);
        all = static_cast<std::uint16_t>(all | lanes);
    }
    Marks dirty_, last_refit_, two_refits_ago_;
};

}  // namespace crofton::boxtree
