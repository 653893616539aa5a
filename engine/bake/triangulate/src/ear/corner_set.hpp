// SPDX-License-Identifier: MIT
// A set of numbers below a bound that finds the next one quickly.
#pragma once
#include <bit>
#include <crofton/core/memory.hpp>
#include <cstdint>

namespace crofton::triangulate {

// A tree of bits, 64 to a node: a bit is set if any bit below it is. The next number is found in O(log64 n).
class CornerSet {
  public:
    static constexpr std::uint32_t kNothing = ~std::uint32_t{0};

    void reset(std::size_t count) {
        level_count_ = 0;
        std::size_t words = 0;
        do {
            begin_[level_count_++] = words;
            count = (count + 63) / 64;
            words += count;
        } while (count > 1);
        bits_.assign(words, 0);
    }
    void insert(std::uint32_t i) {
        for (int level = 0; level < level_count_; ++level, i /= 64)
            bits_[begin_[level] + i / 64] |= std::uint64_t{1} << (i % 64);
    }
    void erase(std::uint32_t i) {
        for (int level = 0; level < level_count_; ++level, i /= 64)
            if ((bits_[begin_[level] + i / 64] &= ~(std::uint64_t{1} << (i % 64))) != 0) return;
    }
    // The first at or after i, or else the first of all; kNothing if the set is empty.
    [[nodiscard]] std::uint32_t next_cyclic(std::uint32_t i) const {
        const std::uint32_t found = next(i);
        return found != kNothing || i == 0 ? found : next(0);
    }

  private:
    static constexpr int kMostLevels = 6;

    [[nodiscard]] std::uint32_t next(std::uint32_t i) const {
        for (int level = 0; level < level_count_; ++level, i = i / 64 + 1) {
            const std::size_t word = begin_[level] + i / 64;
            if (word >= (level + 1 == level_count_ ? bits_.size() : begin_[level + 1])) return kNothing;
            const std::uint64_t rest = bits_[word] & (~std::uint64_t{0} << (i % 64));
            if (rest == 0) continue;
            i = i / 64 * 64 + static_cast<std::uint32_t>(std::countr_zero(rest));
            while (level-- > 0) i = i * 64 + static_cast<std::uint32_t>(std::countr_zero(bits_[begin_[level] + i]));
            return i;
        }
        return kNothing;
    }

    Vector<std::uint64_t> bits_;
    std::size_t begin_[kMostLevels] = {};
    int level_count_ = 0;
};

}  // namespace crofton::triangulate
