// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/lines/lines.hpp>
#include <cstdint>
#include <span>

#include "trace_kernels.hpp"

namespace crofton::lines::detail {

// Puts the crossings of many lines in order, line by line. Lines with equally many are sorted in turn, by a network: no
// branch depends on a crossing.
class HitOrder {
  public:
    // Appends the crossings of `count` lines, at most 2^16, to `result`. Those of a line ascend in t, backs counted
    // `tie` later; then backs come first, and lower numbers.
    void append(const StreamCrossings& found, std::size_t count, float tie, LineHits& result);

  private:
    struct Crossing {
        float t;
        std::uint32_t triangle;  // with kFront
    };
    static constexpr std::size_t kShort = 16;  // crossings: lines of more are sorted one by one

    void place(const StreamCrossings& found, std::size_t count, LineHits& result);
    template <std::size_t kCount>
    void sort_short(float tie, Hit* hits);
    template <std::size_t... kCounts>
    void sort_short(float tie, Hit* hits, std::index_sequence<kCounts...>);
    void sort_long(std::size_t line, float tie, Hit* hits);

    Vector<std::uint32_t> ends_;  // by line
    Vector<Crossing> crossings_;  // by line
    // Lines by their number of crossings, the last ones with more than kShort.
    std::array<Vector<std::uint16_t>, kShort + 2> lines_;
    std::array<std::size_t, kShort + 2> sizes_{};
};

}  // namespace crofton::lines::detail
