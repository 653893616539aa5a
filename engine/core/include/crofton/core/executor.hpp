// SPDX-License-Identifier: MIT
// The engine owns no threads: work is handed to the host's, through this hook.
#pragma once
#include <crofton/core/function_ref.hpp>
#include <cstddef>

namespace crofton {

// body(begin, end, worker): do the items [begin, end); worker < concurrency() and no two bodies run at once on one
// worker, so it may index per-worker scratch memory.
using RangeTask = FunctionRef<void(std::size_t begin, std::size_t end, unsigned worker)>;

class Executor {
  public:
    virtual ~Executor() = default;

    // How many bodies may run at once; at least 1, and the same for the executor's life.
    [[nodiscard]] virtual unsigned concurrency() const = 0;

    // Calls `body` for the ranges [0, grain), [grain, 2·grain), … of [0, count), in any order and on any threads, and
    // returns when all are done. The ranges depend on count and grain alone, so a body that writes only its own range's
    // output gives the same bits with any executor. Requires grain ≥ 1. Bodies do not throw.
    virtual void parallel_for(std::size_t count, std::size_t grain, RangeTask body) = 0;
};

// Runs everything on the calling thread, in order. Stateless: may be shared by any number of threads.
[[nodiscard]] Executor& serial_executor();

}  // namespace crofton
