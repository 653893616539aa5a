// SPDX-License-Identifier: MIT
// The vector helpers against loops over lanes, on every instruction set that this processor has.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/simd/compress_test.cpp"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>
#include <crofton/simd/compress-inl.hpp>
#include <crofton/simd/mask_bits-inl.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace crofton::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace simd = crofton::simd::HWY_NAMESPACE;

// Lanes l = 0, 1, … of a vector hold values[l]; every mask is tried. Returns how many masks came out wrong.
template <class D>
std::size_t count_wrong(D d) {
    using T = hn::TFromD<D>;
    constexpr std::size_t kMost = 64 / sizeof(T);
    const std::size_t lanes = hn::Lanes(d);
    alignas(64) T values[kMost];
    for (std::size_t l = 0; l < lanes; ++l) values[l] = static_cast<T>(1000 + 7 * l);
    std::size_t wrong = 0;
    for (std::uint64_t bits = 0; bits < std::uint64_t{1} << lanes; ++bits) {
        alignas(64) T selected[kMost], out[2 * kMost];
        std::vector<T> expected;
        for (std::size_t l = 0; l < lanes; ++l) {
            selected[l] = static_cast<T>(bits >> l & 1);
            if (bits >> l & 1) expected.push_back(values[l]);
        }
        for (T& value : out) value = static_cast<T>(5);
        const auto mask = hn::Ne(hn::Load(d, selected), hn::Zero(d));
        bool good = simd::mask_bits(d, mask) == bits;
        good &= simd::mask_bits(d, simd::mask_from_bits(d, bits)) == bits;
        good &= simd::compress_store(d, hn::Load(d, values), mask, out + 1) == expected.size();
        for (std::size_t i = 0; i < expected.size(); ++i) good &= out[1 + i] == expected[i];
        good &= out[0] == static_cast<T>(5) && out[1 + lanes] == static_cast<T>(5);
        if constexpr (sizeof(T) == 4 && !hwy::IsFloat<T>() && !hwy::IsSigned<T>()) {
            good &= simd::store_positions(d, static_cast<std::uint32_t>(bits), 4000000000u, out + 1) == expected.size();
            for (std::size_t l = 0, i = 0; l < lanes; ++l)
                if (bits >> l & 1) good &= out[1 + i++] == static_cast<T>(4000000000u + l);
            good &= out[0] == static_cast<T>(5) && out[1 + lanes] == static_cast<T>(5);
        }
        wrong += !good;
    }
    return wrong;
}

std::size_t CountWrong() {
    return count_wrong(hn::CappedTag<std::uint32_t, 16>()) + count_wrong(hn::CappedTag<std::int32_t, 16>()) +
           count_wrong(hn::CappedTag<float, 16>()) + count_wrong(hn::CappedTag<std::uint32_t, 8>()) +
           count_wrong(hn::CappedTag<float, 4>()) + count_wrong(hn::CappedTag<double, 8>()) +
           count_wrong(hn::CappedTag<double, 4>()) + count_wrong(hn::CappedTag<std::uint64_t, 2>());
}

}  // namespace crofton::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <doctest/doctest.h>
#include <hwy/targets.h>

namespace crofton::test {
HWY_EXPORT(CountWrong);

TEST_SUITE("simd/compress") {
    TEST_CASE("the selected lanes come first, in their order, for every mask, and no lane beyond a vector is written") {
        for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
            hwy::SetSupportedTargetsForTest(rest & -rest);
            CAPTURE(hwy::TargetName(rest & -rest));
            CHECK(HWY_DYNAMIC_DISPATCH(CountWrong)() == 0);
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}
}  // namespace crofton::test
#endif
