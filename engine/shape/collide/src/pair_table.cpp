// SPDX-License-Identifier: MIT
#include "pair_table.hpp"

namespace crofton::collide {
namespace {

std::size_t with_room(std::size_t size) {
    return size + size / 16 + 64;
}

}  // namespace

void PairTable::assign(std::size_t item_count, std::span<const IdPair> pairs) {
    entries_.clear();
    entries_.reserve(with_room(pairs.size()));
    first_.clear();
    first_.reserve(with_room(item_count));
    first_.resize(item_count, kNone);
    free_ = kNone;
    size_ = 0;
    for (const IdPair& pair : pairs) add(pair);
}

void PairTable::resize(std::size_t item_count) {
    if (item_count > first_.size())
        first_.append(item_count - first_.size(), kNone);
    else if (item_count < first_.size())
        first_.resize(item_count);
}

void PairTable::add(const IdPair& pair) {
    std::uint32_t entry = free_;
    if (entry == kNone) {
        entry = static_cast<std::uint32_t>(entries_.size());
        entries_.append(Entry());
    } else {
        free_ = entries_[entry].next[0];
    }
    Entry& added = entries_.edit(entry);
    const std::uint32_t items[2] = {pair.first, pair.second};
    for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t next = first_[items[side]];
        added.item[side] = items[side];
        added.next[side] = next;
        added.previous[side] = kNone;
        if (next != kNone) entries_.edit(next / 2).previous[next % 2] = 2 * entry + side;
        first_.set(items[side], 2 * entry + side);
    }
    ++size_;
}

void PairTable::remove(std::uint32_t entry) {
    Entry& removed = entries_.edit(entry);
    for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t next = removed.next[side], previous = removed.previous[side];
        if (next != kNone) entries_.edit(next / 2).previous[next % 2] = previous;
        if (previous != kNone)
            entries_.edit(previous / 2).next[previous % 2] = next;
        else
            first_.set(removed.item[side], next);
    }
    removed.next[0] = free_;
    free_ = entry;
    --size_;
}

}  // namespace crofton::collide
