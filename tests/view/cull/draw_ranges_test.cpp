// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <hwy/targets.h>
#include <algorithm>
#include <crofton/cull/cull.hpp>
#include <numeric>
#include <random>
#include <vector>

using namespace crofton;

TEST_SUITE("cull/draw_ranges") {
    TEST_CASE("no bits, all bits, and bits across the borders of words") {
        Vector<std::uint64_t> bits;
        Vector<cull::ItemRange> ranges;
        cull::merge_ranges(bits, 0, ranges);
        CHECK(ranges.empty());
        bits.assign(3, ~std::uint64_t{0});
        cull::merge_ranges(bits, 0, ranges);
        REQUIRE(ranges.size() == 1);
        CHECK(ranges[0].count == 192);
        const std::vector<boxtree::ItemId> ids{62, 63, 64, 65, 128};
        cull::to_bits(ids, 129, bits);
        cull::merge_ranges(bits, 0, ranges);
        REQUIRE(ranges.size() == 2);
        CHECK(ranges[0].first == 62);
        CHECK(ranges[0].count == 4);
        CHECK(ranges[1].first == 128);
        cull::merge_ranges(bits, 62, ranges);
        CHECK(ranges.size() == 1);
        CHECK(ranges[0].count == 67);
    }

    TEST_CASE("ids in runs, in shuffled neighbourhoods or anywhere give the bits they name, on every instruction set") {
        std::mt19937 random(3);
        Vector<std::uint64_t> bits;
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            for (const std::size_t items : {1u, 63u, 64u, 65u, 1000u, 20000u})
                for (const std::size_t neighbourhood : {1u, 8u, 16u, 40u, 20000u}) {
                    std::vector<boxtree::ItemId> all(items);
                    std::iota(all.begin(), all.end(), 0u);
                    for (std::size_t i = 0; i < items; i += neighbourhood)
                        std::shuffle(all.begin() + std::ptrdiff_t(i),
                                     all.begin() + std::ptrdiff_t(std::min(items, i + neighbourhood)), random);
                    std::vector<boxtree::ItemId> ids;  // stretches of them
                    for (std::size_t i = 0; i < items;) {
                        const std::size_t end = std::min(items, i + 1 + random() % 100);
                        if (random() % 2)
                            ids.insert(ids.end(), all.begin() + std::ptrdiff_t(i), all.begin() + std::ptrdiff_t(end));
                        i = end;
                    }
                    cull::to_bits(ids, items, bits);
                    REQUIRE(bits.size() == (items + 63) / 64);
                    Vector<std::uint64_t> expected(bits.size(), 0);
                    for (const boxtree::ItemId id : ids) expected[id / 64] |= std::uint64_t{1} << (id % 64);
                    CHECK(bits == expected);
                }
        }
        hwy::SetSupportedTargetsForTest(0);
    }

    TEST_CASE("ranges hold exactly the bits, and gaps up to the limit") {
        std::mt19937 random(1);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<boxtree::ItemId> ids;
            for (boxtree::ItemId id = 0; id < 500; ++id)
                if (random() % 8 < 1u + static_cast<unsigned>(trial) % 7) ids.push_back(id);
            Vector<std::uint64_t> bits;
            Vector<cull::ItemRange> ranges;
            cull::to_bits(ids, 500, bits);
            const std::uint32_t gap = static_cast<std::uint32_t>(trial) % 3;
            cull::merge_ranges(bits, gap, ranges);
            std::vector<char> covered(500, 0);
            for (std::size_t r = 0; r < ranges.size(); ++r) {
                for (std::uint32_t i = 0; i < ranges[r].count; ++i) covered[ranges[r].first + i] = 1;
                if (r > 0) CHECK(ranges[r].first > ranges[r - 1].first + ranges[r - 1].count + gap);
            }
            for (const boxtree::ItemId id : ids) CHECK(covered[id]);
            if (gap == 0)
                CHECK(std::count(covered.begin(), covered.end(), 1) == static_cast<std::ptrdiff_t>(ids.size()));
        }
    }
}
