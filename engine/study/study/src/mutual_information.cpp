// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/core/memory.hpp>
#include <crofton/study/mutual_information.hpp>
#include <numbers>

namespace crofton::study {

Result<MutualInformation> mutual_information(const radiosity::FactorMatrix& factors) {
    const std::size_t n = factors.size, sky = n, back = n + 1;
    // Rays by where they start; since each has one the other way, by where they arrive as well.
    Vector<std::uint64_t> ends(n + 2, 0), swallowed(n, 0);
    MutualInformation result;
    for (std::size_t i = 0; i < n; ++i) {
        swallowed[i] = factors.rays[i] - factors.escaped[i];
        for (std::size_t j = 0; j < n; ++j) swallowed[i] -= factors.transfers[i * n + j];
        ends[i] += factors.rays[i];
        ends[sky] += factors.escaped[i];
        ends[back] += swallowed[i];
    }
    for (const std::uint64_t count : ends) result.rays += count;
    if (result.rays == 0) return fail(ErrorCode::empty, kNoItem, "mutual information: no ray left any patch");
    const double all = static_cast<double>(result.rays);
    std::uint64_t seen = 0;
    for (const std::uint64_t count : ends) {
        if (count == 0) continue;
        ++seen;
        const double p = static_cast<double>(count) / all;
        result.entropy_bits -= p * std::log2(p);
    }
    const auto add = [&](std::uint64_t count, std::size_t i, std::size_t j) {
        if (count == 0) return;
        ++result.pairs;
        const double p = static_cast<double>(count) / all;
        result.bits += p * std::log2(p * all * all / (static_cast<double>(ends[i]) * static_cast<double>(ends[j])));
    };
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) add(factors.transfers[i * n + j], i, j);
        for (int way = 0; way < 2; ++way) add(factors.escaped[i], i, sky), add(swallowed[i], i, back);
    }
    result.bias =
        (static_cast<double>(result.pairs) - 2.0 * static_cast<double>(seen) + 1.0) / (2.0 * all * std::numbers::ln2);
    result.bits -= result.bias;
    return result;
}

}  // namespace crofton::study
