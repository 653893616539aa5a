// SPDX-License-Identifier: MIT
// A part of the file that larger sets hardly show: the coder's last bytes.
#include <doctest/doctest.h>
#include <crofton/sampling/sampling.hpp>
#include <pair_coder.hpp>

using namespace crofton;
using namespace crofton::pvs;

namespace {

bool comes_back(const PairStates& pairs) {
    PairStates decoded{pairs.counts, pairs.objects, {}};
    decode(encode(pairs), decoded);
    return decoded.states == pairs.states;
}

}  // namespace

TEST_SUITE("pvs/pair coder") {
    TEST_CASE("all states of up to seven pairs come back, as a row and as objects of one cell") {
        for (std::uint32_t count = 1, all = 3; count <= 7; ++count, all *= 3)
            for (std::uint32_t number = 0; number < all; ++number) {
                PairStates row{{count, 1, 1}, 1, {}}, cell{{1, 1, 1}, count, {}};
                for (std::uint32_t i = 0, rest = number; i < count; ++i, rest /= 3)
                    row.states.push_back(static_cast<std::uint8_t>(rest % 3));
                cell.states = row.states;
                REQUIRE(comes_back(row));
                REQUIRE(comes_back(cell));
            }
    }

    TEST_CASE("random states of small grids come back, rare and common ones") {
        sampling::Random random(41);
        for (int trial = 0; trial < 3000; ++trial) {
            const auto size = [&](double most) { return static_cast<std::uint32_t>(1.0 + random.uniform(0.0, most)); };
            PairStates pairs{{size(5), size(3), size(5)}, size(9), {}};
            const double seen = random.uniform(), hidden = random.uniform();
            const std::size_t count = std::size_t{pairs.counts.x} * pairs.counts.y * pairs.counts.z * pairs.objects;
            for (std::size_t i = 0; i < count; ++i)
                pairs.states.push_back(random.uniform() < seen ? 2 : random.uniform() < hidden ? 1 : 0);
            REQUIRE(comes_back(pairs));
        }
    }
}
