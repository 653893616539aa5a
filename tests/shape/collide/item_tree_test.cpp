// SPDX-License-Identifier: MIT
// Of the module's own parts: the tree that the broadphase's items come into and leave.
#include <doctest/doctest.h>
#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "item_tree.hpp"

using namespace crofton::collide;

namespace {

using Items = std::map<std::uint32_t, LaneBounds>;

LaneBounds random_bounds(std::mt19937_64& random, float place, float size) {
    std::uniform_real_distribution<float> number(0.0f, 1.0f);
    LaneBounds bounds;
    for (int i = 0; i < 3; ++i) {
        bounds.low[i] = place * (2.0f * number(random) - 1.0f);
        bounds.high[i] = bounds.low[i] + size * number(random);
    }
    return bounds;
}

bool meet(const LaneBounds& a, const LaneBounds& b) {
    for (int i = 0; i < 3; ++i)
        if (a.low[i] > b.high[i] || b.low[i] > a.high[i]) return false;
    return true;
}

LaneBounds lane_of(const BoundBlock& block, std::size_t lane) {
    LaneBounds bounds;
    for (int i = 0; i < 3; ++i) bounds.low[i] = block.low[i][lane], bounds.high[i] = block.high[i][lane];
    return bounds;
}

bool are_equal(const LaneBounds& a, const LaneBounds& b) {
    return std::equal(a.low, a.low + 3, b.low) && std::equal(a.high, a.high + 3, b.high);
}

// Follows all lanes from the root: each item once, with its bounds; bounds above are the least around those below. A
// leaf may have few items: one that was added to full ones.
struct Checker {
    const BoundTree& tree;
    const Items& items;
    std::size_t found = 0, blocks = 0;
    bool good = true;

    LaneBounds follow(std::size_t level, std::uint32_t block, bool has_siblings) {
        constexpr float kLargest = std::numeric_limits<float>::max();
        LaneBounds all{{kLargest, kLargest, kLargest}, {-kLargest, -kLargest, -kLargest}};
        const std::size_t count = tree.counts[level][block];
        ++blocks;
        good &= !has_siblings || count >= 5 || level == 0;
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
            const LaneBounds bounds = lane_of(tree.levels[level][block], lane);
            if (lane >= count) {
                good &= bounds.low[0] > bounds.high[0];
                continue;
            }
            const std::uint32_t child = tree.children[level][block * kBoxBlock + lane];
            for (int i = 0; i < 3; ++i) {
                all.low[i] = std::min(all.low[i], bounds.low[i]);
                all.high[i] = std::max(all.high[i], bounds.high[i]);
            }
            if (level == 0) {
                const auto item = items.find(child);
                good &= item != items.end() && are_equal(item->second, bounds);
                ++found;
                continue;
            }
            good &= tree.parents[level - 1][child] == block * kBoxBlock + lane;
            good &= are_equal(follow(level - 1, child, count > 1), bounds);
        }
        return all;
    }
};

std::size_t check(const ItemTree& items, const Items& expected) {
    const BoundTree tree = items.view();
    Checker checker{tree, expected};
    (void)checker.follow(tree.level_count - 1, tree.root, false);
    CHECK(checker.good);
    CHECK(checker.found == expected.size());
    CHECK(items.size() == expected.size());
    return checker.blocks;
}

void check_partners(const ItemTree& items, const Items& expected, std::mt19937_64& random) {
    std::vector<std::uint32_t> asked, first(1 << 16), second(1 << 16);
    std::vector<LaneBounds> bounds;
    for (const auto& [item, at] : expected)
        if (random() % 8 == 0 && asked.size() < 100) asked.push_back(item), bounds.push_back(at);
    SlotPairs pairs{first.data(), second.data(), 0, first.size(), 0};
    find_partners(items.view(), asked.data(), bounds.data(), asked.size(), pairs, [](SlotPairs&) { return false; });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found, all;
    for (std::size_t i = 0; i < pairs.count; ++i) found.emplace_back(first[i], second[i]);
    std::sort(found.begin(), found.end());
    for (std::uint32_t i = 0; i < asked.size(); ++i)
        for (const auto& [item, at] : expected)
            if (item != asked[i] && meet(at, bounds[i])) all.emplace_back(i, item);
    CHECK(found == all);
}

}  // namespace

TEST_SUITE("collide/item_tree") {
    TEST_CASE(
        "items come, move and leave in any order: each is in the tree once, under bounds that are just as large") {
        std::mt19937_64 random(41);
        for (const std::uint32_t most : {3u, 40u, 400u, 6000u}) {
            ItemTree tree;
            Items items;
            tree.resize(most);
            for (int round = 0; round < 150; ++round) {
                // More come than go, then more go than come, down to none.
                const std::uint32_t come = round / 30 % 2 == 0 ? 9 : 1;
                for (std::uint32_t n = 0; n < most / 10 + 1; ++n) {
                    const auto item = static_cast<std::uint32_t>(random() % most);
                    const LaneBounds at = random_bounds(random, 50.0f, random() % 50 == 0 ? 60.0f : 2.0f);
                    if (items.contains(item) && random() % 10 >= come) {
                        tree.remove(item);
                        items.erase(item);
                    } else if (!items.contains(item) && random() % 10 < come) {
                        tree.insert(item, at);
                        items[item] = at;
                    }
                }
                std::vector<std::uint32_t> moved;
                for (auto& [item, at] : items) {
                    if (random() % 5 != 0) continue;
                    const auto step = static_cast<float>(random() % 7) - 3.0f;
                    const bool jumps = random() % 20 == 0;
                    for (int i = 0; i < 3; ++i) at.low[i] += step, at.high[i] += step;
                    if (jumps) at = random_bounds(random, 50.0f, 2.0f);
                    tree.move(item, at);
                    moved.push_back(item);
                }
                tree.settle(moved);
                if (round % 5 == 0 || most < 100) check(tree, items);
                if (round % 10 == 0) check_partners(tree, items, random);
            }
            for (const auto& item : items) tree.remove(item.first);
            items.clear();
            CHECK(check(tree, items) == 1);
            tree.insert(1, random_bounds(random, 1.0f, 1.0f));
            CHECK(tree.size() == 1);
        }
    }

    TEST_CASE("leaves stay at least a third full, and nearly as small as those of a new tree") {
        std::mt19937_64 random(42);
        ItemTree tree;
        Items items;
        constexpr std::uint32_t kCount = 3000;
        tree.resize(kCount);
        for (std::uint32_t item = 0; item < kCount; ++item)
            tree.insert(item, items[item] = random_bounds(random, 50.0f, 2.0f));
        const auto visits = [&] {
            std::vector<std::uint32_t> asked, first(1 << 20), second(1 << 20);
            std::vector<LaneBounds> bounds;
            for (const auto& [item, at] : items) asked.push_back(item), bounds.push_back(at);
            SlotPairs pairs{first.data(), second.data(), 0, first.size(), 0};
            find_partners(tree.view(), asked.data(), bounds.data(), asked.size(), pairs,
                          [](SlotPairs&) { return false; });
            return static_cast<double>(pairs.leaf_pairs) / static_cast<double>(asked.size());
        };
        const double after_coming = visits();
        double most = 0.0;
        for (int change = 1; change <= 100000; ++change) {
            const auto item = static_cast<std::uint32_t>(random() % kCount);
            tree.remove(item);
            tree.insert(item, items[item] = random_bounds(random, 50.0f, 2.0f));
            if (change % 10000 == 0) most = std::max(most, visits());
        }
        const std::size_t blocks = check(tree, items);
        CHECK(blocks < kCount / 5);
        CHECK(most < 1.25 * after_coming);
        CHECK(tree.leaf_count() < kCount / 5);
    }
}
