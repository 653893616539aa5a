// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <counting_memory.hpp>
#include <crofton/core/growing_vector.hpp>
#include <random>
#include <vector>

using crofton::GrowingVector;

TEST_SUITE("core/growing_vector") {
    TEST_CASE("a growing vector holds what a vector holds, whatever is appended, changed and dropped") {
        for (unsigned seed = 0; seed < 20; ++seed) {
            CAPTURE(seed);
            std::mt19937 random(seed);
            GrowingVector<std::uint64_t> growing;
            std::vector<std::uint64_t> plain;
            const auto index = [&] { return random() % plain.size(); };
            bool same = true;
            for (int step = 0; step < 40'000; ++step) {
                const std::uint64_t value = random();
                const unsigned kind = random() % 64;
                if (kind < 24 || plain.empty()) {
                    const std::size_t count = kind == 0 ? random() % 3000 : random() % 4 + 1;
                    growing.append(count, value);
                    plain.insert(plain.end(), count, value);
                } else if (kind < 40) {
                    const std::size_t i = index();
                    growing.edit(i) = plain[i] = value;
                } else if (kind < 56) {
                    const std::size_t i = index();
                    growing.set(i, value);
                    plain[i] = value;
                } else if (kind < 60) {
                    const std::uint32_t some[] = {std::uint32_t(index()), std::uint32_t(index())};
                    std::uint64_t* const values = growing.edit_some(some);
                    for (const std::uint32_t i : some) values[i] = plain[i] = value;
                } else if (kind < 62) {
                    growing.settle();
                } else if (random() % 1000 == 0) {
                    const std::size_t size = index();
                    growing.resize(size);
                    plain.resize(size);
                } else if (random() % 1000 == 0) {
                    growing.finish();
                } else if (random() % 1000 == 0) {
                    const std::size_t i = index();
                    growing.edit_all()[i] = plain[i] = value;
                }
                const std::size_t at = plain.empty() ? 0 : index();
                same = same && growing.size() == plain.size() && (plain.empty() || growing[at] == plain[at]);
                if (step % 997 == 0) same = same && std::equal(growing.begin(), growing.end(), plain.begin());
            }
            CHECK(same);
            CHECK(std::equal(growing.begin(), growing.end(), plain.begin(), plain.end()));
            const GrowingVector<std::uint64_t> moved = std::move(growing);
            CHECK(std::equal(moved.begin(), moved.end(), plain.begin(), plain.end()));
        }
    }

    TEST_CASE("no append of one element to a large growing vector copies all at once") {
        const crofton::testing::CountingMemory memory;
        GrowingVector<std::uint64_t> growing;
        growing.append(100'000, 1);
        std::size_t most = 0, grown = 0;
        for (std::uint64_t i = 0; i < 400'000; ++i) {
            const std::size_t taken = memory.bytes_taken(), in_use = memory.bytes_in_use();
            growing.append(i);
            most = std::max(most, memory.bytes_replaced_since(taken, in_use));
            grown += memory.bytes_taken() > taken;
        }
        CHECK(most == 0);
        CHECK(grown > 10);
        CHECK(growing[100'000] == 0);
        CHECK(growing[499'999] == 399'999);
    }

    TEST_CASE("many elements that are appended at once take room for a 16th more") {
        const crofton::testing::CountingMemory memory;
        GrowingVector<std::uint64_t> growing;
        growing.append(100'000, 1);
        const std::size_t taken = memory.bytes_taken();
        for (std::uint64_t i = 0; i < 2900; ++i) growing.append(i);
        CHECK(memory.bytes_taken() == taken);
        CHECK(memory.bytes_in_use() < 107'000 * sizeof(std::uint64_t));
    }

    TEST_CASE("a growing vector that nothing is appended to any more gives the spare memory back") {
        const crofton::testing::CountingMemory memory;
        GrowingVector<std::uint64_t> growing;
        growing.reserve(100'000);
        growing.append(99'000, 1);
        growing.append(7);
        const std::size_t with_both = memory.bytes_in_use();
        for (int n = 0; n < 1000; ++n) growing.settle();
        CHECK(with_both > 200'000 * sizeof(std::uint64_t));
        CHECK(memory.bytes_in_use() < 120'000 * sizeof(std::uint64_t));
        CHECK(growing[99'000] == 7);
    }

    TEST_CASE("as many elements as pages were reserved for take no memory, and stay where they are") {
        const crofton::testing::CountingMemory memory;
        GrowingVector<std::uint64_t> growing;
        growing.append(50'000, 3);
        growing.reserve_pages(100'000);
        const std::size_t taken = memory.bytes_taken();
        const std::uint64_t* const data = growing.data();
        for (std::uint64_t i = 50'000; i < 100'000; ++i) growing.append(i);
        growing.reserve_pages(99'000);  // as much is there
        CHECK(memory.bytes_taken() == taken);
        CHECK(growing.data() == data);
        CHECK(growing.size() == 100'000);
        CHECK(growing[49'999] == 3);
        CHECK(growing[99'999] == 99'999);
    }
}
