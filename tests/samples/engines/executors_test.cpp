// SPDX-License-Identifier: MIT
#include "../../../samples/executors/tbb_executor.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/broadphase.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>
#include <random>
#include <vector>

namespace {

std::vector<crofton::Obb> random_boxes(std::size_t count) {
    std::mt19937 random(11);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    std::vector<crofton::Obb> boxes(count);
    for (crofton::Obb& box : boxes) {
        box.center = {uniform(-50, 50), uniform(-50, 50), uniform(-90, 10)};
        box.half_extents = glm::vec3(static_cast<float>(uniform(0.1, 1.5)));
    }
    return boxes;
}

struct Answers {
    std::vector<std::uint32_t> seen;
    std::vector<crofton::IdPair> pairs;
    bool operator==(const Answers&) const = default;
};

Answers answers(const std::vector<crofton::Obb>& boxes, crofton::Executor& executor) {
    Answers result;
    const auto tree = crofton::boxtree::BoxTree::build(boxes, {}, executor);
    REQUIRE(tree);
    crofton::cull::VisibleSet visible;
    crofton::cull::find_visible(*tree, {.frustum = *crofton::frustum_of(crofton::Camera{})}, visible, {}, executor);
    result.seen.assign(visible.ids().begin(), visible.ids().end());
    crofton::collide::Broadphase broadphase;
    REQUIRE(broadphase.update(boxes, {}, executor));
    result.pairs.assign(broadphase.pairs().begin(), broadphase.pairs().end());
    return result;
}

}  // namespace

TEST_SUITE("engines/executors") {
    TEST_CASE("no items, one item and a last range cut short are each done once on oneTBB") {
        crofton::samples::TbbExecutor executor(3);
        for (const std::size_t count : {0u, 1u, 7u, 1000u, 1001u}) {
            std::vector<std::atomic<int>> done(count);
            executor.parallel_for(count, 7, [&](std::size_t begin, std::size_t end, unsigned worker) {
                CHECK(begin % 7 == 0);
                CHECK(end <= count);
                CHECK(worker < executor.concurrency());
                for (std::size_t i = begin; i < end; ++i) ++done[i];
            });
            for (const auto& times : done) CHECK(times == 1);
        }
    }

    TEST_CASE("serial, a pool of std::threads and oneTBB give the same bits") {
        const auto boxes = random_boxes(20'000);
        const Answers expected = answers(boxes, crofton::serial_executor());
        CHECK(expected.seen.size() > 1000);
        CHECK(expected.pairs.size() > 1000);
        crofton::ThreadPool pool(4);
        CHECK(answers(boxes, pool) == expected);
        const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
        for (const int threads : {1, 2, 5}) {
            crofton::samples::TbbExecutor tbb(threads);
            CHECK(answers(boxes, tbb) == expected);
        }
    }
}
