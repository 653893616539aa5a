// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <atomic>
#include <crofton/core/executor.hpp>
#include <vector>

using namespace crofton;

TEST_SUITE("core/executor") {
    TEST_CASE("zero items call no body") {
        ThreadPool pool(2);
        for (Executor* executor : {&serial_executor(), static_cast<Executor*>(&pool)})
            executor->parallel_for(0, 7, [](std::size_t, std::size_t, unsigned) { FAIL("called"); });
    }

    TEST_CASE("every item is visited once, in ranges that depend on count and grain alone") {
        ThreadPool pool(4);
        for (Executor* executor : {&serial_executor(), static_cast<Executor*>(&pool)})
            for (const std::size_t count : {1u, 6u, 7u, 8u, 1000u}) {
                std::vector<std::atomic<int>> visits(count);
                std::atomic<int> odd_ranges{0};
                executor->parallel_for(count, 7, [&](std::size_t begin, std::size_t end, unsigned worker) {
                    if (begin % 7 != 0 || (end - begin != 7 && end != count)) ++odd_ranges;
                    if (worker >= executor->concurrency()) ++odd_ranges;
                    for (std::size_t i = begin; i < end; ++i) ++visits[i];
                });
                CHECK(odd_ranges == 0);
                for (auto& visit : visits) CHECK(visit == 1);
            }
    }

    TEST_CASE("a pool serves many short calls in a row") {
        ThreadPool pool(3);
        std::atomic<std::size_t> sum{0};
        for (int call = 0; call < 2000; ++call)
            pool.parallel_for(10, 1, [&](std::size_t begin, std::size_t, unsigned) { sum += begin; });
        CHECK(sum == 2000u * 45u);
    }
}
