// SPDX-License-Identifier: MIT
// Parts of the bundle tracer that no picture shows: a shift of all lines in their cells is one of the grid.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <draw_kernels.hpp>
#include <vector>

using namespace crofton::lines;

TEST_SUITE("lines/draw kernels") {
    TEST_CASE("a line's place in its cell is in the middle of one of 65,536 strips each way, all as likely") {
        constexpr std::uint32_t kColumns = 8, kRows = 1u << 17, kStrips = 1u << 16, kGroup = kStrips / 16;
        std::vector<std::uint32_t> times[2] = {std::vector<std::uint32_t>(kStrips),
                                               std::vector<std::uint32_t>(kStrips)};
        std::size_t elsewhere = 0;
        float x[kColumns + 8], y[kColumns + 8];
        for (std::uint32_t row = 0; row < kRows; ++row) {
            detail::jitter_row(12345, row * kColumns, kColumns, row % 8, x, y);
            for (std::uint32_t c = 0; c < kColumns; ++c) {
                const float place[2] = {x[c] - float(c), y[c] - float(row % 8)};
                for (int way = 0; way < 2; ++way) {
                    const float strip = std::floor(place[way] * float(kStrips));
                    if (!(place[way] > 0.0f && place[way] < 1.0f) || place[way] * float(kStrips) != strip + 0.5f)
                        ++elsewhere;
                    else
                        ++times[way][static_cast<std::size_t>(strip)];
                }
            }
        }
        CHECK(elsewhere == 0);
        for (const auto& counts : times) {
            // Of a million places; a sixteenth of them has a standard deviation of 248.
            CHECK(std::count(counts.begin(), counts.end(), 0u) < 10);
            for (std::uint32_t first = 0; first < kStrips; first += kGroup) {
                double sum = 0.0;
                for (std::uint32_t k = 0; k < kGroup; ++k) sum += counts[first + k];
                CHECK(std::fabs(sum - kRows * kColumns / 16.0) < 1300.0);
            }
        }
    }
}
