// SPDX-License-Identifier: MIT
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <cstddef>
#include <mutex>
#include <utility>

namespace crofton::cli {

// Runs `body` for each region, and returns the error of the first that has one.
template <class Body>
Result<void> for_each_region(std::size_t count, Executor& executor, Body body) {
    std::mutex mutex;
    std::size_t first_bad = count;
    Result<void> first;
    executor.parallel_for(count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            Result<void> done = body(i);
            const std::lock_guard lock(mutex);
            if (done || i >= first_bad) continue;
            first_bad = i;
            first = std::move(done);
        }
    });
    return first;
}

}  // namespace crofton::cli
