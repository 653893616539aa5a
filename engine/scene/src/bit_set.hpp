// A set of small integers that is walked in ascending order.
#pragma once
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
    }

    void insert(std::size_t i) {
        words_[i >> 6] |= std::uint64_t{1} << (i & 63);
        summary_[i >> 12] |= std::uint64_t{1} << (i >> 6 & 63);
    }

    void erase(std::size_t i) { words_[i >> 6] &= ~(std::uint64_t{1} << (i & 63)); }  // the summary may lag

    [[nodiscard]] bool contains(std::size_t i) const { return (words_[i >> 6] >> (i & 63) & 1) != 0; }

    // Empties the set: visit(i) for all members ascending. It may insert members above i, which are visited too.
    template <class Visit>
    void drain(Visit visit) {
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
    }

  private:
    Vector<std::uint64_t> words_, summary_;
};

}  // namespace crofton::scene
