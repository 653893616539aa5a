#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/core/assert.hpp>
#include <crofton/cull/bound_set.hpp>
#include <mutex>

#include "box_constraints.hpp"
#include "list_kernel.hpp"
#include "query.hpp"
#include "records.hpp"

namespace crofton::cull {
namespace {

// A radius of 4096 to 8192 quanta for a typical bound leaves room for others that are larger, and lets the centres'
// extent choose the quantum wherever the chunk is wider than some ten bounds.
constexpr double kTypicalRadius = 4096.0;
// So many strays more than when a chunk was laid out, and it is laid out anew.
constexpr std::uint32_t kTooManyStrays = kChunk / 16;

void clear_row(RowBlock& block, std::size_t lane) {
    block.xy[lane] = 0;
    block.zr[lane] = kUnboundedRadius << 16;
}

bool is_stray(const RowBlock& block, std::size_t lane) {
    return block.zr[lane] >> 16 == kUnboundedRadius;
}

// False if the row must say nothing.
bool write_row(RowBlock& block, std::size_t lane, const glm::dvec3& offset, double radius, ListChunk& chunk) {
    std::int32_t at[3];
    for (int j = 0; j < 3; ++j) {
        const double scaled = std::nearbyint(offset[j] / chunk.quantum);
        if (!(std::fabs(scaled) <= kMaxRowCoordinate)) return false;
        at[j] = static_cast<std::int32_t>(scaled);
    }
    const double size = std::ceil(radius * (1.0 + 0x1p-9) / chunk.quantum) + 1.0;
    if (!(size < kUnboundedRadius)) return false;
    const auto half = [](std::int32_t value) { return static_cast<std::uint32_t>(value) & 0xffffu; };
    const auto whole = static_cast<std::uint32_t>(size);
    block.xy[lane] = half(at[0]) | half(at[1]) << 16;
    block.zr[lane] = half(at[2]) | whole << 16;
    for (int j = 0; j < 3; ++j) chunk.extent[j] = std::max(chunk.extent[j], std::abs(at[j]));
    chunk.largest_radius = std::max(chunk.largest_radius, whole);
    return true;
}

}  // namespace

template <class Bound>
void BoundSet<Bound>::assign(std::span<const Bound> bounds, Executor& executor) {
    size_ = bounds.size();
    rows_.resize((size_ + 63) / 64 * 4);  // whole words of verdicts
    records_.resize(size_);
    chunks_.resize((size_ + kChunk - 1) / kChunk);
    executor.parallel_for(chunks_.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = begin; c < end; ++c) assign_chunk(c, bounds);
    });
    for (std::size_t i = size_; i < rows_.size() * 16; ++i) clear_row(rows_[i / 16], i % 16);
}

template <class Bound>
void BoundSet<Bound>::assign_chunk(std::size_t c, std::span<const Bound> bounds) {
    const std::size_t first = c * kChunk, last = std::min(size_, first + kChunk);
    ListChunk& chunk = chunks_[c];
    chunk = {};
    Aabb centers;
    double exponents = 0.0;
    std::size_t usable = 0;
    for (std::size_t i = first; i < last; ++i) {
        clear_row(rows_[i / 16], i % 16);
        if (!is_usable(bounds[i])) continue;
        const Sphere ball = ball_around(bounds[i]);
        centers.include(ball.center);
        exponents += std::ilogb(std::max(ball.radius, 1e-30));
        ++usable;
    }
    double extent = 1e-30;
    for (int j = 0; usable > 0 && j < 3; ++j) {
        chunk.origin[j] = centers.center()[j];
        extent = std::max({extent, centers.max[j] - chunk.origin[j], chunk.origin[j] - centers.min[j]});
    }
    const double typical = usable > 0 ? std::exp2(std::floor(exponents / static_cast<double>(usable))) : 0.0;
    const double quantum = std::max(extent * 1.0001 / kMaxRowCoordinate, typical / kTypicalRadius);
    chunk.quantum = std::exp2(std::ilogb(quantum) + 1);
    chunk.strays = static_cast<std::uint32_t>(last - first);
    for (std::size_t i = first; i < last; ++i) write(i, bounds[i]);
    chunk.accepted_strays = chunk.strays;
}

template <class Bound>
void BoundSet<Bound>::update(std::span<const std::uint32_t> items, std::span<const Bound> bounds) {
    CROFTON_ASSERT(bounds.size() == size_, "update needs all bounds of the set");
    for (const std::uint32_t i : items) {
        write(i, bounds[i]);
        const ListChunk& chunk = chunks_[i / kChunk];
        if (chunk.strays >= chunk.accepted_strays + kTooManyStrays) assign_chunk(i / kChunk, bounds);
    }
}

template <class Bound>
void BoundSet<Bound>::write(std::size_t i, const Bound& bound) {
    RowBlock& block = rows_[i / 16];
    ListChunk& chunk = chunks_[i / kChunk];
    if (is_stray(block, i % 16)) --chunk.strays;
    bool bounded = false;
    if (is_usable(bound)) {
        const Sphere ball = ball_around(bound);
        const glm::dvec3 offset = ball.center - glm::dvec3(chunk.origin[0], chunk.origin[1], chunk.origin[2]);
        records_[i] = record_of(bound, offset);
        const double reach = std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z);
        chunk.reach = std::max(chunk.reach, static_cast<float>(reach * (1.0 + 0x1p-20)));
        bounded = write_row(block, i % 16, offset, ball.radius, chunk);
    } else {
        records_[i] = undecidable_record<Record>();
    }
    if (bounded) return;
    clear_row(block, i % 16);
    chunk.largest_radius = kUnboundedRadius;
    ++chunk.strays;
}

namespace {

template <class Bound>
struct ListQuery {
    const BoundSet<Bound>& set;
    std::span<const Bound> bounds;
    Mode mode;

    // Verdicts of chunk c, and what they cost.
    Statistics run(std::size_t c, const View& view, const KernelView& kernel_view, bool usable, bool vectors,
                   ListKernelOutput& output) const {
        const std::size_t first = c * kChunk, count = std::min(kChunk, set.size() - first);
        if (vectors) {
            const ListKernelInput<typename BoundSet<Bound>::Record> input{
                &set.rows()[first / 16], &set.records()[first], &set.chunks()[c], &kernel_view, count,
                mode == Mode::exact};
            run_list_kernel(input, output);
        } else {
            output.settled_count = output.improper = 0;
            output.open = output.undecided_count = count;
            for (std::size_t i = 0; i < count; ++i) output.undecided[i] = static_cast<std::uint32_t>(i);
            std::fill_n(output.visible, (count + 63) / 64, 0);
            std::fill_n(output.inside, (count + 63) / 64, 0);
        }
        Statistics statistics;
        if (kCountStatistics) {
            statistics.boxes_tested = count;
            statistics.exact_tests = output.settled_count + output.undecided_count;
            statistics.improper = output.improper;
            statistics.straddling = output.open;
        }
        for (std::size_t n = 0; n < output.undecided_count; ++n) {
            const std::uint32_t i = output.undecided[n];
            decide(view, usable, bounds[first + i], i, output, statistics);
        }
        return statistics;
    }

    void decide(const View& view, bool usable, const Bound& bound, std::uint32_t i, ListKernelOutput& output,
                Statistics& statistics) const {
        const Verdict verdict =
            usable && is_usable(bound) ? classify_usable(view.frustum, bound, mode) : Verdict::straddling;
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        output.visible[i / 64] &= ~bit;
        output.inside[i / 64] &= ~bit;
        if (verdict != Verdict::outside) output.visible[i / 64] |= bit;
        if (verdict == Verdict::inside) output.inside[i / 64] |= bit;
        if (!kCountStatistics || verdict == Verdict::straddling) return;
        --statistics.straddling;
        statistics.improper += mode == Mode::exact && verdict == Verdict::outside &&
                               classify_usable(view.frustum, bound, Mode::conservative) != Verdict::outside;
    }
};

// What vectors can take. Without planes nothing would tell invalid bounds from others; beyond 1e32 their slack would
// not.
bool takes_vectors(const Frustum& frustum) {
    for (const Plane& plane : frustum.view())
        if (!(std::fabs(plane.offset) <= 1e32)) return false;
    return frustum.plane_count > 0 && is_usable(frustum) && has_unit_normals(frustum);
}

}  // namespace

template <class Bound>
void cull(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
          VerdictBits& verdicts, Mode mode, Executor& executor) {
    CROFTON_ASSERT(bounds.size() == set.size(), "cull needs the bounds that the set was given");
    verdicts.visible.resize((set.size() + 63) / 64);
    verdicts.inside.resize((set.size() + 63) / 64);
    verdicts.by_chunk.resize(set.chunks().size());
    const bool usable = is_usable(view.frustum), vectors = takes_vectors(view.frustum);
    const KernelView kernel_view = kernel_view_of(view);
    const ListQuery<Bound> query{set, bounds, mode};
    executor.parallel_for(set.chunks().size(), 2, [&](std::size_t begin, std::size_t end, unsigned) {
        ListKernelOutput output;
        for (std::size_t c = begin; c < end; ++c) {
            verdicts.by_chunk[c] = query.run(c, view, kernel_view, usable, vectors, output);
            const std::size_t word = c * kChunk / 64, words = std::min(kChunk / 64, verdicts.visible.size() - word);
            std::copy_n(output.visible, words, verdicts.visible.data() + word);
            std::copy_n(output.inside, words, verdicts.inside.data() + word);
        }
    });
    verdicts.statistics = {};
    if (!kCountStatistics) return;
    for (const Statistics& chunk : verdicts.by_chunk) verdicts.statistics += chunk;
}

template <class Bound>
void cull(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds,
          std::span<const std::uint32_t> layer_masks, std::span<const View> views, std::span<std::uint32_t> view_masks,
          Mode mode, Executor& executor, std::span<Statistics> statistics) {
    CROFTON_ASSERT(bounds.size() == set.size(), "cull needs the bounds that the set was given");
    CROFTON_ASSERT(views.size() <= kMaxViews, "at most 32 views fit one pass");
    CROFTON_ASSERT(view_masks.size() == set.size(), "cull needs one view mask per bound");
    CROFTON_ASSERT(layer_masks.empty() || layer_masks.size() == set.size(),
                   "cull needs one layer mask per bound, or none");
    CROFTON_ASSERT(statistics.empty() || statistics.size() == views.size(), "one Statistics per view, or none");
    std::fill(statistics.begin(), statistics.end(), Statistics{});
    std::mutex summing;
    KernelView kernel_views[kMaxViews];
    bool usable[kMaxViews], vectors[kMaxViews];
    for (std::size_t v = 0; v < views.size(); ++v) {
        kernel_views[v] = kernel_view_of(views[v]);
        usable[v] = is_usable(views[v].frustum);
        vectors[v] = takes_vectors(views[v].frustum);
    }
    const ListQuery<Bound> query{set, bounds, mode};
    // A chunk's rows stay in the innermost cache from one view to the next.
    executor.parallel_for(set.chunks().size(), 2, [&](std::size_t begin, std::size_t end, unsigned) {
        ListKernelOutput output;
        ViewBits seen[kMaxViews];
        Statistics cost[kMaxViews];
        for (std::size_t c = begin; c < end; ++c) {
            const std::size_t first = c * kChunk, count = std::min(kChunk, set.size() - first);
            std::size_t seeing = 0;
            for (std::size_t v = 0; v < views.size(); ++v) {
                cost[v] += query.run(c, views[v], kernel_views[v], usable[v], vectors[v], output);
                const std::size_t words = (count + 63) / 64;
                if (std::all_of(output.visible, output.visible + words, [](std::uint64_t w) { return w == 0; }))
                    continue;
                std::copy_n(output.visible, words, seen[seeing].visible);
                seen[seeing].bit = 1u << v;
                seen[seeing++].layer_mask = views[v].layer_mask;
            }
            mark_views_kernel(seen, seeing, count, layer_masks.empty() ? nullptr : &layer_masks[first],
                              &view_masks[first]);
        }
        const std::lock_guard lock(summing);
        for (std::size_t v = 0; v < statistics.size(); ++v) statistics[v] += cost[v];
    });
}

std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids) {
    return list_bits_kernel(bits.data(), bits.size(), ids.data());
}

template class BoundSet<Obb>;
template class BoundSet<Aabb>;
template class BoundSet<Sphere>;

#define CROFTON_CULL_LIST_QUERIES(Bound)                                                                      \
    template void cull(const BoundSet<Bound>&, std::type_identity_t<std::span<const Bound>>, const View&,     \
                       VerdictBits&, Mode, Executor&);                                                        \
    template void cull(const BoundSet<Bound>&, std::type_identity_t<std::span<const Bound>>,                  \
                       std::span<const std::uint32_t>, std::span<const View>, std::span<std::uint32_t>, Mode, \
                       Executor&, std::span<Statistics>);
CROFTON_CULL_LIST_QUERIES(Obb)
CROFTON_CULL_LIST_QUERIES(Aabb)
CROFTON_CULL_LIST_QUERIES(Sphere)
#undef CROFTON_CULL_LIST_QUERIES

}  // namespace crofton::cull
