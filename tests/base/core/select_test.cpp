// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/select.hpp>
#include <functional>
#include <random>
#include <vector>

TEST_SUITE("core/select") {
    TEST_CASE("sorting puts the n-th element at n, lesser ones to its left and greater ones to its right") {
        std::mt19937 random(7);
        for (int round = 0; round < 3000; ++round) {
            const std::size_t count = random() % (round % 10 == 0 ? 2000 : 40);
            const std::size_t values = 1 + random() % (std::size_t{1} << random() % 20);  // many are equal, or none
            std::vector<std::size_t> all(count);
            for (std::size_t& x : all) x = random() % values;
            if (round % 7 == 1) std::sort(all.begin(), all.end());
            if (round % 7 == 2) std::sort(all.begin(), all.end(), std::greater<>());
            const auto nth = static_cast<std::ptrdiff_t>(random() % (count + 1));
            std::vector<std::size_t> sorted = all;
            std::sort(sorted.begin(), sorted.end());
            crofton::detail::select(all.begin(), all.begin() + nth, all.end(), std::less<>());
            std::vector<std::size_t> left(all.begin(), all.begin() + nth), right(all.begin() + nth, all.end());
            if (!right.empty()) CHECK(right.front() == sorted[static_cast<std::size_t>(nth)]);
            std::sort(left.begin(), left.end());
            std::sort(right.begin(), right.end());
            left.insert(left.end(), right.begin(), right.end());
            CHECK(left == sorted);
        }
    }

    TEST_CASE("the time is linear for sorted, reversed, equal and organ-pipe input") {
        constexpr std::size_t kCount = 100'000;
        for (int form = 0; form < 4; ++form) {
            std::vector<std::size_t> all(kCount);
            for (std::size_t i = 0; i < kCount; ++i)
                all[i] = form == 0 ? i : form == 1 ? kCount - i : form == 2 ? 0 : std::min(i, kCount - i);
            std::size_t compared = 0;
            const auto less = [&](std::size_t a, std::size_t b) { return ++compared, a < b; };
            crofton::detail::select(all.begin(), all.begin() + kCount / 2, all.end(), less);
            CHECK(compared < 20 * kCount);
        }
    }
}
