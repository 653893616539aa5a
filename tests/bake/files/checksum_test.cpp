// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/bake/checksum.hpp>
#include <crofton/core/executor.hpp>

#include <random>
#include <set>
#include <vector>

using crofton::bake::checksum;

namespace {

std::vector<std::byte> random_bytes(std::size_t count) {
    std::mt19937 random(3);
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    return bytes;
}

}  // namespace

TEST_SUITE("bake/checksum") {
    TEST_CASE("runs of zeros of different lengths differ, the empty one too") {
        const std::vector<std::byte> zeros(300);
        std::set<std::uint64_t> sums;
        for (std::size_t size = 0; size <= zeros.size(); ++size) sums.insert(checksum(std::span(zeros).first(size)));
        CHECK(sums.size() == zeros.size() + 1);
    }

    TEST_CASE("every flipped bit is seen") {
        auto bytes = random_bytes(333);
        const std::uint64_t sound = checksum(bytes);
        for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
            const auto mask = static_cast<std::byte>(1u << bit % 8);
            bytes[bit / 8] ^= mask;
            CHECK(checksum(bytes) != sound);
            bytes[bit / 8] ^= mask;
        }
    }

    TEST_CASE("words that change places are seen, near and far") {
        auto bytes = random_bytes(4096);
        const std::uint64_t sound = checksum(bytes);
        for (const std::size_t distance : {8u, 64u, 128u, 1024u})
            for (std::size_t i = 0; i + distance + 8 <= bytes.size(); i += 8) {
                std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(i + 8),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(i + distance));
                CHECK(checksum(bytes) != sound);
                std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(i + 8),
                                 bytes.begin() + static_cast<std::ptrdiff_t>(i + distance));
            }
    }

    TEST_CASE("threads do not change the sum") {
        const auto bytes = random_bytes(5'000'001);
        crofton::ThreadPool pool(3);
        CHECK(checksum(bytes, pool) == checksum(bytes));
    }
}
