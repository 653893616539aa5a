// SPDX-License-Identifier: MIT
// What a query of a list answers.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/statistics.hpp>
#include <cstddef>
#include <cstdint>

namespace crofton::cull {

// Bit i % 64 of word i / 64 is bound i's.
struct VerdictBits {
    Vector<std::uint64_t> visible;  // not outside
    Vector<std::uint64_t> inside;
    Statistics statistics;

    [[nodiscard]] Verdict verdict(std::size_t i) const {
        if (!(visible[i / 64] >> (i % 64) & 1)) return Verdict::outside;
        return inside[i / 64] >> (i % 64) & 1 ? Verdict::inside : Verdict::straddling;
    }

    Vector<Statistics> by_chunk;  // for the query's own use
};

}  // namespace crofton::cull
