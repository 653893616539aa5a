// SPDX-License-Identifier: MIT
// Ranks a few floats without branches.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace crofton::detail {

// Finds how many of the first `Count` values come before each of them; equal ones keep their order. Those behind, if
// any, are infinite. No branch depends on the values, so that the loops become vectors.
template <std::size_t Count, std::size_t Padded>
void rank(const float (&values)[Padded], std::int32_t (&ranks)[Padded]) {
    constexpr std::size_t kEven = Count + Count % 2;  // compared two at a time
    static_assert(kEven <= Padded);
    std::fill_n(ranks, Padded, 0);
    for (std::size_t m = 0; m < kEven; ++m)
        for (std::size_t n = 0; n < Padded; ++n) ranks[n] += static_cast<std::int32_t>(values[m] < values[n]);
    std::int32_t sum = 0;
    for (std::size_t n = 0; n < Count; ++n) sum += ranks[n];
    const bool has_equal = sum != static_cast<std::int32_t>(Count * (Count - 1) / 2);
    for (std::size_t m = 0; has_equal && m < Count; ++m)
        for (std::size_t n = m + 1; n < Count; ++n) ranks[n] += static_cast<std::int32_t>(values[m] == values[n]);
}

}  // namespace crofton::detail
