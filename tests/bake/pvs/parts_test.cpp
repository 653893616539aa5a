// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <counting_memory.hpp>
#include <crofton/bake/container.hpp>
#include <crofton/pvs/pvs.hpp>
#include <error_of.hpp>
#include <vector>

#include "bake_geometry.hpp"

using namespace crofton;
using namespace crofton::pvs;
using namespace crofton::testing;

namespace {

struct Job {
    BakeGeometry geometry = random_geometry(5, 25);
    Cells cells = Cells::grid({{-10.0, 0.0, -10.0}, {10.0, 3.0, 10.0}}, {10, 2, 10}).value();
    BakeOptions options{.epsilon = 3e-4, .confidence = 0.9};

    [[nodiscard]] Bake start() const { return Bake::create(geometry, cells, options).value(); }
    [[nodiscard]] Vector<std::byte> part(std::uint32_t i, std::uint32_t n) const {
        Bake bake = start();
        REQUIRE(bake.run({.shard = {i, n}}).has_value());
        return bake.state().value();
    }
};

Result<Vector<std::byte>> merged(const std::vector<Vector<std::byte>>& parts) {
    std::vector<std::span<const std::byte>> spans(parts.begin(), parts.end());
    return merge_states(spans);
}

}  // namespace

TEST_SUITE("pvs/parts") {
    TEST_CASE("parts in any order, some of them twice, are the bytes of one run") {
        const Job job;
        Bake whole = job.start();
        REQUIRE(whole.run().has_value());
        const auto expected = plain(whole.state().value());
        for (const std::uint32_t n : {1u, 3u, 7u}) {
            std::vector<Vector<std::byte>> parts;
            for (std::uint32_t i = n; i-- > 0;) parts.push_back(job.part(i, n));
            parts.push_back(parts[n / 2]);
            const auto sum = merged(parts).value();
            CHECK(plain(sum) == expected);
            CHECK(missing_shards(sum, n).value().empty());
        }
        // More parts than there are waves, of which most may be empty.
        std::uint64_t lines = 0;
        for (std::uint32_t i = 0; i < 1000; ++i) {
            Bake bake = job.start();
            REQUIRE(bake.run({.shard = {i, 1000}}).has_value());
            lines += bake.lines_done();
        }
        CHECK(lines == whole.lines_planned());
    }

    TEST_CASE("a part that is lost is named, and running it again repairs the sum") {
        const Job job;
        std::vector<Vector<std::byte>> parts;
        for (const std::uint32_t i : {0u, 1u, 3u, 4u}) parts.push_back(job.part(i, 5));
        auto sum = merged(parts).value();
        const auto missing = missing_shards(sum, 5).value();
        REQUIRE(missing.size() == 1);
        CHECK(missing[0] == 2);
        Bake some = job.start();
        REQUIRE(some.add_state(sum).has_value());
        CHECK_FALSE(some.is_complete());
        CHECK(some.epsilon_reached() > job.options.epsilon);
        parts.push_back(job.part(2, 5));
        sum = merged(parts).value();
        CHECK(missing_shards(sum, 5).value().empty());
        Bake whole = job.start();
        REQUIRE(whole.run().has_value());
        CHECK(plain(sum) == plain(whole.state().value()));
    }

    TEST_CASE("a bake that is stopped anywhere goes on to the same bytes") {
        const Job job;
        Bake whole = job.start();
        REQUIRE(whole.run().has_value());
        const auto expected = plain(whole.state().value());
        Vector<std::byte> kept = job.start().state().value();
        int stops = 0;
        for (bool complete = false; !complete; ++stops) {
            Bake bake = job.start();
            REQUIRE(bake.add_state(kept).has_value());
            int left = 1 + stops % 2;
            const auto should_stop = [](void* user, double) { return --*static_cast<int*>(user) < 0; };
            REQUIRE(bake.run({.should_stop = should_stop, .user = &left}).has_value());
            kept = bake.state().value();
            complete = bake.is_complete();
        }
        CHECK(stops > 2);
        CHECK(plain(kept) == expected);
        Bake none = job.start();
        REQUIRE(none.run({.seconds = 0.0}).has_value());
        CHECK(none.lines_done() == 0);
    }

    TEST_CASE("states that are damaged or of another bake are refused, and nothing changes") {
        const Job job;
        Bake bake = job.start();
        REQUIRE(bake.run({.lines = 1}).has_value());
        const auto state = bake.state().value();
        Job other;
        other.options.seed = 2;
        Bake of_another = other.start();
        CHECK(error_of(of_another.add_state(state)).code == ErrorCode::invalid_argument);
        other = Job{};
        other.geometry.mesh.positions[0].x += 1.0f;
        CHECK(error_of(other.start().add_state(state)).code == ErrorCode::invalid_argument);
        const auto part = of_another.state().value();
        const auto sum = merged({state, part});
        CHECK(sum.error().code == ErrorCode::invalid_argument);
        CHECK(sum.error().item == 1);
        CHECK(error_of(merge_states({})).code == ErrorCode::empty);
        const auto before = plain(bake.state().value());
        for (std::size_t at = 0; at < state.size(); at += 97) {
            Vector<std::byte> damaged = state;
            damaged[at] ^= std::byte{0x10};
            CHECK_FALSE(bake.add_state(damaged).has_value());
        }
        for (const std::size_t size : {std::size_t{0}, std::size_t{63}, state.size() / 2, state.size() - 1})
            CHECK_FALSE(bake.add_state(std::span(state).first(size)).has_value());
        CHECK(plain(bake.state().value()) == before);
        CHECK(error_of(bake.run({.shard = {3, 3}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(bake.run({.shard = {0, 0}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(missing_shards(state, 0)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("forged states with right checksums are refused") {
        const Job job;
        const auto state = job.part(0, 2);
        const auto reader = bake::Reader::open(state).value();
        const auto forged = [&](auto&& change) {
            bake::Writer writer;
            for (const bake::Section& section : reader.sections()) {
                std::vector<std::byte> bytes(
                    state.begin() + static_cast<std::ptrdiff_t>(section.offset),
                    state.begin() + static_cast<std::ptrdiff_t>(section.offset + section.size));
                const std::string_view name(section.name, 8);
                change(name, bytes);
                bytes.resize(bytes.size() / section.element_size * section.element_size);
                writer.add_bytes(name.substr(0, name.find('\0')), bytes, section.element_size, section.version);
            }
            const auto file = writer.finish();
            return job.start().add_state(file).has_value();
        };
        CHECK(forged([](std::string_view, std::vector<std::byte>&) {}));
        for (const char* cut : {"pvs_bake", "pvs_flag", "pvs_seen"})
            CHECK_FALSE(forged([&](std::string_view name, std::vector<std::byte>& bytes) {
                if (name == cut) bytes.pop_back();
            }));
        // Ranges beyond the end, upside down; counts of cells beyond all memory.
        for (const std::size_t byte : {std::size_t{4}, std::size_t{12}, std::size_t{8}})
            CHECK_FALSE(forged([&](std::string_view name, std::vector<std::byte>& bytes) {
                if (name == "pvs_done") bytes[byte] = byte == 8 ? std::byte{0} : std::byte{1};
            }));
        CHECK_FALSE(forged([](std::string_view name, std::vector<std::byte>& bytes) {
            if (name == "pvs_bake") bytes[15] = std::byte{0x80};
        }));
    }

    TEST_CASE("states of very many ranges are read and added up one range at a time") {
        constexpr std::uint64_t kRanges = 100'000;
        struct Header {
            std::uint64_t fingerprint = 0, cells = 1, blocks = std::uint64_t{1} << 40;
            std::uint32_t objects = 1, sides = 0;
            double epsilon = 1e-3, confidence = 0.9;
        };
        // Every fourth block from `first` on.
        const auto state = [](std::uint64_t first, const std::uint16_t flags) {
            const Header header;
            const std::uint64_t seen = 0;
            std::vector<std::uint64_t> ranges;
            for (std::uint64_t i = 0; i < kRanges; ++i)
                for (const std::uint64_t end : {first + 4 * i, first + 4 * i + 1}) ranges.push_back(end);
            bake::Writer writer;
            writer.add("pvs_bake", std::span(&header, 1));
            writer.add_bytes("pvs_done", std::as_bytes(std::span(ranges)), 16, 0);
            writer.add("pvs_flag", std::span(&flags, 1));
            writer.add("pvs_seen", std::span(&seen, 1));
            return writer.finish();
        };
        const auto even = state(0, 1), odd = state(2, 16);
        {
            const CountingMemory memory;
            CHECK(missing_shards(even, 3).value().size() == 3);
            CHECK(memory.allocations() < 100);
        }
        const auto sum = merged({odd, even, odd}).value();
        const auto reader = bake::Reader::open(sum).value();
        CHECK(reader.sections()[1].size == 2 * kRanges * 16);
        CHECK(reader.section<std::uint16_t>("pvs_flag").value()[0] == 17);
    }
}
