// SPDX-License-Identifier: MIT
// One operation, again and again: its first allocation fails, then its second, until it makes no more.
#pragma once
#include <doctest/doctest.h>
#include <crofton/core/error.hpp>
#include <optional>
#include <string>

#include "failing_memory.hpp"

namespace crofton::testing {

using Outcome = std::optional<ErrorCode>;  // nothing: it succeeded

template <class T>
Outcome outcome_of(const Result<T>& result) {
    return result ? Outcome() : Outcome(result.error().code);
}

inline int failures_tried = 0;

// Sweeps operations that return an Error. `unchanged` looks at what the operation might have changed.
template <class Operation, class Unchanged>
void sweep(const char* name, const Operation& operation, const Unchanged& unchanged) {
    CAPTURE(std::string(name));
    REQUIRE_FALSE(operation());  // with all memory, and warm
    for (std::int64_t n = 0;; ++n) {
        CAPTURE(n);
        const std::int64_t before = live_blocks;
        has_failed = false;
        allocations_left = n;
        const Outcome outcome = operation();
        allocations_left = kNever;
        const std::int64_t after = live_blocks;
        if (!has_failed) {
            REQUIRE_FALSE(outcome);
            REQUIRE(n > 0);
            return;
        }
        ++failures_tried;
        REQUIRE(outcome);
        CHECK(to_string(*outcome) == to_string(ErrorCode::out_of_memory));
        REQUIRE(after == before);
        REQUIRE(unchanged());
    }
}

template <class Operation>
void sweep(const char* name, const Operation& operation) {
    sweep(name, operation, [] { return true; });
}

}  // namespace crofton::testing
