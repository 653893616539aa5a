// SPDX-License-Identifier: MIT
// Numbers for pairs of values, the same number for the same pair.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>

namespace crofton::triangulate {

// A hash table with linear probing; numbers count up from 0. Keeps its memory when cleared.
class PairTable {
  public:
    static constexpr std::uint32_t kNew = ~std::uint32_t{0};

    void clear() {
        entries_.assign(entries_.size(), {});
        count_ = 0;
    }
    [[nodiscard]] std::uint32_t number(std::uint64_t a, std::uint64_t b) {
        if (4 * count_ >= 3 * entries_.size()) grow();
        Entry& entry = find(a, b);
        if (entry.number == kNew) entry = {a, b, count_++};
        return entry.number;
    }

    // kNew if it has none.
    [[nodiscard]] std::uint32_t find_number(std::uint64_t a, std::uint64_t b) {
        return entries_.empty() ? kNew : find(a, b).number;
    }

  private:
    struct Entry {
        std::uint64_t a = 0, b = 0;
        std::uint32_t number = kNew;
    };

    [[nodiscard]] Entry& find(std::uint64_t a, std::uint64_t b) {
        // The finaliser of MurmurHash3.
        std::uint64_t h = a * 0x9E3779B97F4A7C15ull + b;
        h = (h ^ h >> 33) * 0xFF51AFD7ED558CCDull;
        h = (h ^ h >> 33) * 0xC4CEB9FE1A85EC53ull;
        const std::size_t mask = entries_.size() - 1;
        std::size_t at = static_cast<std::size_t>(h ^ h >> 33) & mask;
        while (entries_[at].number != kNew && (entries_[at].a != a || entries_[at].b != b)) at = (at + 1) & mask;
        return entries_[at];
    }
    void grow() {
        Vector<Entry> old(entries_.size() < 32 ? 64 : 2 * entries_.size());
        old.swap(entries_);
        for (const Entry& entry : old)
            if (entry.number != kNew) find(entry.a, entry.b) = entry;
    }

    Vector<Entry> entries_;  // a power of two of them
    std::uint32_t count_ = 0;
};

}  // namespace crofton::triangulate
