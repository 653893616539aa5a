// SPDX-License-Identifier: MIT
// States of pairs in few bytes: what is decoded is what was coded, to the last pair.
#include <doctest/doctest.h>
#include <crofton/sampling/sampling.hpp>

#include "pair_coder.hpp"

using namespace crofton;

TEST_SUITE("pvs/pair_coder") {
    TEST_CASE("states of any grid are decoded as they were, whatever the last ones are") {
        sampling::Random random(1);
        for (int trial = 0; trial < 20; ++trial) {
            pvs::PairStates pairs;
            for (int k = 0; k < 3; ++k) pairs.counts[k] = 1 + static_cast<unsigned>(random.uniform(0.0, 4.0));
            pairs.objects = 1 + static_cast<std::uint32_t>(random.uniform(0.0, 9.0));
            const double seen = random.uniform(), hidden = random.uniform();
            pairs.states.resize(std::size_t{pairs.counts.x} * pairs.counts.y * pairs.counts.z * pairs.objects);
            for (std::uint8_t& state : pairs.states)
                state = random.uniform() < seen ? 2 : random.uniform() < hidden ? 1 : 0;
            for (std::uint8_t last = 0; last < 3; ++last) {
                pairs.states.back() = last;
                pvs::PairStates read{pairs.counts, pairs.objects, {}};
                pvs::decode(pvs::encode(pairs), read);
                REQUIRE(read.states == pairs.states);
            }
        }
    }
}
