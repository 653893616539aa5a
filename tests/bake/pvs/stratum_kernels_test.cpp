// SPDX-License-Identifier: MIT
// A part of the bake that no answer shows: lines of a stratum, many at a time, have the bits of the plain formula.
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <stratum_kernels.hpp>

using namespace crofton;
using pvs::kernels::kStratumLines;
using pvs::kernels::LineStratum;

namespace {

std::array<double, 6> plain_line(const LineStratum& stratum, std::uint64_t first, std::uint64_t second) {
    std::array<double, 4> u;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto bits = static_cast<std::uint32_t>((k < 2 ? first : second) >> (k % 2 * 32));
        u[k] = stratum.low[k] + stratum.length[k] * ((static_cast<double>(bits) + 0.5) * 0x1p-32);
    }
    const glm::dvec2 disc = sampling::disc_point({u[2], u[3]});
    const unsigned k = stratum.axis, s = (k + 1) % 3, t = (k + 2) % 3;
    std::array<double, 6> line;
    line[k] = stratum.plane;
    line[s] = stratum.corner[0] + stratum.sides[0] * u[0];
    line[t] = stratum.corner[1] + stratum.sides[1] * u[1];
    line[3 + k] = stratum.inward * std::sqrt(std::max(0.0, 1.0 - u[2]));
    line[3 + s] = disc.x;
    line[3 + t] = disc.y;
    return line;
}

}  // namespace

TEST_SUITE("pvs/stratum kernels") {
    TEST_CASE("the lines of a stratum are those of the formula, bit by bit, on every instruction set") {
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            sampling::Random random(31);
            for (int trial = 0; trial < 300; ++trial) {
                LineStratum stratum{};
                for (std::size_t k = 0; k < 4; ++k) {
                    // All of the cube, and parts of it that are small or reach to an end.
                    const double a = random.uniform(), b = random.uniform();
                    stratum.low[k] = trial % 3 == 0 ? 0.0 : std::min(a, b);
                    stratum.length[k] = trial % 3 == 0 ? 1.0 : trial % 3 == 1 ? 1.0 - stratum.low[k] : std::abs(a - b);
                }
                for (std::size_t k = 0; k < 2; ++k)
                    stratum.corner[k] = random.uniform(-900.0, 900.0), stratum.sides[k] = random.uniform(0.0, 1e3);
                stratum.plane = random.uniform(-5.0, 5.0);
                stratum.inward = trial % 2 ? 1.0 : -1.0;
                stratum.axis = static_cast<unsigned>(trial % 3);
                std::array<std::uint64_t, 2 * kStratumLines> bits;
                random.fill(bits);
                // The ends of the range, and each quarter of a turn.
                bits[0] = bits[1] = 0, bits[2] = bits[3] = ~std::uint64_t{0};
                for (std::size_t q = 0; q < 16; ++q) bits[5 + 2 * q] = std::uint64_t{q} << 60 | (q % 3 << 32);
                std::array<double, 6 * kStratumLines> lines;
                pvs::kernels::draw_stratum(stratum, bits.data(), lines.data());
                for (std::size_t i = 0; i < kStratumLines; ++i) {
                    const std::array<double, 6> line = plain_line(stratum, bits[2 * i], bits[2 * i + 1]);
                    for (std::size_t n = 0; n < 6; ++n) REQUIRE(lines[6 * i + n] == line[n]);
                }
            }
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
