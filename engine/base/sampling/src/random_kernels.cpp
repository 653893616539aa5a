// SPDX-License-Identifier: MIT
#include "random_kernels.hpp"

#include <crofton/sampling/sampling.hpp>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace crofton::sampling::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void philox(std::uint64_t first, std::uint64_t stream, std::uint64_t seed, std::uint64_t* numbers) {
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < kPhiloxBlocks; ++i, ++first) {
        const Random::Block b =
            Random::block({low(first), high(first), low(stream), high(stream)}, {low(seed), high(seed)});
        numbers[2 * i] = b[0] | std::uint64_t{b[1]} << 32;
        numbers[2 * i + 1] = b[2] | std::uint64_t{b[3]} << 32;
    }
#else
    const hn::CappedTag<std::uint64_t, kPhiloxBlocks> d;
    const hn::Repartition<std::uint32_t, decltype(d)> d32;
    const auto product = [&](std::uint32_t factor, auto x)
                             HWY_ATTR { return hn::MulEven(hn::Set(d32, factor), hn::BitCast(d32, x)); };
    for (std::size_t i = 0; i < kPhiloxBlocks; i += hn::Lanes(d)) {
        // Each word in the lower half of a lane; the upper half is ignored.
        const auto counter = hn::Add(hn::Set(d, first + i), hn::Iota(d, 0));
        auto c0 = counter, c1 = hn::ShiftRight<32>(counter);
        auto c2 = hn::Set(d, stream), c3 = hn::Set(d, stream >> 32);
        std::uint32_t k0 = low(seed), k1 = high(seed);
        for (int round = 0; round < kPhiloxRounds; ++round, k0 += kPhiloxSteps[0], k1 += kPhiloxSteps[1]) {
            const auto p0 = product(kPhiloxFactors[0], c0), p1 = product(kPhiloxFactors[1], c2);
            c0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p1), c1), hn::Set(d, std::uint64_t{k0}));
            c2 = hn::Xor(hn::Xor(hn::ShiftRight<32>(p0), c3), hn::Set(d, std::uint64_t{k1}));
            c1 = p1, c3 = p0;
        }
        const auto joined = [&](auto lower, auto upper) HWY_ATTR {
            return hn::Or(hn::And(lower, hn::Set(d, 0xffffffffu)), hn::ShiftLeft<32>(upper));
        };
        hn::StoreInterleaved2(joined(c0, c1), joined(c2, c3), d, numbers + 2 * i);
    }
#endif
}

}  // namespace crofton::sampling::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace crofton::sampling::kernels {

HWY_EXPORT(philox);

void philox(std::uint64_t first, std::uint64_t stream, std::uint64_t seed, std::uint64_t* numbers) {
    HWY_DYNAMIC_DISPATCH(philox)(first, stream, seed, numbers);
}

}  // namespace crofton::sampling::kernels
#endif
