// SPDX-License-Identifier: MIT
// A set of small integers that can be visited in ascending order.
#pragma once
#include <algorithm>
#include <bit>
#include <crofton/core/memory.hpp>
#include <cstdint>

namespace crofton::scene {

// One bit a member, and one bit for each 64 of those: an empty stretch of 4,096 costs one step.
class BitSet {
  public:
    // Members are below this.
    void resize(std::size_t size) {
        words_.resize((size + 63) / 64);
        summary_.resize((words_.size() + 63) / 64);
        // Bits that lag name no words that are gone.
        if (words_.size() % 64 != 0) summary_.back() &= (std::uint64_t{1} << words_.size() % 64) - 1;
    }

    void insert(std::size_t i) {
        may_hold_any_ = true;
        words_[i >> 6] |= std::uint64_t{1} << (i & 63);
        summary_[i >> 12] |= std::uint64_t{1} << (i >> 6 & 63);
    }

    void erase(std::size_t i) { words_[i >> 6] &= ~(std::uint64_t{1} << (i & 63)); }  // the summary may lag

    [[nodiscard]] bool contains(std::size_t i) const { return (words_[i >> 6] >> (i & 63) & 1) != 0; }

    [[nodiscard]] std::size_t count() const {
        std::size_t result = 0;
        if (may_hold_any_)
            for (const std::uint64_t word : words_) result += static_cast<std::size_t>(std::popcount(word));
        return result;
    }

    // False only if the set is empty.
    [[nodiscard]] bool may_hold_any() const { return may_hold_any_; }

    void clear() {
        if (!may_hold_any_) return;
        std::fill(words_.begin(), words_.end(), 0);
        std::fill(summary_.begin(), summary_.end(), 0);
        may_hold_any_ = false;
    }

    // Empties the set: visit(i) for all members ascending. It may insert members above i, which are visited too.
    template <class Visit>
    void drain(Visit visit) {
        if (!may_hold_any_) return;
        for (std::size_t s = 0; s < summary_.size(); ++s)
            while (summary_[s] != 0) {
                const std::size_t w = s * 64 + static_cast<std::size_t>(std::countr_zero(summary_[s]));
                while (words_[w] != 0) {
                    const std::size_t i = w * 64 + static_cast<std::size_t>(std::countr_zero(words_[w]));
                    words_[w] &= words_[w] - 1;
                    visit(i);
                }
                summary_[s] &= ~(std::uint64_t{1} << (w & 63));
            }
        may_hold_any_ = false;
    }

  private:
    Vector<std::uint64_t> words_, summary_;
    bool may_hold_any_ = false;
};

}  // namespace crofton::scene
