// SPDX-License-Identifier: MIT
// std::nth_element that leaves the same order with every standard library.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>

namespace crofton::detail {

// Puts the element that belongs at `nth` of a sorted range there, those before it to the left, those after it to the
// right. How both sides are ordered depends on the input alone. std::nth_element leaves that to the library; sums over
// them would differ in their last bits. O(n) on average for any input (Hoare 1961): pivots are medians of three,
// at places from a generator of fixed seed. `less`: a strict weak order. Random-access iterators, nth in [first, last].
template <class Iterator, class Less>
void select(Iterator first, Iterator nth, Iterator last, Less less) {
    if (nth == last) return;
    constexpr std::ptrdiff_t kFew = 12;
    std::uint64_t state = 0x9e3779b97f4a7c15u;
    while (last - first > kFew) {
        const auto any = [&] {
            state = state * 6364136223846793005u + 1442695040888963407u;
            return first + static_cast<std::ptrdiff_t>((state >> 33) % static_cast<std::uint64_t>(last - first));
        };
        Iterator a = any(), b = any(), c = any();
        if (less(*b, *a)) std::swap(a, b);
        if (less(*c, *b)) b = less(*c, *a) ? a : c;
        std::swap(*first, *b);
        // [first + 1, low) is not above the pivot, [high, last) not below it.
        Iterator low = first, high = last;
        for (;;) {
            do ++low;
            while (low != last && less(*low, *first));
            do --high;
            while (less(*first, *high));
            if (low >= high) break;
            std::swap(*low, *high);
        }
        std::swap(*first, *high);
        if (high == nth) return;
        if (nth < high)
            last = high;
        else
            first = high + 1;
    }
    for (Iterator i = first; i != last; ++i)
        for (Iterator j = i; j != first && less(*j, *(j - 1)); --j) std::swap(*j, *(j - 1));
}

}  // namespace crofton::detail
