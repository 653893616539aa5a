// SPDX-License-Identifier: MIT
// Lines through the cells, and what the gaps between their crossings witness.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <crofton/bake/checksum.hpp>
#include <crofton/core/recovery.hpp>
#include <utility>

#include "bake_data.hpp"

namespace crofton::pvs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kMaxPairs = std::uint64_t{1} << 34;

template <class T>
T bits_of(const T& word) {
#ifdef __cpp_lib_atomic_ref
    return std::atomic_ref<T>(const_cast<T&>(word)).load(std::memory_order_relaxed);
#else  // libc++ before 19
    return __atomic_load_n(&word, __ATOMIC_RELAXED);
#endif
}

// Bits are only ever set, so the order of threads does not matter.
template <class T>
void set_bits(T& word, T bits) {
    if ((bits_of(word) & bits) == bits) return;
#ifdef __cpp_lib_atomic_ref
    std::atomic_ref<T>(word).fetch_or(bits, std::memory_order_relaxed);
#else
    __atomic_fetch_or(&word, bits, __ATOMIC_RELAXED);
#endif
}

// An object's bit in a cell's row, or none.
struct ObjectBit {
    std::uint32_t word = 0;
    std::uint64_t bit = 0;

    static ObjectBit of(std::uint32_t object) { return {object / 64, std::uint64_t{1} << (object % 64)}; }
    [[nodiscard]] bool is_nothing() const { return bit == 0; }
};

// What is seen from one gap between crossings: the object at each of its ends.
struct Gap {
    double end = 0.0;  // along the line
    ObjectBit behind, ahead;
    std::int32_t depth = 0;         // of solids that the line is in; of gaps that are thin kThin
    std::uint16_t flags = kPassed;  // of CellFlag
};

// One thread's memory.
struct Scratch {
    Vector<Line> lines;
    radiosity::LineHits hits;
    VoxelPaths paths;
    CellSpans spans;
    Vector<Gap> gaps;
};

// Lines of a block go through the tree together.
class BlockTracing {
  public:
    BlockTracing(Bake::State& state, Scratch& scratch) : state_(state), scratch_(scratch) {}

    void trace(std::uint64_t block) {
        static_assert(LinePlan::kBlock % VoxelPaths::kLines == 0);
        state_.plan.draw(block, state_.cells, state_.origin, scratch_.lines);
        const std::span<const Line> lines(scratch_.lines);
        state_.tracer->all_hits(lines, scratch_.hits);
        for (std::size_t i = 0, first = 0; i < lines.size(); ++i) {
            const std::size_t number = i % VoxelPaths::kLines;
            if (number == 0) state_.walk->pass(lines.subspan(i, VoxelPaths::kLines), scratch_.paths);
            const std::size_t end = scratch_.hits.ends[i];
            find_gaps(std::span(scratch_.hits.hits).subspan(first, end - first), i % kEscapeClasses);
            if (state_.walk->is_grid()) {
                witness_along(number);
            } else {
                state_.walk->find(lines[i], scratch_.paths, number, scratch_.spans);
                witness();
            }
            first = end;
        }
    }

  private:
    static constexpr std::int32_t kThin = -0x7fffffff;

    [[nodiscard]] ObjectBit object(const radiosity::Hit& hit) const {
        return ObjectBit::of(state_.object_of[hit.triangle]);
    }

    // Depth is how often the line is inside of something. Take a line that goes in as often as it comes out and has
    // been at two depths at least. It is in a solid where it is deeper than at its least. Others have met what is open,
    // or nothing but sheets at one place: they say nothing. Thin gaps have no say.
    void find_gaps(std::span<const radiosity::Hit> hits, std::size_t line_class) {
        const std::size_t count = hits.size();
        if (scratch_.gaps.size() <= count) scratch_.gaps.resize(2 * count + 1);
        Gap* const gaps = scratch_.gaps.data();
        const bool both = state_.options.sides == occlude::Sides::both;
        std::int32_t depth = 0, least = 0, most = 0;
        ObjectBit behind;
        bool thin = false;
        for (std::size_t h = 0; h < count; ++h) {
            const radiosity::Hit& hit = hits[h];
            const ObjectBit met = object(hit);
            gaps[h] = {static_cast<double>(hit.t), behind, both || hit.front ? met : ObjectBit{}, thin ? kThin : depth};
            // After it has come from a front the line leaves a back behind.
            if (both || !hit.front) behind = met;
            depth += hit.front ? 1 : -1;
            thin = h + 1 < count && hits[h + 1].t - hit.t <= state_.thin;
            least = thin ? least : (std::min)(least, depth);
            most = thin ? most : (std::max)(most, depth);
        }
        gaps[count] = {HUGE_VAL, behind, {}, depth};
        for (std::size_t h = count; h-- > 0 && !both;)
            if (!hits[h].front) gaps[h].ahead = gaps[h + 1].ahead;
        if (depth == 0 && least != most)
            for (std::size_t g = 0; g <= count; ++g)
                gaps[g].flags |= gaps[g].depth == kThin ? 0 : gaps[g].depth == least ? kFree : kSolid;
        const auto escapes = static_cast<std::uint16_t>(kFirstEscape << line_class);
        // What is met on both sides has an object at both ends of all gaps but the outer ones.
        for (std::size_t g = 0; g <= count; g += both && count > 0 ? count : 1) add_escapes(gaps[g], escapes);
    }

    static void add_escapes(Gap& gap, std::uint16_t escapes) {
        if ((gap.behind.is_nothing() || gap.ahead.is_nothing()) && !(gap.flags & kSolid)) gap.flags |= escapes;
    }

    // In a grid: cells and gaps follow each other along the line, and what ends first makes room for the next.
    void witness_along(std::size_t number) {
        const kernels::WalkStep* step = scratch_.paths.steps.data();
        const kernels::WalkStep* const last = step + scratch_.paths.count(number);
        const Gap* gap = scratch_.gaps.data();
        const double thin = static_cast<double>(state_.thin);
        double begin = scratch_.paths.start.begin[number];
        if (step != last)
            while (gap->end < begin) ++gap;
        while (step != last) {
            const double cell_end = step->end[number];
            const double end = (std::min)(gap->end, cell_end);
            if (end - begin > thin) see(step->voxel[number], *gap);
            begin = end;
            const bool gap_ends = gap->end < cell_end;
            gap += gap_ends;
            step += !gap_ends;
        }
    }

    void witness() {
        const auto& gaps = scratch_.gaps;
        std::size_t g = 0;
        for (const CellSpan& span : scratch_.spans.all) {
            if (g > 0 && gaps[g - 1].end >= span.begin) g = 0;  // not in order
            while (gaps[g].end < span.begin) ++g;
            double begin = span.begin;
            for (std::size_t i = g; begin < span.end; ++i) {
                const double end = (std::min)(gaps[i].end, span.end);
                if (end - begin > static_cast<double>(state_.thin)) see(span.cell, gaps[i]);
                begin = end;
            }
        }
    }

    void see(std::uint32_t cell, const Gap& gap) {
        std::uint64_t* const row = state_.found.seen.data() + cell * words_;
        std::uint64_t &behind = row[gap.behind.word], &ahead = row[gap.ahead.word];
        std::uint16_t& flags = state_.found.flags[cell];
        const std::uint64_t fresh = (gap.behind.bit & ~bits_of(behind)) | (gap.ahead.bit & ~bits_of(ahead)) |
                                    static_cast<std::uint64_t>(gap.flags & ~bits_of(flags));
        if (fresh == 0) [[likely]]
            return;
        set_bits(flags, gap.flags);
        set_bits(behind, gap.behind.bit);
        set_bits(ahead, gap.ahead.bit);
    }

    Bake::State& state_;
    Scratch& scratch_;
    std::size_t words_ = state_.found.words();
};

std::uint64_t fingerprint_of(const Subject& subject, const Cells& cells, const BakeOptions& options) {
    Vector<std::uint64_t> sums{pvs::fingerprint_of(subject)};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Aabb box = cells.box(i);
        const ConvexCell convex = cells.corners(i);
        sums.push_back(cells.is_convex() ? bake::checksum(std::as_bytes(std::span(convex.corners)))
                                         : bake::checksum(std::as_bytes(std::span(&box, 1))));
    }
    sums.push_back(options.seed);
    sums.push_back(LinePlan::kVersion);
    return bake::checksum(std::as_bytes(std::span(sums)));
}

Result<void> check(const Subject& subject, const Cells& cells, const BakeOptions& options) {
    const auto within = [](double x) { return x > 0.0 && x < 1.0; };
    if (!within(options.epsilon) || !within(options.confidence))
        return fail(ErrorCode::invalid_argument, kNoItem, "pvs: epsilon and confidence lie between 0 and 1");
    if (cells.size() == 0 || !(cells.bounds().min.x <= cells.bounds().max.x))
        return fail(ErrorCode::empty, kNoItem, "pvs: there are no cells");
    if (subject.object_of.size() != subject.mesh.triangle_count())
        return fail(ErrorCode::invalid_argument, kNoItem, "pvs: each triangle needs an object");
    for (std::size_t t = 0; t < subject.object_of.size(); ++t)
        if (subject.object_of[t] >= subject.boxes.size())
            return fail(ErrorCode::out_of_range, t, "pvs: a triangle's object has no box");
    for (int k = 0; k < 3; ++k)
        if (!(std::abs(subject.origin[k]) <= kMaxCoordinate))
            return fail(ErrorCode::non_finite, kNoItem, "pvs: the origin is not finite");
    if (subject.boxes.size() > 0xffffffffu || cells.size() * subject.boxes.size() > kMaxPairs)
        return fail(ErrorCode::out_of_range, cells.size() * subject.boxes.size(),
                    "pvs: more than 2^34 pairs of a cell and an object: take fewer cells, or put objects together");
    for (std::size_t i = 0; i < subject.boxes.size(); ++i)
        if (auto valid = validate(subject.boxes[i], i); !valid) return valid;
    return {};
}

}  // namespace

Bake::Bake(std::unique_ptr<State> state) : state_(std::move(state)) {}
Bake::~Bake() = default;
Bake::Bake(Bake&&) noexcept = default;
Bake& Bake::operator=(Bake&&) noexcept = default;

Result<Bake> Bake::create(const Subject& subject, const Cells& cells, const BakeOptions& options) {
    return crofton::detail::recover([&]() -> Result<Bake> {
        if (auto checked = check(subject, cells, options); !checked) return tl::unexpected(checked.error());
        auto tracer = radiosity::LineTracer::build(subject.mesh);
        if (!tracer) return tl::unexpected(tracer.error());
        const auto plan = plan_lines(cells, cells.size() * subject.boxes.size(), options);
        if (!plan) return tl::unexpected(plan.error());
        auto state = std::make_unique<State>();
        state->cells = cells;
        state->options = options;
        state->boxes = subject.boxes;
        state->origin = subject.origin;
        state->mesh.positions = subject.mesh.positions;
        state->mesh.indices = subject.mesh.indices;
        state->object_of = subject.object_of;
        state->subject = pvs::fingerprint_of(subject);
        state->plan = *plan;
        state->walk.emplace(cells, subject.origin);
        Found& found = state->found;
        found.name = {fingerprint_of(subject, cells, options),
                      cells.size(),
                      plan->blocks,
                      static_cast<std::uint32_t>(subject.boxes.size()),
                      options.sides == occlude::Sides::both ? 1u : 0u,
                      options.epsilon,
                      options.confidence};
        state->baked.assign(found.words(), 0);
        for (const std::uint32_t o : subject.object_of) state->baked[o / 64] |= std::uint64_t{1} << (o % 64);
        found.flags.assign(cells.size(), 0);
        found.seen.assign(cells.size() * found.words(), 0);
        Aabb all = cells.bounds();
        all.include({tracer->bounds().min + subject.origin, tracer->bounds().max + subject.origin});
        for (int k = 0; k < 3; ++k)
            state->extent = (std::max)(
                {state->extent, std::abs(all.min[k] - subject.origin[k]), std::abs(all.max[k] - subject.origin[k])});
        state->thin = static_cast<float>(2e-6 * state->extent);
        state->tracer.emplace(std::move(*tracer));
        return Bake(std::move(state));
    });
}

Result<void> Bake::run(const RunLimits& limits, Executor& executor) {
    if (limits.shard.count == 0 || limits.shard.index >= limits.shard.count)
        return fail(ErrorCode::invalid_argument, limits.shard.index, "pvs: a shard i/n needs 0 <= i < n");
    return crofton::detail::recover([&]() -> Result<void> {
        Found& found = state_->found;
        const BlockRange shard = blocks_of(limits.shard, state_->plan.blocks);
        const auto start = Clock::now();
        Vector<Scratch> scratch(executor.concurrency());
        std::uint64_t lines = 0;
        // Blocks between two looks at the limits.
        const std::uint64_t wave = 32 * executor.concurrency();
        for (;;) {
            const BlockRange todo = found.done.first_gap(shard, wave);
            const auto done = static_cast<double>(found.done.count_within(shard));
            if (todo.begin >= todo.end || lines >= limits.lines ||
                std::chrono::duration<double>(Clock::now() - start).count() >= limits.seconds ||
                (limits.go_on && !limits.go_on(limits.user, done / static_cast<double>(shard.end - shard.begin))))
                return {};
            crofton::detail::recoverable_for(executor, todo.end - todo.begin, 1,
                                             [&](std::size_t begin, std::size_t end, unsigned worker) {
                                                 BlockTracing tracing(*state_, scratch[worker]);
                                                 for (std::size_t i = begin; i < end; ++i)
                                                     tracing.trace(todo.begin + i);
                                             });
            found.done.add(todo);
            lines += (todo.end - todo.begin) * LinePlan::kBlock;
        }
    });
}

std::uint64_t Bake::lines_planned() const {
    return state_->plan.blocks * LinePlan::kBlock;
}
std::uint64_t Bake::lines_done() const {
    return state_->found.done.count() * LinePlan::kBlock;
}

double Bake::epsilon_reached() const {
    const LinePlan& plan = state_->plan;
    const BlockRanges& done = state_->found.done;
    double lines = 0.0;
    for (std::size_t r = 0; r < plan.rounds.size(); ++r) {
        const LinePlan::Part &first = plan.parts[6 * r], &last = plan.parts[6 * r + 5];
        const BlockRange blocks{first.first, last.first + last.blocks};
        if (done.count_within(blocks) == blocks.end - blocks.begin) lines += plan.rounds[r] * plan.least_share;
    }
    if (!plan.whole) {
        std::uint64_t least = plan.per_cell;
        for (std::uint64_t c = 0; c < state_->cells.size(); ++c)
            least = (std::min)(least, done.count_within({c * plan.per_cell, (c + 1) * plan.per_cell}));
        lines = static_cast<double>(least * LinePlan::kBlock) * plan.own_share;
    }
    const std::uint64_t pairs = state_->cells.size() * state_->boxes.size();
    return epsilon_after(lines, pairs, state_->options.confidence);
}

bool Bake::is_seen(std::size_t cell, std::uint32_t object) const {
    const Found& found = state_->found;
    return found.seen[cell * found.words() + object / 64] >> (object % 64) & 1;
}

Result<Vector<std::byte>> Bake::state() const {
    return crofton::detail::recover([&]() -> Result<Vector<std::byte>> { return to_bytes(state_->found); });
}

Result<void> Bake::add_state(std::span<const std::byte> state) {
    return crofton::detail::recover([&]() -> Result<void> {
        const auto part = found_from(state);
        if (!part) return tl::unexpected(part.error());
        if (!(part->name == state_->found.name))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "this is the state of another bake: scene, cells, epsilon, confidence, seed and sides must be "
                        "the same; remove the file, or give other options");
        add(*part, state_->found);
        return {};
    });
}

}  // namespace crofton::pvs
