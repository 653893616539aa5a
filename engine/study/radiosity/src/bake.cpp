// SPDX-License-Identifier: MIT
// Light from chains of runs, which may run anywhere.
#include <algorithm>
#include <chrono>
#include <crofton/core/recovery.hpp>
#include <crofton/radiosity/solver.hpp>

#include "bake_sums.hpp"

namespace crofton::radiosity {
namespace {

using Clock = std::chrono::steady_clock;

// The caller's StopCallback, with the share that is done before a run.
struct Asked {
    const BakeLimits& limits;
    double share;

    static bool should_stop(void* who, double) {
        const Asked& it = *static_cast<const Asked*>(who);
        return it.limits.should_stop != nullptr && it.limits.should_stop(it.limits.user, it.share);
    }
};

}  // namespace

Bake::Bake(Solver solver, std::uint64_t runs) : solver_(std::move(solver)) {
    sums_.fingerprint = solver_.fingerprint();
    sums_.patches = solver_.sum_.size();
    sums_.runs = runs;
}

Result<Bake> Bake::create(const Patches& patches, const SolverOptions& options, std::uint64_t runs) {
    if (runs == 0 || runs > kMostRuns)
        return fail(ErrorCode::out_of_range, kNoItem, "radiosity: a bake has 1 to 2^32 runs");
    return crofton::detail::recover([&]() -> Result<Bake> {
        auto solver = Solver::create(patches, options);
        if (!solver) return solver.error();
        return Bake(std::move(*solver), runs);
    });
}

Result<void> Bake::run(const BakeLimits& limits, Executor& executor) {
    if (limits.shard.count == 0 || limits.shard.index >= limits.shard.count)
        return fail(ErrorCode::invalid_argument, limits.shard.index, "radiosity: a shard i/n needs 0 <= i < n");
    const auto done = crofton::detail::recover([&]() -> Result<void> {
        const ChainRange shard = chains_of(limits.shard, sums_.runs);
        const double all = static_cast<double>(std::max<std::uint64_t>(1, runs_within(shard, sums_.runs)));
        const auto start = Clock::now();
        double found = 0.0;
        bool began = false;
        for (std::uint64_t chain = shard.begin; chain < shard.end; ++chain) {
            const std::uint64_t runs = runs_within({chain, chain + 1}, sums_.runs);
            if (!has_chain(sums_, chain)) {
                if (began && std::chrono::duration<double>(Clock::now() - start).count() >= limits.seconds) break;
                began = true;
                solver_.forget();
                solver_.first_run_ = chain * kRunsOfChain;
                while (solver_.runs() < runs) {
                    Asked asked{limits, (found + static_cast<double>(solver_.runs())) / all};
                    if (!solver_.run(Asked::should_stop, &asked, executor)) return {};
                }
                add({chain, chain + 1, solver_.lines_traced_, solver_.unseen_, solver_.seen_, solver_.sum_,
                     solver_.squares_, solver_.drawn_, solver_.buried_},
                    sums_);
            }
            found += static_cast<double>(runs);
        }
        return {};
    });
    show_sum();
    return done;
}

// From the first chain on, whatever the order they came in.
void Bake::show_sum() {
    solver_.forget();
    for (const Sum& sum : sums_.all) {
        solver_.runs_ += runs_within({sum.begin, sum.end}, sums_.runs);
        solver_.lines_traced_ += sum.lines;
        solver_.unseen_ += sum.unseen;
        solver_.seen_ += sum.seen;
        for (std::size_t i = 0; i < solver_.sum_.size(); ++i) {
            solver_.sum_[i] += sum.light[i];
            solver_.squares_[i] += sum.squares[i];
            solver_.drawn_[i] += sum.drawn[i];
            solver_.buried_[i] += sum.buried[i];
        }
    }
    solver_.update_mean();
}

Result<Vector<std::byte>> Bake::state() const {
    return crofton::detail::recover([&]() -> Result<Vector<std::byte>> { return to_bytes(sums_); });
}

Result<void> Bake::add_state(std::span<const std::byte> state) {
    return crofton::detail::recover([&]() -> Result<void> {
        auto part = sums_from(state);
        if (!part) return part.error();
        if (part->fingerprint != sums_.fingerprint || part->patches != sums_.patches || part->runs != sums_.runs)
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "state of a bake of light: of another scene, other options or another number of runs");
        Sums both = sums_;
        for (Sum& sum : part->all) add(std::move(sum), both);
        sums_ = std::move(both);
        show_sum();
        return {};
    });
}

}  // namespace crofton::radiosity
