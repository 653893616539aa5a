// SPDX-License-Identifier: MIT
// Lines through the cells, and what the gaps between their crossings witness.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <crofton/bake/checksum.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/geometry/finite.hpp>
#include <utility>

#include "bake_data.hpp"

namespace crofton::pvs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kShortWave = std::chrono::milliseconds(50);
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

// What is seen from one gap between crossings: the object at each of its ends, as a bit of a cell's row, or none. There
// is no struct for such a bit: g++ builds it on the stack, and waits to read it from there.
struct Gap {
    double end = 0.0;  // along the line
    std::uint64_t behind_bit = 0, ahead_bit = 0;
    std::uint32_t behind_word = 0, ahead_word = 0;
    std::int32_t depth = 0;   // of solids that the line is in; of gaps that are thin kThin
    std::uint32_t flags = 0;  // of CellFlag
};

// One thread's memory.
struct Scratch {
    Vector<Line> lines;
    lines::LineHits hits;
    VoxelPaths paths;
    CellSpans spans;
    std::array<Vector<Gap>, 2> gaps;  // of two lines
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
        for (std::size_t i = 0; i < lines.size(); i += 2) {
            const std::size_t number = i % VoxelPaths::kLines;
            if (number == 0) state_.walk->pass(lines.subspan(i, VoxelPaths::kLines), scratch_.paths);
            find_gaps(i, scratch_.gaps[0]);
            find_gaps(i + 1, scratch_.gaps[1]);
            if (state_.walk->is_grid()) {
                witness_along(number);
                continue;
            }
            for (std::size_t k = 0; k < 2; ++k) {
                state_.walk->find(lines[i + k], scratch_.paths, number + k, scratch_.spans);
                witness(scratch_.gaps[k]);
            }
        }
    }

  private:
    static constexpr std::int32_t kThin = -0x7fffffff;

    // Depth is how often the line is inside of something. Take a line that goes in as often as it comes out and has
    // been at two depths at least. It is in a solid where it is deeper than at its least. Others have met what is open,
    // or nothing but sheets at one place: they say nothing. Thin gaps have no say.
    void find_gaps(std::size_t line, Vector<Gap>& result) {
        const std::size_t first = line == 0 ? 0 : scratch_.hits.ends[line - 1];
        const std::size_t count = scratch_.hits.ends[line] - first;
        const lines::Hit* const hits = scratch_.hits.hits.data() + first;
        if (result.size() <= count) result.resize(2 * count + 1);
        Gap* const gaps = result.data();
        const bool both = state_.options.sides == occlude::Sides::both;
        std::int32_t depth = 0, least = 0, most = 0;
        std::uint64_t behind_bit = 0;
        std::uint32_t behind_word = 0;
        bool thin = false;
        for (std::size_t h = 0; h < count; ++h) {
            const lines::Hit& hit = hits[h];
            const std::uint32_t object = state_.object_of[hit.triangle], word = object / 64;
            const std::uint64_t bit = std::uint64_t{1} << (object % 64);
            Gap& gap = gaps[h];
            gap.end = static_cast<double>(hit.t);
            gap.behind_bit = behind_bit, gap.behind_word = behind_word;
            gap.ahead_bit = both || hit.front ? bit : 0, gap.ahead_word = word;
            gap.depth = thin ? kThin : depth;
            gap.flags = kPassed;
            // After it has come from a front the line leaves a back behind.
            if (both || !hit.front) behind_bit = bit, behind_word = word;
            depth += hit.front ? 1 : -1;
            thin = h + 1 < count && hits[h + 1].t - hit.t <= state_.thin;
            least = thin ? least : (std::min)(least, depth);
            most = thin ? most : (std::max)(most, depth);
        }
        gaps[count] = {HUGE_VAL, behind_bit, 0, behind_word, 0, depth, kPassed};
        for (std::size_t h = count; h-- > 0 && !both;)
            if (!hits[h].front) gaps[h].ahead_bit = gaps[h + 1].ahead_bit, gaps[h].ahead_word = gaps[h + 1].ahead_word;
        if (depth == 0 && least != most)
            for (std::size_t g = 0; g <= count; ++g)
                if (gaps[g].depth != kThin) gaps[g].flags |= gaps[g].depth == least ? kFree : kSolid;
        const std::uint32_t escapes = static_cast<std::uint32_t>(kFirstEscape) << line % kEscapeClasses;
        // Objects that are hit from both sides are at both ends of all gaps but the outer ones.
        for (std::size_t g = 0; g <= count; g += both && count > 0 ? count : 1) add_escapes(gaps[g], escapes);
    }

    static void add_escapes(Gap& gap, std::uint32_t escapes) {
        if ((gap.behind_bit == 0 || gap.ahead_bit == 0) && !(gap.flags & kSolid)) gap.flags |= escapes;
    }

    // A line's cells and gaps, side by side.
    struct Way {
        const kernels::WalkStep *step, *last;
        const Gap* gap;
        double begin;
        std::size_t number;

        Way(const VoxelPaths& paths, std::size_t line, const Vector<Gap>& gaps)
            : step(paths.steps.data()),
              last(step + paths.count(line)),
              gap(gaps.data()),
              begin(paths.start.begin[line]),
              number(line) {
            if (step != last)
                while (gap->end < begin) ++gap;
        }
        [[nodiscard]] bool is_done() const { return step == last; }
    };

    // In a grid: cells and gaps follow each other along the line, and what ends first makes room for the next. Two
    // lines in turn: each step of a line waits for the one before.
    void witness_along(std::size_t number) {
        Way a(scratch_.paths, number, scratch_.gaps[0]), b(scratch_.paths, number + 1, scratch_.gaps[1]);
        while (!a.is_done() && !b.is_done()) {
            go_on(a);
            go_on(b);
        }
        while (!a.is_done()) go_on(a);
        while (!b.is_done()) go_on(b);
    }

    void go_on(Way& way) {
        const double cell_end = way.step->end[way.number];
        const double end = (std::min)(way.gap->end, cell_end);
        if (end - way.begin > static_cast<double>(state_.thin)) see(way.step->voxel[way.number], *way.gap);
        way.begin = end;
        const bool gap_ends = way.gap->end < cell_end;
        way.gap += gap_ends;
        way.step += !gap_ends;
    }

    void witness(const Vector<Gap>& gaps) {
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
        std::uint64_t &behind = row[gap.behind_word], &ahead = row[gap.ahead_word];
        std::uint16_t& flags = state_.found.flags[cell];
        const std::uint64_t fresh = (gap.behind_bit & ~bits_of(behind)) | (gap.ahead_bit & ~bits_of(ahead)) |
                                    (gap.flags & ~std::uint32_t{bits_of(flags)});
        if (fresh == 0) [[likely]]
            return;
        set_bits(flags, static_cast<std::uint16_t>(gap.flags));
        set_bits(behind, gap.behind_bit);
        set_bits(ahead, gap.ahead_bit);
    }

    Bake::State& state_;
    Scratch& scratch_;
    std::size_t words_ = state_.found.words();
};

std::uint64_t fingerprint_of(const BakeGeometry& geometry, const Cells& cells, const BakeOptions& options) {
    Vector<std::uint64_t> sums{pvs::fingerprint_of(geometry)};
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

Result<void> check(const BakeGeometry& geometry, const Cells& cells, const BakeOptions& options) {
    const auto within = [](double x) { return x > 0.0 && x < 1.0; };
    if (!within(options.epsilon) || !within(options.confidence))
        return fail(ErrorCode::invalid_argument, kNoItem, "pvs: epsilon and confidence lie between 0 and 1");
    if (cells.size() == 0 || !(cells.bounds().min.x <= cells.bounds().max.x))
        return fail(ErrorCode::empty, kNoItem, "pvs: there are no cells");
    if (geometry.object_of.size() != geometry.mesh.triangle_count())
        return fail(ErrorCode::invalid_argument, kNoItem, "pvs: each triangle needs an object");
    for (std::size_t t = 0; t < geometry.object_of.size(); ++t)
        if (geometry.object_of[t] >= geometry.boxes.size())
            return fail(ErrorCode::out_of_range, t, "pvs: a triangle's object has no box");
    if (!is_in_range(geometry.origin)) return fail(ErrorCode::non_finite, kNoItem, "pvs: the origin is not finite");
    if (geometry.boxes.size() > 0xffffffffu || cells.size() * geometry.boxes.size() > kMaxPairs)
        return fail(ErrorCode::out_of_range, cells.size() * geometry.boxes.size(),
                    "pvs: more than 2^34 pairs of a cell and an object: take fewer cells, or put objects together");
    for (std::size_t i = 0; i < geometry.boxes.size(); ++i)
        if (auto valid = validate(geometry.boxes[i], i); !valid) return valid;
    return {};
}

}  // namespace

Bake::Bake(std::unique_ptr<State> state) : state_(std::move(state)) {}
Bake::~Bake() = default;
Bake::Bake(Bake&&) noexcept = default;
Bake& Bake::operator=(Bake&&) noexcept = default;

Result<Bake> Bake::create(const BakeGeometry& geometry, const Cells& cells, const BakeOptions& options) {
    return crofton::detail::recover([&]() -> Result<Bake> {
        if (auto checked = check(geometry, cells, options); !checked) return checked.error();
        auto tracer = lines::LineTracer::build(geometry.mesh);
        if (!tracer) return tracer.error();
        const auto plan = plan_lines(cells, cells.size() * geometry.boxes.size(), options);
        if (!plan) return plan.error();
        auto state = std::make_unique<State>();
        state->cells = cells;
        state->options = options;
        state->boxes = geometry.boxes;
        state->origin = geometry.origin;
        state->mesh.positions = geometry.mesh.positions;
        state->mesh.indices = geometry.mesh.indices;
        state->object_of = geometry.object_of;
        state->geometry = pvs::fingerprint_of(geometry);
        state->plan = *plan;
        state->walk.emplace(cells, geometry.origin);
        Found& found = state->found;
        found.name = {fingerprint_of(geometry, cells, options),
                      cells.size(),
                      plan->blocks,
                      static_cast<std::uint32_t>(geometry.boxes.size()),
                      options.sides == occlude::Sides::both ? 1u : 0u,
                      options.epsilon,
                      options.confidence};
        state->baked.assign(found.words(), 0);
        for (const std::uint32_t o : geometry.object_of) state->baked[o / 64] |= std::uint64_t{1} << (o % 64);
        found.flags.assign(cells.size(), 0);
        found.seen.assign(cells.size() * found.words(), 0);
        Aabb all = cells.bounds();
        all.include({tracer->bounds().min + geometry.origin, tracer->bounds().max + geometry.origin});
        for (int k = 0; k < 3; ++k)
            state->extent = (std::max)(
                {state->extent, std::abs(all.min[k] - geometry.origin[k]), std::abs(all.max[k] - geometry.origin[k])});
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
        // Blocks between two looks at the limits. Where somebody waits for these, as few as take a moment.
        const std::uint64_t most = 32 * std::uint64_t{executor.concurrency()};
        const bool is_awaited = limits.should_stop != nullptr || std::isfinite(limits.seconds);
        std::uint64_t wave = is_awaited && limits.lines == RunLimits{}.lines ? executor.concurrency() : most;
        for (;;) {
            const auto wave_start = Clock::now();
            const BlockRange todo = found.done.first_gap(shard, wave);
            const auto done = static_cast<double>(found.done.count_within(shard));
            if (todo.begin >= todo.end || lines >= limits.lines ||
                std::chrono::duration<double>(Clock::now() - start).count() >= limits.seconds ||
                (limits.should_stop &&
                 limits.should_stop(limits.user, done / static_cast<double>(shard.end - shard.begin))))
                return {};
            crofton::detail::recoverable_for(executor, todo.end - todo.begin, 1,
                                             [&](std::size_t begin, std::size_t end, unsigned worker) {
                                                 BlockTracing tracing(*state_, scratch[worker]);
                                                 for (std::size_t i = begin; i < end; ++i)
                                                     tracing.trace(todo.begin + i);
                                             });
            found.done.add(std::span(&todo, 1));
            lines += (todo.end - todo.begin) * LinePlan::kBlock;
            if (Clock::now() - wave_start < kShortWave) wave = (std::min)(2 * wave, most);
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
        if (!part) return part.error();
        if (!(part->name == state_->found.name))
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "this is the state of another bake: scene, cells, epsilon, confidence, seed and sides must be "
                        "the same; remove the file, or give other options");
        add(*part, state_->found);
        return {};
    });
}

}  // namespace crofton::pvs
