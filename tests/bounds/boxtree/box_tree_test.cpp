// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <chrono>
#include <counting_memory.hpp>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <error_of.hpp>
#include <limits>
#include <oracle/least_cuts.hpp>
#include <oracle/random_boxes.hpp>
#include <oracle/tree_contents.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;
using boxtree::BoxTree;
using oracle::holds_all;

TEST_SUITE("boxtree/box_tree") {
    TEST_CASE("a bad box is refused by its index, whatever is wrong with it") {
        const std::vector<Obb> good = oracle::random_crowd(20, 0.0, 1).boxes;
        for (int fault = 0; fault < 5; ++fault) {
            std::vector<Obb> boxes = good;
            Obb& bad = boxes[13];
            if (fault == 0) bad.center.x = std::nan("");
            if (fault == 1) bad.half_extents.y = -1.0f;
            if (fault == 2) bad.half_extents.z = std::numeric_limits<float>::infinity();
            if (fault == 3) bad.axes[0] *= 2.0f;
            if (fault == 4) bad.center.z = 1e31;
            const auto tree = BoxTree::build(boxes);
            REQUIRE(!tree.has_value());
            CHECK(error_of(tree).item == 13);
        }
        const std::vector<std::uint32_t> too_few(3);
        CHECK(error_of(BoxTree::build(good, too_few)).code == ErrorCode::invalid_argument);
        CHECK(!BoxTree::build(good, {.criterion = {-1.0, 0.0, 0.0}}).has_value());
    }

    TEST_CASE(
        "no boxes, one box, equal boxes, points and a geometric series of sizes all make a tree that holds them") {
        CHECK(BoxTree::build(std::span<const Obb>{})->structure().nodes().size() == 1);
        CHECK(holds_all(*BoxTree::build(oracle::random_crowd(1, 0.0, 1).boxes)));
        CHECK(holds_all(*BoxTree::build(std::vector<Obb>(5000))));
        std::vector<Obb> series(120);
        for (std::size_t i = 0; i < series.size(); ++i) {
            series[i].center = glm::dvec3(std::pow(1.7, double(i)), 0.0, 0.0);
            series[i].half_extents = glm::vec3(float(0.4 * series[i].center.x));
        }
        CHECK(holds_all(*BoxTree::build(series)));
    }

    TEST_CASE("every bound contains every box below it, for each criterion and at every offset") {
        for (const double offset : {0.0, 1e7, -1e29})
            for (const measure::Criterion& criterion :
                 {measure::minimal_perimeter(), measure::minimal_area(), measure::minimal_volume()})
                CHECK(
                    holds_all(*BoxTree::build(oracle::random_crowd(2000, offset, 2).boxes, {.criterion = criterion})));
    }

    TEST_CASE("all leaves but one are full, and the height is logarithmic") {
        const auto tree = BoxTree::build(oracle::random_crowd(16 * 16 * 16 + 5, 0.0, 3).boxes).value();
        CHECK(tree.structure().leaves().size() == 257);
        CHECK(tree.structure().height() == 3);
        std::size_t partial = 0;
        for (const boxtree::Leaf& leaf : tree.structure().leaves()) partial += leaf.count < boxtree::kWidth;
        CHECK(partial == 1);
    }

    TEST_CASE("leaves hold the parts that trying all cuts finds, for each criterion") {
        for (const measure::Criterion& criterion :
             {measure::minimal_perimeter(), measure::minimal_area(), measure::minimal_volume()})
            for (const std::size_t count : {17u, 32u, 47u, 100u, 255u, 256u}) {
                const std::vector<Obb> boxes = oracle::random_crowd(count, 0.0, count).boxes;
                const BoxTree tree = *BoxTree::build(boxes, {.criterion = criterion});
                const std::vector<oracle::Part> parts = oracle::least_cuts(boxes, boxtree::kWidth, criterion);
                REQUIRE(tree.structure().leaves().size() == parts.size());
                for (std::size_t l = 0; l < parts.size(); ++l) {
                    const auto slots =
                        tree.structure().slot_items().subspan(l * boxtree::kWidth, tree.structure().leaves()[l].count);
                    CHECK(test::ranges::is_permutation(slots, parts[l]));
                }
            }
    }

    // Two clumps of 40,000 boxes each, as large as a 10^4th of the scene: all of a clump share one coarse cell of the
    // curve.
    TEST_CASE("clustered objects give leaves as small as evenly spread objects do") {
        oracle::NearMisses random(8);
        const auto place = [&](double half_width) {
            return glm::dvec3(random.number(-half_width, half_width), random.number(-half_width, half_width),
                              random.number(-half_width, half_width));
        };
        std::vector<Obb> boxes;
        for (int clump = 0; clump < 2; ++clump) {
            const glm::dvec3 middle = place(5000.0);
            for (int i = 0; i < 40000; ++i)
                boxes.push_back({.center = middle + place(0.5), .half_extents = glm::vec3(0.001f)});
        }
        const BoxTree tree = *BoxTree::build(boxes);
        CHECK(tree.validate().has_value());
        double edges = 0.0;
        for (std::size_t l = 0; l < tree.structure().leaves().size(); ++l) {
            Aabb centers;
            for (unsigned lane = 0; lane < tree.structure().leaves()[l].count; ++lane)
                centers.include(boxes[tree.structure().slot_items()[l * boxtree::kWidth + lane]].center);
            const glm::dvec3 size = centers.max - centers.min;
            edges += size.x + size.y + size.z;
        }
        // Cubes for 16 of 40,000 items in a cube of side 1.
        CHECK(edges / double(tree.structure().leaves().size()) < 1.3 * 3.0 * std::cbrt(16.0 / 40000.0));
    }

    TEST_CASE("a tree is the same, byte for byte, however many threads build it") {
        const oracle::Crowd crowd = oracle::random_crowd(50000, 0.0, 22);
        const Vector<std::byte> serial = BoxTree::build(crowd.boxes)->serialise();
        for (const unsigned threads : {2u, 3u, 8u}) {
            ThreadPool pool(threads);
            CHECK(test::ranges::equal(BoxTree::build(crowd.boxes, {}, pool)->serialise(), serial));
        }
    }

    // A leaf of 16 items is 512 bytes, 64 are the items' ids, 11 its marks, count and radii; an item has 4 bytes for
    // its slot and 4 for its layers; a sixteenth of a node, of its range and of its radii come with each leaf. Leaves
    // are 97 % full at least.
    TEST_CASE("a build and a check are asked whether to stop every few thousand items, stop then, and keep no memory") {
        constexpr std::size_t kCount = 40'000;  // more than are split from the top
        struct Asked {
            std::size_t count = 0, stop_at = 0;
            double share = 0.0;
        };
        const auto should_stop = [](void* user, double share) {
            Asked& its = *static_cast<Asked*>(user);
            std::this_thread::sleep_for(std::chrono::microseconds(5100));  // it is asked again after 5 ms
            CHECK(share >= its.share);
            CHECK(share <= 1.0);
            its.share = share;
            return ++its.count == its.stop_at;
        };
        ThreadPool threads(2);
        std::vector<Obb> spread = oracle::random_crowd(kCount, 0.0, 11).boxes;
        std::vector<Obb> crowded(kCount);  // all in one place
        for (const auto& input : {std::pair(&spread, false), {&crowded, false}, {&crowded, true}})
            for (Executor* const executor : {&serial_executor(), static_cast<Executor*>(&threads)}) {
                const std::vector<Obb>& boxes = *input.first;
                const bool turned = input.second;
                CAPTURE(turned);
                const auto build = [&](Asked& asked) {
                    return BoxTree::build(
                        boxes,
                        {.orientation = turned ? boxtree::Orientation::oriented : boxtree::Orientation::aligned,
                         .should_stop = should_stop,
                         .stop_user = &asked},
                        *executor);
                };
                Asked all;
                const auto tree = build(all).value();
                CHECK(tree.serialise() ==
                      BoxTree::build(boxes, {.orientation = tree.structure().orientation()})->serialise());
                CHECK(all.count >= 4);
                CHECK(all.count < 200);
                // Threads are asked as they come: another time some fewer or more.
                const bool serial = executor->concurrency() == 1;
                for (const std::size_t stop_at : {std::size_t{1}, serial ? all.count - 1 : 2}) {
                    testing::CountingMemory memory;
                    {
                        Asked asked{.stop_at = stop_at};
                        CHECK(error_of(build(asked)).code == ErrorCode::cancelled);
                        CHECK(asked.count == stop_at);
                    }
                    CHECK(memory.bytes_in_use() == 0);
                }
                Asked checked;
                REQUIRE(tree.validate(should_stop, &checked));
                CHECK(checked.count >= kCount / 16 / 256);
                Asked stopped{.stop_at = checked.count / 2};
                CHECK(error_of(tree.validate(should_stop, &stopped)).code == ErrorCode::cancelled);
                CHECK(stopped.count == checked.count / 2);
            }
    }

    TEST_CASE("an item costs at most 64 bytes in addition to its box, after moves too") {
        const testing::CountingMemory memory;
        const oracle::Crowd crowd = oracle::random_crowd(100000, 0.0, 21);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        const auto per_item = [&] {
            return static_cast<double>(memory.bytes_in_use()) / 100000.0 - static_cast<double>(sizeof(Obb));
        };
        CHECK(per_item() <= 48.0);
        CHECK(per_item() >= 40.0);
        std::vector<boxtree::ItemId> items(100000);
        for (boxtree::ItemId i = 0; i < 100000; ++i) items[i] = i;
        for (int frame = 0; frame < 3; ++frame) {
            REQUIRE(tree.move(items, crowd.boxes).has_value());
            tree.refit();
        }
        CHECK(per_item() <= 64.0);
    }

    TEST_CASE("an insertion makes room for an eighth more, in each of the tree's lists") {
        const testing::CountingMemory memory;
        const oracle::Crowd crowd = oracle::random_crowd(100000, 0.0, 22);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        const std::size_t before = memory.bytes_in_use();
        for (std::size_t i = 0; i < 100; ++i) REQUIRE(tree.insert(crowd.boxes[i]).has_value());
        CHECK(memory.bytes_in_use() - before > before / 10);
        CHECK(memory.bytes_in_use() - before < before / 8 + before / 100);
    }
}
