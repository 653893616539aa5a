// SPDX-License-Identifier: MIT
// Pairs of items, stored by item, so that the pairs of a moving item are at hand.
#pragma once
#include <hwy/cache_control.h>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/growing_vector.hpp>
#include <cstdint>
#include <span>

namespace crofton::collide {

// Each pair is in two lists, which go through the table: one for each of its items. Adding and removing a pair costs
// the same however many there are.
class PairTable {
  public:
    // These pairs alone, of items below `item_count`. Takes memory for some more.
    void assign(std::size_t item_count, std::span<const IdPair> pairs);
    // New items have no pairs. Requires that those that fall away have none.
    void resize(std::size_t item_count);
    void reserve(std::size_t item_count) { first_.reserve_pages(item_count); }
    [[nodiscard]] std::size_t size() const { return size_; }

    void add(const IdPair& pair);
    void remove(std::uint32_t entry);
    // Goes on copying arrays that grow.
    void settle() {
        entries_.settle();
        first_.settle();
    }
    // Calls visit(partner, entry) for each pair of an item, in no order. The table must not change meanwhile.
    template <class Visit>
    void visit(std::uint32_t item, Visit visit) const {
        for (std::uint32_t link = first_[item]; link != kNone; link = entries_[link / 2].next[link % 2])
            visit(entries_[link / 2].item[1 - link % 2], link / 2);
    }
    // Asks the memory for what visit() of the item needs.
    void fetch_first(std::uint32_t item) const { hwy::Prefetch(&first_[item]); }
    void fetch_entry(std::uint32_t item) const {
        if (first_[item] != kNone) hwy::Prefetch(&entries_[first_[item] / 2]);
    }

  private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    // A link is twice an entry, and 1 more for its second item.
    struct Entry {
        std::uint32_t item[2], next[2], previous[2];
    };
    GrowingVector<Entry> entries_;
    GrowingVector<std::uint32_t> first_;  // by item: a link
    std::uint32_t free_ = kNone;          // entries, through next[0]
    std::size_t size_ = 0;
};

}  // namespace crofton::collide
