// SPDX-License-Identifier: MIT
// Stored sets, states of bakes of sets and of light, checkpoints: forged by somebody who makes their checksums right.
#include <array>
#include <cstring>

#include "demand.hpp"
#include "mend_checksums.hpp"
#include "small_bakes.hpp"

namespace {

using namespace crofton;
using fuzz::demand;

void read_sets(std::span<const std::byte> file) {
    const auto sets = pvs::Pvs::from_memory(file, {.pairs = 1 << 14});
    if (!sets) return;
    Vector<std::uint32_t> kept;
    std::size_t rows = 0;
    for (std::uint32_t c = 0; c < sets->cells().size(); ++c) {
        const glm::dvec3 eye = sets->cells().box(c).center();
        const std::uint32_t found = sets->find_cell(eye);
        demand(found == pvs::kNoCell || found < sets->cells().size(), "an eye's cell is one of them");
        sets->keep_visible(eye, pvs::Mode::conservative, std::array{0u, 1u, sets->object_count()}, kept);
        rows += sets->visible_from(c, pvs::Mode::conservative).size();
        for (std::uint32_t o = 0; o < sets->object_count(); ++o)
            demand(sets->state(c, o) <= pvs::PairState::seen, "a pair has one of three states");
    }
    demand(rows == sets->cells().size() * ((std::size_t{sets->object_count()} + 63) / 64), "each cell has a row");
    const pvs::PairCounts counts = sets->counts();
    demand(counts.all() <= sets->cells().size() * sets->object_count(), "no more pairs are counted than there are");
    const auto again = pvs::Pvs::from_memory(sets->to_file().value());
    demand(again && again->counts().hidden == counts.hidden && again->counts().seen == counts.seen,
           "sets that are written are read as they were");
}

void read_state_of_sets(std::span<const std::byte> state) {
    (void)pvs::missing_shards(state, 7);
    const auto twice = pvs::merge_states(std::array{state, state});
    if (twice)
        demand(pvs::merge_states(std::array<std::span<const std::byte>, 1>{*twice}).has_value(),
               "a sum of states is a state");
    pvs::Bake bake = fuzz::small_bake();
    if (!bake.add_state(state)) return;
    demand(bake.lines_done() <= bake.lines_planned(), "no more lines are done than planned");
    demand(pvs::Pvs::finish(bake).has_value(), "a bake with a state can be finished");
    demand(bake.run().has_value() && bake.is_complete(), "a bake with a state goes on to its end");
}

void read_state_of_light(std::span<const std::byte> state) {
    (void)radiosity::missing_shards(state, 7);
    const auto twice = radiosity::merge_states(std::array{state, state});
    if (twice)
        demand(radiosity::merge_states(std::array<std::span<const std::byte>, 1>{*twice}).has_value(),
               "a sum of states is a state");
    auto bake = radiosity::Bake::create(fuzz::small_patches(), fuzz::small_options(), fuzz::kSmallRuns).value();
    if (!bake.add_state(state)) return;
    demand(bake.runs_done() <= bake.runs_planned(), "no more runs are done than planned");
    demand(bake.run().has_value() && bake.is_complete(), "a bake with a state goes on to its end");
}

void read_checkpoint(std::span<const std::byte> state) {
    auto solver = radiosity::Solver::create(fuzz::small_patches(), fuzz::small_options()).value();
    if (!solver.resume(state)) return;
    (void)solver.relative_error();
    (void)solver.share_within(0.1);
    solver.run();
}

// FNV-1a from the first eight bytes on, which name the format.
void mend_hash(std::span<std::byte> state) {
    if (state.size() < 16) return;
    const std::size_t size = state.size() - 8;
    std::uint64_t hash = 0;
    std::memcpy(&hash, state.data(), 8);
    for (const std::byte b : state.first(size)) hash = (hash ^ static_cast<std::uint64_t>(b)) * 1099511628211u;
    std::memcpy(state.data() + size, &hash, 8);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    Vector<std::byte> state(size - 1);
    if (size > 1) std::memcpy(state.data(), data + 1, size - 1);
    switch (data[0] % 4) {
        case 0:
            fuzz::mend_checksums(state);
            return read_sets(state), 0;
        case 1:
            fuzz::mend_checksums(state);
            return read_state_of_sets(state), 0;
        case 2:
            mend_hash(state);
            return read_state_of_light(state), 0;
        default:
            mend_hash(state);
            return read_checkpoint(state), 0;
    }
}
