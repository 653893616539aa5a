// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <crofton/radiosity/patches.hpp>
#include <crofton/radiosity/solver.hpp>
#include <cstring>
#include <error_of.hpp>
#include <vector>

#include "../../../engine/study/radiosity/src/fnv1a.hpp"
#include "shapes.hpp"

using namespace crofton;
using namespace crofton::lines;
using namespace crofton::radiosity;

namespace {

std::vector<std::byte> plain(const Vector<std::byte>& bytes) {
    return {bytes.begin(), bytes.end()};
}

// A box of which one side glows, with a sphere that is half sunk into the floor.
struct Job {
    Patches patches;
    SolverOptions options;
    std::uint64_t runs;

    explicit Job(std::uint64_t number = 43) : runs(number) {
        shapes::Shape shape;
        shape.room({0, 0, 0}, {3, 1, 2}, 0);
        shape.sphere({1.5f, 0.0f, 1}, 0.3f, 6, false, 6);
        std::vector<Material> materials(7, {glm::vec3(0.0f), glm::vec3(0.5f)});
        materials[2].emission = {1.0f, 0.8f, 0.6f};
        patches = make_patches(shape.mesh, shape.patches, materials).value();
        options.lines = 1 << 9;
        options.first_shot = 1 << 8;
    }
    [[nodiscard]] Bake start() const { return Bake::create(patches, options, runs).value(); }
    [[nodiscard]] Vector<std::byte> part(std::uint32_t i, std::uint32_t n) const {
        Bake bake = start();
        REQUIRE(bake.run({.shard = {i, n}}).has_value());
        return bake.state().value();
    }
    [[nodiscard]] Vector<std::byte> whole() const { return part(0, 1); }
};

Result<Vector<std::byte>> merged(const std::vector<Vector<std::byte>>& parts) {
    std::vector<std::span<const std::byte>> spans(parts.begin(), parts.end());
    return merge_states(spans);
}

}  // namespace

TEST_SUITE("radiosity/bake") {
    TEST_CASE("parts in any order, some of them twice, are the bytes of one run") {
        const Job job;  // six chains, the last of three runs
        const auto expected = plain(job.whole());
        for (const std::uint32_t n : {1u, 2u, 3u, 4u, 5u, 9u}) {
            std::vector<Vector<std::byte>> parts;
            for (std::uint32_t i = n; i-- > 0;) parts.push_back(job.part(i, n));
            parts.push_back(parts[n / 2]);
            const auto sum = merged(parts).value();
            CHECK(plain(sum) == expected);
            CHECK(missing_shards(sum, n).value().empty());
        }
        // Sums of sums, and parts of two splits that overlap.
        std::vector<Vector<std::byte>> parts;
        for (std::uint32_t i = 0; i < 4; ++i) parts.push_back(job.part(i, 4));
        parts.push_back(job.part(1, 3));
        parts.push_back(merged({parts[2], parts[0]}).value());
        CHECK(plain(merged(parts).value()) == expected);
    }

    TEST_CASE("a part that is lost is named, and running it again repairs the sum") {
        const Job job;
        std::vector<Vector<std::byte>> parts{job.part(0, 3), job.part(2, 3)};
        auto sum = merged(parts).value();
        CHECK(plain(sum) != plain(job.whole()));
        const auto missing = missing_shards(sum, 3).value();
        REQUIRE(missing.size() == 1);
        CHECK(missing[0] == 1);
        Bake some = job.start();
        REQUIRE(some.add_state(sum).has_value());
        CHECK_FALSE(some.is_complete());
        CHECK(some.runs_done() == 27);
        REQUIRE(some.run().has_value());
        CHECK(some.is_complete());
        CHECK(plain(some.state().value()) == plain(job.whole()));
    }

    TEST_CASE("the same bytes for any number of threads, and wherever the bake was stopped") {
        const Job job;
        const auto expected = plain(job.whole());
        ThreadPool pool(4);
        Bake parallel = job.start();
        REQUIRE(parallel.run({}, pool).has_value());
        CHECK(plain(parallel.state().value()) == expected);
        // Stopped in run 20, amid the third chain: two chains are kept.
        double planned = static_cast<double>(job.runs);
        const auto should_stop = [](void* user, double share) { return share * *static_cast<double*>(user) >= 18.5; };
        Bake stopped = job.start();
        REQUIRE(stopped.run({.should_stop = should_stop, .user = &planned}).has_value());
        CHECK(stopped.runs_done() == 16);
        Bake again = job.start();
        REQUIRE(again.add_state(stopped.state().value()).has_value());
        // A chain at a time.
        while (!again.is_complete()) REQUIRE(again.run({.seconds = 0.0}).has_value());
        CHECK(plain(again.state().value()) == expected);
        CHECK(again.solver().lines_traced() == parallel.solver().lines_traced());
        CHECK(again.solver().relative_error() == parallel.solver().relative_error());
    }

    TEST_CASE("the first chain is what a solver finds, and the light of all chains is as bright") {
        Job job(kRunsOfChain);
        auto solver = Solver::create(job.patches, job.options).value();
        for (std::uint64_t i = 0; i < kRunsOfChain; ++i) solver.run();
        Bake first = job.start();
        REQUIRE(first.run().has_value());
        CHECK(std::memcmp(first.solver().radiosity().data(), solver.radiosity().data(),
                          solver.radiosity().size_bytes()) == 0);
        CHECK(first.solver().relative_error() == solver.relative_error());
        CHECK(first.solver().unseen() == solver.unseen());
        double exposed = 1.0;
        for (std::size_t i = 0; i < job.patches.count(); ++i) {
            CHECK(first.solver().exposed_share(i) == solver.exposed_share(i));
            exposed = std::min(exposed, solver.exposed_share(i));
        }
        CHECK(exposed < 1.0);

        job.runs = 160;
        for (int i = 0; i < 152; ++i) solver.run();
        Bake bake = job.start();
        REQUIRE(bake.run().has_value());
        CHECK(bake.solver().runs() == 160);
        CHECK(bake.solver().relative_error() < 0.6 * first.solver().relative_error());
        for (std::size_t i = 0; i < job.patches.count(); ++i)
            CHECK(bake.solver().radiosity()[i].x == doctest::Approx(solver.radiosity()[i].x).epsilon(0.03));
    }

    TEST_CASE("no two chains are alike") {
        const Job job(3 * kRunsOfChain);
        std::vector<Vector<glm::vec3>> found;
        for (std::uint32_t i = 0; i < 3; ++i) {
            Bake bake = job.start();
            REQUIRE(bake.run({.shard = {i, 3}}).has_value());
            const auto light = bake.solver().radiosity();
            found.emplace_back(light.begin(), light.end());
            for (std::uint32_t j = 0; j < i; ++j)
                for (std::size_t k = 0; k < light.size(); ++k) CHECK(found[j][k] != light[k]);
        }
    }

    TEST_CASE("shards that are none, no runs, damaged states and those of other bakes are refused") {
        const Job job;
        CHECK(error_of(Bake::create(job.patches, job.options, 0)).code == ErrorCode::out_of_range);
        CHECK(error_of(Bake::create(job.patches, job.options, (std::uint64_t{1} << 32) + 1)).code ==
              ErrorCode::out_of_range);
        Bake bake = job.start();
        CHECK(error_of(bake.run({.shard = {2, 2}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(bake.run({.shard = {0, 0}})).code == ErrorCode::invalid_argument);
        CHECK(error_of(merge_states({})).code == ErrorCode::empty);
        CHECK(bake.solver().runs() == 0);
        const auto empty = bake.state().value();
        CHECK(is_bake_state(empty));
        CHECK(bake.add_state(empty).has_value());
        CHECK(missing_shards(empty, 2).value().size() == 2);
        CHECK(error_of(missing_shards(empty, 0)).code == ErrorCode::invalid_argument);

        auto state = job.part(0, 2);
        for (std::size_t i = 0; i < state.size(); i += 97) {
            state[i] ^= std::byte{4};
            CHECK(error_of(bake.add_state(state)).code == ErrorCode::parse);
            state[i] ^= std::byte{4};
        }
        for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{40}, state.size() - 1})
            CHECK(error_of(bake.add_state(std::span(state).first(size))).code == ErrorCode::parse);
        CHECK(bake.solver().runs() == 0);
        Job other = job;
        other.options.seed = 2;
        CHECK(error_of(other.start().add_state(state)).code == ErrorCode::invalid_argument);
        CHECK(error_of(Job(42).start().add_state(state)).code == ErrorCode::invalid_argument);
        const auto refused = merged({state, other.part(1, 2)});
        CHECK(error_of(refused).code == ErrorCode::invalid_argument);
        CHECK(error_of(refused).item == 1);
        CHECK(bake.add_state(state).has_value());
        CHECK(bake.runs_done() == 24);
    }

    TEST_CASE("forged states with right checksums are refused where their chains are none, or do not ascend") {
        const Job job;
        const auto state = job.part(0, 2);  // chains 0 and 1 in one sum, 2 in another
        // Words of 64 bits: the magic number, the fingerprint, patches, runs, sums; then each sum, which begins with
        // the range of its chains; the checksum.
        constexpr std::size_t kHeader = 5;
        std::vector<std::uint64_t> words(state.size() / 8);
        std::memcpy(words.data(), state.data(), state.size());
        REQUIRE(words[kHeader - 1] == 2);
        const std::size_t length = (words.size() - kHeader - 1) / 2;
        const auto taken = [&](auto&& change) {
            std::vector<std::uint64_t> forged = words;
            change(forged);
            forged.back() = fnv1a(forged[0], std::as_bytes(std::span(forged).first(forged.size() - 1)));
            return job.start().add_state(std::as_bytes(std::span(forged))).has_value();
        };
        const auto range = [&](std::size_t sum, std::uint64_t begin, std::uint64_t end) {
            return [=](std::vector<std::uint64_t>& forged) {
                forged[kHeader + sum * length] = begin;
                forged[kHeader + sum * length + 1] = end;
            };
        };
        CHECK(taken([](auto&) {}));
        CHECK(taken(range(1, 3, 4)));
        CHECK_FALSE(taken(range(1, 3, 5)));  // no node: two that begin at an odd one
        CHECK_FALSE(taken(range(1, 4, 8)));  // beyond the last chain
        CHECK_FALSE(taken(range(1, 3, 3)));
        CHECK_FALSE(taken(range(1, 1, 2)));  // a node, and part of the one before
        CHECK_FALSE(taken([&](std::vector<std::uint64_t>& forged) {
            const auto first = forged.begin() + kHeader, second = first + static_cast<std::ptrdiff_t>(length);
            std::swap_ranges(first, second, second);
        }));
    }
}
