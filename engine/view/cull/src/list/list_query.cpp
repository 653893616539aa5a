// SPDX-License-Identifier: MIT
// Queries of lists: chunks go through the kernels, then undecided bounds through exact tests.
#include <algorithm>
#include <bit>
#include <crofton/core/error.hpp>
#include <crofton/cull/bound_set.hpp>
#include <mutex>

#include "exact/box_constraints.hpp"
#include "id_bits_kernel.hpp"
#include "limits/limits.hpp"
#include "list/list_kernel.hpp"
#include "list/list_views_kernel.hpp"
#include "tree/query.hpp"

namespace crofton::cull {
namespace {

template <class Bound>
bool set_list_view(const View& view, KernelView& result) {
    const bool takes = set_planes(view, result);
    if (std::is_same_v<Bound, Sphere>) set_lengths(result);
    return takes;
}

template <class Bound>
struct ListQuery {
    const BoundSet<Bound>& set;
    std::span<const Bound> bounds;
    CullMode mode;

    // Verdicts of chunk c, and what they cost.
    Statistics run(std::size_t c, const View& view, const KernelView& kernel_view, bool usable, bool vectors,
                   ListKernelOutput& output) const {
        const std::size_t first = c * kChunk, count = std::min(kChunk, set.size() - first);
        if (vectors) {
            const ListKernelInput<typename BoundSet<Bound>::Record> input{
                &set.rows()[first / 16], &set.records()[first], &set.chunks()[c], &kernel_view, count,
                mode == CullMode::exact};
            run_list_kernel(input, output);
        } else {
            leave_all_undecided(count, output);
        }
        Statistics statistics;
        if (kCountStatistics) {
            statistics.boxes_tested = count;
            statistics.exact_tests = output.resolved_count + output.undecided_count;
            statistics.false_positives = output.false_positives;
            statistics.straddling = output.open;
        }
        for (std::size_t n = 0; n < output.undecided_count; ++n) {
            const std::uint32_t i = output.undecided[n];
            const Verdict verdict = decide(view, usable, bounds[first + i], statistics);
            const std::uint64_t bit = std::uint64_t{1} << (i % 64);
            output.visible[i / 64] &= ~bit;
            output.inside[i / 64] &= ~bit;
            if (verdict != Verdict::outside) output.visible[i / 64] |= bit;
            if (verdict == Verdict::inside) output.inside[i / 64] |= bit;
        }
        return statistics;
    }

    // A bound counted as straddling until now.
    Verdict decide(const View& view, bool usable, const Bound& bound, Statistics& statistics) const {
        const Verdict verdict =
            usable && is_usable(bound) ? classify_usable(view.frustum, bound, mode) : Verdict::straddling;
        if (!kCountStatistics || verdict == Verdict::straddling) return verdict;
        --statistics.straddling;
        statistics.false_positives += mode == CullMode::exact && verdict == Verdict::outside &&
                                      classify_usable(view.frustum, bound, CullMode::conservative) != Verdict::outside;
        return verdict;
    }
};

}  // namespace

template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  VerdictBits& verdicts, CullMode mode, Executor& executor) {
    CROFTON_ASSERT(bounds.size() == set.size(), "cull needs the bounds that the set was given");
    verdicts.visible.resize((set.size() + 63) / 64);
    verdicts.inside.resize((set.size() + 63) / 64);
    verdicts.by_chunk.resize(set.chunks().size());
    KernelView kernel_view;
    const bool vectors = set_list_view<Bound>(view, kernel_view), usable = vectors || is_usable(view.frustum);
    const ListQuery<Bound> query{set, bounds, mode};
    const auto ask = [&](std::size_t begin, std::size_t end, unsigned) {
        ListKernelOutput output;
        for (std::size_t c = begin; c < end; ++c) {
            verdicts.by_chunk[c] = query.run(c, view, kernel_view, usable, vectors, output);
            const std::size_t word = c * kChunk / 64, words = std::min(kChunk / 64, verdicts.visible.size() - word);
            std::copy_n(output.visible, words, verdicts.visible.data() + word);
            std::copy_n(output.inside, words, verdicts.inside.data() + word);
        }
    };
    if (set.chunks().size() == 1)
        ask(0, 1, 0);
    else
        executor.parallel_for(set.chunks().size(), 2, ask);
    verdicts.statistics = {};
    if (!kCountStatistics) return;
    for (const Statistics& chunk : verdicts.by_chunk) verdicts.statistics += chunk;
}

namespace {

// Ten megabytes of rows and records: larger lists are prefetched.
constexpr std::size_t kCachedList = 262144;

// The views of one pass, applied to one chunk at a time.
template <class Bound>
class ListViews {
  public:
    ListViews(const ListQuery<Bound>& query, std::span<const std::uint32_t> layers, std::span<const View> views)
        : query_(query), layers_(layers), views_(views) {
        for (std::uint32_t v = 0; v < views.size(); ++v) {
            usable_[v] = is_usable(views[v].frustum);
            if (layers.empty() && views[v].layer_mask == 0) blind_ |= 1u << v;
            (set_list_view<Bound>(views[v], kernel_views_[v]) ? vectors_ : singly_) |= 1u << v;
        }
    }

    // Adds to `cost`, by view.
    void run(std::size_t c, std::uint32_t* masks, Statistics* cost) const {
        const BoundSet<Bound>& set = query_.set;
        Chunk chunk{*this, c * kChunk, cost};
        const std::size_t count = std::min(kChunk, set.size() - chunk.first);
        const std::uint32_t* layers = layers_.empty() ? nullptr : &layers_[chunk.first];
        const ListViewsInput<typename BoundSet<Bound>::Record> input{&set.rows()[chunk.first / 16],
                                                                     &set.records()[chunk.first],
                                                                     &set.chunks()[c],
                                                                     kernel_views_,
                                                                     vectors_,
                                                                     count,
                                                                     query_.mode == CullMode::exact,
                                                                     set.size() > kCachedList,
                                                                     layers,
                                                                     Chunk::decide,
                                                                     &chunk};
        ListViewCost costs[kMaxListViews] = {};
        run_list_views_kernel(input, masks, costs);
        for (std::uint32_t v = 0; v < views_.size(); ++v) {
            const ListViewCost& own = costs[v];
            if (kCountStatistics)
                cost[v] += {.boxes_tested = count,
                            .straddling = own.straddling + own.undecided,
                            .exact_tests = own.resolved + own.undecided,
                            .false_positives = own.false_positives};
            if (singly_ >> v & 1) chunk.ask_singly(v, count, layers, masks);
        }
        for (std::size_t i = 0; blind_ != 0 && i < count; ++i) masks[i] &= ~blind_;
    }

  private:
    struct Chunk {
        const ListViews& of;
        std::size_t first;
        Statistics* cost;

        bool decide(std::uint32_t i, std::uint32_t v) {
            return of.query_.decide(of.views_[v], of.usable_[v], of.query_.bounds[first + i], cost[v]) !=
                   Verdict::outside;
        }
        static bool decide(void* context, std::uint32_t i, std::uint32_t v) {
            return static_cast<Chunk*>(context)->decide(i, v);
        }
        void ask_singly(std::uint32_t v, std::size_t count, const std::uint32_t* layers, std::uint32_t* masks) {
            if (kCountStatistics) {
                cost[v].straddling += count;
                cost[v].exact_tests += count;
            }
            for (std::uint32_t i = 0; i < count; ++i)
                if (decide(i, v) && (!layers || layers[i] & of.views_[v].layer_mask)) masks[i] |= 1u << v;
        }
    };

    const ListQuery<Bound>& query_;
    std::span<const std::uint32_t> layers_;
    std::span<const View> views_;
    KernelView kernel_views_[kMaxViews];
    bool usable_[kMaxViews];
    std::uint32_t vectors_ = 0, singly_ = 0;  // views that vectors can take, and the others
    std::uint32_t blind_ = 0;                 // those of no layer, where the bounds have no masks
};

}  // namespace

template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  const DrawLimits& limits, VerdictBits& verdicts, CullMode mode, Executor& executor) {
    find_visible(set, bounds, view, verdicts, mode, executor);
    const double layer_limit = limit_in_layers(limits, view.layer_mask);
    executor.parallel_for(verdicts.visible.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t w = begin; w < end; ++w) {
            std::uint64_t kept = verdicts.visible[w];
            for (std::uint64_t left = kept; left != 0; left &= left - 1) {
                const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(left));
                if (!is_within_limits(limits, bounds[i], static_cast<boxtree::ItemId>(i), layer_limit))
                    kept &= ~(left & (~left + 1));
            }
            verdicts.visible[w] = kept;
            verdicts.inside[w] &= kept;
        }
    });
}

template <class Bound>
Result<void> find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds,
                          std::span<const std::uint32_t> layer_masks, std::span<const View> views,
                          std::span<std::uint32_t> view_masks, CullMode mode, Executor& executor,
                          std::span<Statistics> statistics) {
    if (auto few = check_view_count(views.size()); !few) return few;
    CROFTON_ASSERT(bounds.size() == set.size(), "cull needs the bounds that the set was given");
    CROFTON_ASSERT(view_masks.size() == set.size(), "cull needs one view mask per bound");
    CROFTON_ASSERT(layer_masks.empty() || layer_masks.size() == set.size(),
                   "cull needs one layer mask per bound, or none");
    CROFTON_ASSERT(statistics.empty() || statistics.size() == views.size(), "one Statistics per view, or none");
    std::fill(statistics.begin(), statistics.end(), Statistics{});
    std::mutex summing;
    const ListQuery<Bound> query{set, bounds, mode};
    const ListViews<Bound> pass(query, layer_masks, views);
    executor.parallel_for(set.chunks().size(), 2, [&](std::size_t begin, std::size_t end, unsigned) {
        Statistics cost[kMaxViews];
        for (std::size_t c = begin; c < end; ++c) pass.run(c, &view_masks[c * kChunk], cost);
        const std::lock_guard lock(summing);
        for (std::size_t v = 0; v < statistics.size(); ++v) statistics[v] += cost[v];
    });
    return {};
}

std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids) {
    return list_bits_kernel(bits.data(), bits.size(), ids.data());
}

#define CROFTON_CULL_LIST_QUERIES(Bound)                                                                          \
    template void find_visible(const BoundSet<Bound>&, std::type_identity_t<std::span<const Bound>>, const View&, \
                               VerdictBits&, CullMode, Executor&);                                                \
    template void find_visible(const BoundSet<Bound>&, std::type_identity_t<std::span<const Bound>>, const View&, \
                               const DrawLimits&, VerdictBits&, CullMode, Executor&);                             \
    template Result<void> find_visible(const BoundSet<Bound>&, std::type_identity_t<std::span<const Bound>>,      \
                                       std::span<const std::uint32_t>, std::span<const View>,                     \
                                       std::span<std::uint32_t>, CullMode, Executor&, std::span<Statistics>);
CROFTON_CULL_LIST_QUERIES(Obb)
CROFTON_CULL_LIST_QUERIES(Aabb)
CROFTON_CULL_LIST_QUERIES(Sphere)
#undef CROFTON_CULL_LIST_QUERIES

}  // namespace crofton::cull
