// SPDX-License-Identifier: MIT
// The promise of a bake, asked by twenty times its lines. These are drawn in each cell by itself, and their crossings
// and gaps are told by the plain oracle.
#include <doctest/doctest.h>
#include <cmath>
#include <crofton/pvs/pvs.hpp>
#include <oracle/plain_pvs.hpp>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

// Lines through each cell that the bake's promise stands for, and of those that ask.
constexpr double kPromised = 110.0;
constexpr std::uint64_t kAsking = 2200;
constexpr std::uint32_t kObjects = 8;

// Counts the lines through the cell along which each object is seen.
std::vector<std::uint64_t> hits_in(const BakeGeometry& geometry, const Aabb& box, sampling::Random random) {
    const Cells cell = Cells::boxes(std::vector<Aabb>{box}).value();
    std::vector<std::uint64_t> hits(kObjects, 0);
    for (std::uint64_t n = 0; n < kAsking; ++n) {
        oracle::Pairs seen;
        const Line line = sampling::line_from_box(box, random.point<5>());
        oracle::add_witnessed(geometry, cell, occlude::Sides::both, line, seen);
        for (const auto& pair : seen) ++hits[pair.second];
    }
    return hits;
}

}  // namespace

TEST_SUITE("pvs/promise") {
    // A pair's share p of the lines is estimated by p' = hits / kAsking. For p = ε there are 20·ln(P/δ) = 318 hits in
    // the mean, with a standard deviation of 6 %. So what is estimated above ε is above 0.75·ε, but for one pair in
    // 30,000. The bake missed that with a chance of (δ/P)^0.75 = 7·10^-6.
    // On average at most Σ e^(−pN) of all pairs are missed. As e^(−x) is convex, Σ e^(−p'N) is not less in the mean.
    TEST_CASE(
        "20 times the lines find at most one missed pair above epsilon per 1,000 cells, below as the bound says") {
        const BakeGeometry geometry = random_geometry(1, kObjects);
        const Cells cells = Cells::grid({{-10.0, 0.0, -10.0}, {10.0, 4.0, 10.0}}, {32, 1, 32}).value();
        const double pairs = static_cast<double>(cells.size() * kObjects);
        const double epsilon = std::log(pairs / 0.001) / kPromised;
        Bake bake = Bake::create(geometry, cells, {.epsilon = epsilon, .confidence = 0.999, .seed = 7}).value();
        REQUIRE(bake.run().has_value());
        REQUIRE(bake.epsilon_reached() <= epsilon);
        std::uint64_t above = 0, missed_above = 0, missed = 0;
        double most = 0.0, variance = 0.0;  // of the missed
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const auto hits = hits_in(geometry, cells.box(c), sampling::Random(8, c));
            for (std::uint32_t o = 0; o < kObjects; ++o) {
                if (hits[o] == 0) continue;
                const double share = static_cast<double>(hits[o]) / static_cast<double>(kAsking);
                const double chance = std::exp(-kPromised * share);
                const bool is_missed = !bake.is_seen(c, o);
                above += share >= epsilon;
                missed_above += share >= epsilon && is_missed;
                missed += is_missed;
                most += chance, variance += chance * (1.0 - chance);
            }
        }
        CAPTURE(most);
        CHECK(above > 400);
        CHECK(1000 * missed_above <= cells.size());
        // There are pairs to miss, and lines that find them.
        CHECK(missed > 20);
        CHECK(static_cast<double>(missed) <= most + 4.0 * std::sqrt(variance));
    }
}
