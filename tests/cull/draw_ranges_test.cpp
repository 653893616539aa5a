#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/cull/draw_ranges.hpp>
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
        const std::vector<tree::ItemId> ids{62, 63, 64, 65, 128};
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

    TEST_CASE("ranges hold exactly the bits, and gaps up to the limit") {
        std::mt19937 random(1);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<tree::ItemId> ids;
            for (tree::ItemId id = 0; id < 500; ++id)
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
            for (const tree::ItemId id : ids) CHECK(covered[id]);
            if (gap == 0)
                CHECK(std::count(covered.begin(), covered.end(), 1) == static_cast<std::ptrdiff_t>(ids.size()));
        }
    }
}
