// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <crofton/core/executor.hpp>
#include <ctime>
#include <thread>
#include <vector>
#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#endif

// A sanitizer's own memory does not fit into a limit.
#if !defined(__linux__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CROFTON_UNLIMITED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CROFTON_UNLIMITED
#endif
#endif

using namespace crofton;

namespace {

// Leaves numbers that descend where a returned call had its variables: whoever reads them there still finds ranges to
// work on, and a body that is none.
[[gnu::noinline]] std::uint64_t scribble_on_stack() {
    constexpr std::size_t kWords = 512;
    volatile std::uint64_t words[kWords];
    for (std::size_t i = 0; i < kWords; ++i) words[i] = (kWords - i) * 0x0001000100010000u;
    return words[7];
}

}  // namespace

TEST_SUITE("core/executor") {
    TEST_CASE("a pool without a number of threads has one for each processor, and works") {
        ThreadPool pool(0);
        CHECK(pool.concurrency() == std::max(1u, std::thread::hardware_concurrency()));
        std::atomic<std::size_t> sum{0};
        pool.parallel_for(100, 3, [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t i = begin; i < end; ++i) sum += i;
        });
        CHECK(sum == 4950);
    }

    TEST_CASE("a pool takes no more threads than it can have") {
        std::atomic<std::size_t> sum{0};
        const auto adds_up = [&sum](ThreadPool& pool) {
            sum = 0;
            pool.parallel_for(1000, 1, [&](std::size_t begin, std::size_t, unsigned) { sum += begin; });
            return sum == 499'500;
        };
        {
            ThreadPool pool(4'000'000'000u);
            CHECK(pool.concurrency() <= 1024);
            CHECK(adds_up(pool));
        }
#ifndef CROFTON_UNLIMITED
        // Address space for a few stacks more: the system refuses the next thread.
        rlimit before{};
        REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
        std::size_t pages = 0;
        REQUIRE((std::ifstream("/proc/self/statm") >> pages));
        const rlimit few{pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + (std::size_t{64} << 20),
                         before.rlim_max};
        REQUIRE(setrlimit(RLIMIT_AS, &few) == 0);
        {
            ThreadPool pool(1000);
            CHECK((pool.concurrency() > 1 && pool.concurrency() < 100));
            CHECK(adds_up(pool));
        }
        REQUIRE(setrlimit(RLIMIT_AS, &before) == 0);
#endif
    }

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

    TEST_CASE("a grain far above the count is one range, which one thread takes once") {
        ThreadPool pool(4);
        for (const std::size_t grain : {std::size_t{3}, std::size_t{1} << 62, std::size_t{1} << 63, ~std::size_t{0}})
            for (int call = 0; call < 20; ++call) {
                // The others are awake, and look for work while the first thread has the range.
                std::atomic<int> work{0}, ranges{0};
                pool.parallel_for(64, 1, [&](std::size_t, std::size_t, unsigned) {
                    for (int i = 0; i < 500; ++i) ++work;
                });
                pool.parallel_for(3, grain, [&](std::size_t begin, std::size_t end, unsigned) {
                    if (begin == 0 && end == 3 && ++ranges == 1)
                        std::this_thread::sleep_for(std::chrono::milliseconds(2));
                });
                REQUIRE(ranges == 1);
            }
    }

    TEST_CASE("a pool serves many short calls in a row") {
        ThreadPool pool(3);
        std::atomic<std::size_t> sum{0};
        for (int call = 0; call < 2000; ++call)
            pool.parallel_for(10, 1, [&](std::size_t begin, std::size_t, unsigned) { sum += begin; });
        CHECK(sum == 2000u * 45u);
    }

    TEST_CASE("a call returns when the last body has, however long another thread takes over it") {
        ThreadPool pool(4);
        int shared = 0;
        for (int call = 0; call < 40; ++call) {
            std::atomic<int> begun{0}, finished{0};
            pool.parallel_for(4, 1, [&](std::size_t, std::size_t, unsigned worker) {
                ++begun;
                // The caller waits for another to begin, and is done first.
                const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
                while (worker == 0 && begun < 3 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
                if (worker != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1 + 2 * worker));
                ++finished;
            });
            CHECK(finished == 4);
            shared += begun > 1;
        }
        CHECK(shared > 0);
    }

#ifdef CLOCK_THREAD_CPUTIME_ID
    TEST_CASE("threads that sleep since an earlier call work on the next one") {
        using namespace std::chrono_literals;
        ThreadPool pool(2);
        std::this_thread::sleep_for(100ms);  // the other thread has gone to sleep
        std::atomic<int> inside{0};
        std::atomic<bool> together{false};
        pool.parallel_for(2, 1, [&](std::size_t, std::size_t, unsigned) {
            ++inside;
            const auto end = std::chrono::steady_clock::now() + 3s;
            while (inside < 2 && !together && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
            if (inside == 2) together = true;
            --inside;
        });
        CHECK(together);
    }

    TEST_CASE("a caller that waits for another thread's long body sleeps") {
        const auto processor_seconds = [] {
            timespec now{};
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
            return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
        };
        ThreadPool pool(2);
        std::atomic<bool> begun{false};
        const double before = processor_seconds();
        pool.parallel_for(2, 1, [&](std::size_t, std::size_t, unsigned worker) {
            if (worker != 0) {
                begun = true;
                std::this_thread::sleep_for(std::chrono::milliseconds(500));
            }
            while (worker == 0 && !begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        });
        CHECK(processor_seconds() - before < 0.03);
    }
#endif

    TEST_CASE("threads that race for a million ranges take each once") {
        ThreadPool pool(3);
        std::vector<std::atomic<std::uint8_t>> visits(100000);
        for (int call = 1; call <= 10; ++call) {
            pool.parallel_for(visits.size(), 1, [&](std::size_t begin, std::size_t, unsigned) { ++visits[begin]; });
            std::size_t wrong = 0;
            for (const auto& visit : visits) wrong += visit != call;
            REQUIRE(wrong == 0);
        }
    }

    TEST_CASE("a thread that wakes when all is done finds nothing to do") {
        ThreadPool pool(8);
        std::atomic<std::size_t> calls{0};
        std::uint64_t seen = 0;
        for (int call = 0; call < 3000; ++call) {
            pool.parallel_for(2, 1, [&](std::size_t, std::size_t, unsigned) { ++calls; });
            seen |= scribble_on_stack();
            // Long enough that some have gone to sleep when the next call comes.
            if (call % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
        }
        CHECK(calls == 6000);
        CHECK(seen != 0);
    }

    TEST_CASE("several threads may call one pool at once: each gets its own work done, one after the other") {
        ThreadPool pool(3);
        std::atomic<int> wrong{0};
        std::array<std::atomic<int>, 4> active{};
        std::vector<std::thread> callers;
        for (std::size_t caller = 0; caller < active.size(); ++caller)
            callers.emplace_back([&, caller] {
                for (int call = 0; call < 300; ++call) {
                    std::array<std::atomic<int>, 50> visits{};
                    pool.parallel_for(50, 3, [&](std::size_t begin, std::size_t end, unsigned) {
                        ++active[caller];
                        for (std::size_t i = begin; i < end; ++i) ++visits[i];
                        std::this_thread::yield();
                        for (std::size_t other = 0; other < active.size(); ++other)
                            wrong += other != caller && active[other] > 0;
                        --active[caller];
                    });
                    for (const auto& visit : visits) wrong += visit != 1;
                }
            });
        for (std::thread& caller : callers) caller.join();
        CHECK(wrong == 0);
    }
}
