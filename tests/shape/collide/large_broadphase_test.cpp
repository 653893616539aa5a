// SPDX-License-Identifier: MIT
// So many boxes that the broadphase's tree has three levels above its leaves, and four.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/executor.hpp>
#include <random>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;
using namespace crofton::collide;

TEST_SUITE("collide/broadphase") {
    TEST_CASE("each of thousands of boxes on a grid overlaps its two neighbours in its row, in any order") {
        std::mt19937_64 random(60);
        for (const std::uint32_t n : {17u, 27u, 41u}) {
            std::vector<std::uint32_t> id(n * n * n);
            for (std::uint32_t i = 0; i < id.size(); ++i) id[i] = i;
            std::shuffle(id.begin(), id.end(), random);
            std::vector<Obb> boxes(id.size());
            std::vector<IdPair> expected;
            for (std::uint32_t i = 0; i < id.size(); ++i) {
                Obb& box = boxes[id[i]];
                box.center = glm::dvec3(i % n, i / n % n, i / n / n);
                box.half_extents = {0.5f + 0x1p-10f, 0.4f, 0.4f};
                if (i % n > 0) expected.push_back({std::min(id[i - 1], id[i]), std::max(id[i - 1], id[i])});
            }
            std::sort(expected.begin(), expected.end());
            Broadphase broadphase;
            REQUIRE(broadphase.update(boxes).has_value());
            CAPTURE(n);
            CHECK(test::ranges::equal(broadphase.pairs(), expected));
            // Back and forth: with every second column elsewhere none meets another.
            for (const double aside : {10.0 * n, -10.0 * n}) {
                for (std::uint32_t i = 0; i < id.size(); ++i)
                    if (i % n % 2 != 0) boxes[id[i]].center.z += aside;
                REQUIRE(broadphase.update(boxes).has_value());
                const bool parted = aside > 0.0;
                CHECK(broadphase.pairs().size() == (parted ? 0 : expected.size()));
                CHECK(test::ranges::equal(parted ? broadphase.ended() : broadphase.began(), expected));
            }
            // Few that move away and come back, named.
            std::vector<std::uint32_t> moved;
            std::vector<bool> is_away(id.size(), false);
            for (std::uint32_t i = 5; i < id.size(); i += 97) moved.push_back(i), is_away[i] = true;
            std::vector<IdPair> lost;
            for (const IdPair& pair : expected)
                if (is_away[pair.first] != is_away[pair.second]) lost.push_back(pair);
            for (const double aside : {10.0 * n, -10.0 * n}) {
                for (const std::uint32_t i : moved) boxes[i].center.z += aside;
                REQUIRE(broadphase.update_moved(boxes, moved).has_value());
                const bool away = aside > 0.0;
                CHECK(broadphase.pairs().size() == expected.size() - (away ? lost.size() : 0));
                CHECK(test::ranges::equal(away ? broadphase.ended() : broadphase.began(), lost));
            }
        }
    }
}
