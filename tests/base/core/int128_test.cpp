// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/int128.hpp>
#include <random>

using namespace crofton;

#if defined(__SIZEOF_INT128__)
namespace {

__extension__ typedef __int128 Wide;
__extension__ typedef unsigned __int128 UnsignedWide;

template <class Number>
UnsignedWide value_of(const Number& a) {
    return UnsignedWide{a.high} << 64 | a.low;
}

// Words with long runs of zeros and ones, where carries go astray.
std::uint64_t word(std::mt19937_64& random) {
    const std::uint64_t bits = random();
    switch (random() % 5) {
        case 0:
            return bits;
        case 1:
            return bits >> (random() % 64);
        case 2:
            return ~(bits >> (random() % 64));
        case 3:
            return 0;
        default:
            return ~std::uint64_t{0};
    }
}

}  // namespace

TEST_SUITE("core/int128") {
    TEST_CASE("two words give the bits of the compiler's integers: sums, differences, products, order, conversions") {
        std::mt19937_64 random(7);
        for (int trial = 0; trial < 200000; ++trial) {
            const portable::Uint128 a(word(random), word(random)), b(word(random), word(random));
            const portable::Int128 signed_a(a), signed_b(b);
            const UnsignedWide wide_a = value_of(a), wide_b = value_of(b);
            CHECK(value_of(a + b) == wide_a + wide_b);
            CHECK(value_of(a - b) == wide_a - wide_b);
            CHECK(value_of(a * b) == wide_a * wide_b);
            CHECK(value_of(signed_a * signed_b) == wide_a * wide_b);
            CHECK(value_of(~a) == ~wide_a);
            CHECK((a < b) == (wide_a < wide_b));
            CHECK((signed_a < signed_b) == (static_cast<Wide>(wide_a) < static_cast<Wide>(wide_b)));
            CHECK((a == b) == (wide_a == wide_b));
            CHECK(static_cast<std::uint64_t>(a) == static_cast<std::uint64_t>(wide_a));
            CHECK(high_word(signed_a) == static_cast<std::int64_t>(static_cast<Wide>(wide_a) >> 64));
            const auto number = static_cast<std::int64_t>(a.low);
            CHECK(value_of(portable::Int128(number)) == static_cast<UnsignedWide>(Wide{number}));
            CHECK(value_of(portable::Int128(a.low)) == UnsignedWide{a.low});
            CHECK(value_of(portable::Int128(number) * portable::Int128(b.high)) ==
                  static_cast<UnsignedWide>(Wide{number} * static_cast<Wide>(b.high)));
        }
    }
}
#endif
