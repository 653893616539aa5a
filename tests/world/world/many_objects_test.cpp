// SPDX-License-Identifier: MIT
// Adding many objects at once, and memory for those that will come.
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/crofton.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <error_of.hpp>
#include <limits>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "box_at.hpp"

using namespace crofton;
using crofton::testing::box_at;
using crofton::testing::CountingMemory;
using oracle::NearMisses;

namespace {

std::vector<ObjectDescription> random_descriptions(std::size_t count, unsigned seed) {
    NearMisses random(seed);
    std::vector<ObjectDescription> result(count);
    for (std::size_t i = 0; i < count; ++i)
        result[i] = {.bound = oracle::random_box(random, {}, 100.0), .user = i, .layers = 1u << i % 3};
    return result;
}

}  // namespace

TEST_SUITE("world/many objects") {
    TEST_CASE("objects that are added at once are those that are added one by one") {
        World together, single;
        const auto descriptions = random_descriptions(1500, 7);
        std::vector<ObjectHandle> handles(descriptions.size());
        std::size_t begin = 0;
        for (const std::size_t part : {std::size_t{0}, std::size_t{1}, std::size_t{99}, std::size_t{1400}}) {
            REQUIRE(together.add(std::span(descriptions).subspan(begin, part), std::span(handles).subspan(begin, part))
                        .has_value());
            REQUIRE(together.update().has_value());
            for (std::size_t i = begin; i < begin + part; ++i) {
                const ObjectHandle handle = single.add(descriptions[i]).value();
                CHECK(handles[i].index == handle.index);
            }
            REQUIRE(single.update().has_value());
            begin += part;
        }
        REQUIRE(together.object_count() == descriptions.size());
        for (std::size_t i = 0; i < handles.size(); ++i) {
            CHECK(together.user_of(handles[i]).value() == i);
            CHECK(have_same_bits(together.box_of(handles[i]).value(), descriptions[i].bound.box));
        }
        const auto indices = [](const World& world) {
            std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
            for (const ObjectPair& pair : world.pairs())
                found.emplace_back(pair.first.object.index, pair.second.object.index);
            return found;
        };
        CHECK(indices(together).size() > 0);
        CHECK(indices(together) == indices(single));
    }

    TEST_CASE("of many descriptions the valid ones are added, and the first invalid one is named") {
        World world;
        std::vector<ObjectDescription> descriptions(6, {.bound = box_at({1.0, 2.0, 3.0})});
        descriptions[2].bound.box.center.x = std::numeric_limits<double>::quiet_NaN();
        descriptions[4].bound = {};
        std::vector<ObjectHandle> handles(descriptions.size());
        const auto added = world.add(std::span<const ObjectDescription>(descriptions), handles);
        CHECK(error_of(added).code == ErrorCode::non_finite);
        CHECK(added.error().item == 2);
        CHECK(world.object_count() == 4);
        for (std::size_t i = 0; i < handles.size(); ++i) {
            CHECK(handles[i].is_null() == (i == 2 || i == 4));
            CHECK(world.contains(handles[i]) == !handles[i].is_null());
        }
        handles.pop_back();
        CHECK(error_of(world.add(std::span<const ObjectDescription>(descriptions), handles)).code ==
              ErrorCode::invalid_argument);
        CHECK(world.object_count() == 4);
    }

    TEST_CASE("objects that were reserved for come without a copy of the others, whenever they come") {
        constexpr std::size_t kLoaded = 20000, kAll = 30000;
        const auto descriptions = random_descriptions(kAll, 8);
        const auto replaced = [&](bool reserves) {
            const CountingMemory memory;
            World world({.pairs = false, .rebuild_budget = 0});
            if (reserves) REQUIRE(world.reserve(kAll).has_value());
            std::vector<ObjectHandle> handles(kAll);
            REQUIRE(world.add(std::span(descriptions).first(kLoaded), std::span(handles).first(kLoaded)).has_value());
            for (int update = 0; update < 4; ++update) REQUIRE(world.update().has_value());
            const std::size_t taken = memory.bytes_taken(), in_use = memory.bytes_in_use();
            for (std::size_t i = kLoaded; i < kAll; ++i) {
                handles[i] = world.add(descriptions[i]).value();
                if (i % 16 == 0) REQUIRE(world.update().has_value());
            }
            return memory.bytes_replaced_since(taken, in_use);
        };
        // With reserve() the tree's leaves and nodes are copied still, and the list of what moves.
        CHECK(replaced(false) > replaced(true) + kAll * sizeof(Obb));
    }

    TEST_CASE("to reserve fewer than there are, or nothing, changes nothing, and too many is an error") {
        World world;
        const auto descriptions = random_descriptions(100, 9);
        std::vector<ObjectHandle> handles(descriptions.size());
        REQUIRE(world.add(std::span(descriptions), handles).has_value());
        REQUIRE(world.reserve(0).has_value());
        REQUIRE(world.reserve(10).has_value());
        CHECK(error_of(world.reserve((std::size_t{1} << 30) + 1)).code == ErrorCode::out_of_range);
        REQUIRE(world.update().has_value());
        REQUIRE(world.reserve(1000).has_value());
        REQUIRE(world.update().has_value());
        for (std::size_t i = 0; i < handles.size(); ++i)
            CHECK(have_same_bits(world.box_of(handles[i]).value(), descriptions[i].bound.box));
    }
}
