// SPDX-License-Identifier: MIT
// Gathered rows and deposited bits against loops, on every instruction set that this processor has.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/simd/gather_rows_test.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>
#include <crofton/simd/deposit_bits-inl.hpp>
#include <crofton/simd/gather_rows-inl.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>

HWY_BEFORE_NAMESPACE();
namespace crofton::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

// Rows at places that are not aligned to their size; each number says where it comes from. Returns how many are wrong.
std::size_t CountWrongRows() {
    const hn::CappedTag<float, 16> d;
    const std::size_t lanes = hn::Lanes(d);
    unsigned char bytes[16 * 44 + 32];
    double doubles[16][4];
    const double from[4] = {0.25, -3.0, 1e9, 7.0};
    for (std::size_t l = 0; l < lanes; ++l)
        for (std::size_t k = 0; k < 4; ++k) {
            const float value = static_cast<float>(100 * l + k);
            std::memcpy(bytes + 4 + 44 * l + 4 * k, &value, 4);
            doubles[l][k] = from[k] + 0.125 * static_cast<double>(100 * l + k);
        }
    hn::Vec<decltype(d)> rows[4], differences[4];
    simd::gather_rows(
        d, [&](std::size_t l) HWY_ATTR { return simd::load_row(bytes + 4 + 44 * l); }, rows);
    simd::gather_rows(
        d,
        [&](std::size_t l)
            HWY_ATTR { return simd::load_difference(reinterpret_cast<const unsigned char*>(doubles[l]), from); },
        differences);
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        alignas(64) float row[16], difference[16];
        hn::Store(rows[k], d, row);
        hn::Store(differences[k], d, difference);
        for (std::size_t l = 0; l < lanes; ++l) {
            wrong += row[l] != static_cast<float>(100 * l + k);
            wrong += difference[l] != 0.125f * static_cast<float>(100 * l + k);
        }
    }
    return wrong;
}

std::size_t CountWrongBits() {
    std::mt19937_64 random(1);
    std::size_t wrong = 0;
    for (int trial = 0; trial < 1000; ++trial) {
        const std::uint64_t words[3] = {random(), random(), random()};
        const std::uint64_t mask = trial == 0 ? 0 : trial == 1 ? ~std::uint64_t{0} : random() & random();
        const std::size_t at = random() % 128;
        const std::uint64_t bits = simd::bits_from(words, at), placed = simd::deposit_bits(bits, mask);
        std::size_t n = 0;
        for (std::size_t i = 0; i < 64; ++i) {
            const std::uint64_t next = words[(at + n) / 64] >> ((at + n) % 64) & 1;
            const bool masked = mask >> i & 1;
            wrong += (placed >> i & 1) != (masked ? next : 0);
            n += masked;
        }
    }
    return wrong;
}

}  // namespace crofton::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <doctest/doctest.h>
#include <hwy/targets.h>

namespace crofton::test {
HWY_EXPORT(CountWrongRows);
HWY_EXPORT(CountWrongBits);

TEST_SUITE("simd/gather_rows") {
    TEST_CASE("rows of four come out as four vectors, from any address, and bits at the places of a mask") {
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CAPTURE(hwy::TargetName(rest & -rest));
            CHECK(HWY_DYNAMIC_DISPATCH(CountWrongRows)() == 0);
            CHECK(HWY_DYNAMIC_DISPATCH(CountWrongBits)() == 0);
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
}  // namespace crofton::test
#endif
