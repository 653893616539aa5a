// SPDX-License-Identifier: MIT
// What a query cost, and what of it was in vain.
#pragma once
#include <crofton/core/version.hpp>
#include <cstdint>

namespace crofton::cull {

#if defined(CROFTON_NO_STATISTICS)
inline constexpr bool kCountStatistics = false;  // every number below stays 0, and counting costs nothing
#else
inline constexpr bool kCountStatistics = true;
#endif

// The same on every processor but for exact_tests: how many items are too near to call in floats depends on whether the
// processor fuses products with sums.
struct Statistics {
    std::uint64_t nodes_tested = 0;    // bounds of inner nodes and leaves against planes
    std::uint64_t boxes_tested = 0;    // items' boxes against planes
    std::uint64_t accepted_whole = 0;  // items reported because a node above them is inside
    std::uint64_t straddling = 0;      // items reported as straddling
    std::uint64_t exact_tests = 0;     // items that went through the second stage
    std::uint64_t improper = 0;        // items that no plane rejects and that are outside all the same (mode exact)

    Statistics& operator+=(const Statistics& other) {
        nodes_tested += other.nodes_tested;
        boxes_tested += other.boxes_tested;
        accepted_whole += other.accepted_whole;
        straddling += other.straddling;
        exact_tests += other.exact_tests;
        improper += other.improper;
        return *this;
    }
};

}  // namespace crofton::cull
