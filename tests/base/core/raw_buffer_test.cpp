// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <counting_memory.hpp>
#include <crofton/core/paged_vector.hpp>
#include <crofton/core/raw_buffer.hpp>
#include <cstdint>
#include <utility>

using namespace crofton;
using namespace crofton::testing;

TEST_SUITE("core/raw_buffer") {
    TEST_CASE("a buffer keeps what it is told to while it grows, and gives all of its memory back") {
        const CountingMemory memory;
        {
            RawBuffer<std::uint32_t> buffer;
            CHECK(buffer.size() == 0);
            std::uint32_t written = 0;
            for (std::size_t size = 1; size < 5000; size += 1 + size / 3) {
                std::uint32_t* const values = buffer.room(size, written);
                REQUIRE(buffer.size() >= size);
                REQUIRE(buffer.data() == values);
                for (std::uint32_t i = 0; i < written; ++i) REQUIRE(values[i] == 7 * i);
                for (; written < size; ++written) values[written] = 7 * written;
            }
            const std::size_t taken = memory.allocations();
            CHECK(buffer.room(10, 10) == buffer.data());
            CHECK(memory.allocations() == taken);
            RawBuffer<std::uint32_t> moved = std::move(buffer), assigned;
            assigned.room(3);
            assigned = std::move(moved);
            CHECK(assigned.data()[100] == 700);
        }
        CHECK(memory.bytes_in_use() == 0);
    }

    TEST_CASE("a paged vector never moves an element, and takes one page at a time") {
        const CountingMemory memory;
        {
            PagedVector<std::uint64_t, 64> values;
            values.push_back(0);
            const std::uint64_t* const first = &values[0];
            std::size_t most = 0;
            for (std::uint64_t i = 1; i < 10000; ++i) {
                const std::size_t before = memory.bytes_taken();
                values.push_back(i);
                most = std::max(most, memory.bytes_taken() - before);
            }
            CHECK(&values[0] == first);
            for (std::uint64_t i = 0; i < values.size(); ++i) REQUIRE(values[i] == i);
            CHECK(most < 10000);  // a page of 512 bytes, and now and then the list of pages
            values.clear();
            const std::size_t taken = memory.allocations();
            for (std::uint64_t i = 0; i < 10000; ++i) values.push_back(i);
            CHECK(memory.allocations() == taken);
        }
        CHECK(memory.bytes_in_use() == 0);
    }
}
