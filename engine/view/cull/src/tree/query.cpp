// SPDX-License-Identifier: MIT
// find_visible: shares the work among threads, runs the kernels, and decides what these leave open.
#include "tree/query.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <mutex>

#include "exact/box_constraints.hpp"
#include "id_bits_kernel.hpp"
#include "limits/kernel_limits.hpp"
#include "list/direct_kernel.hpp"
#include "tree/block_planes.hpp"

namespace crofton::cull {
namespace {

// Room after each list: vector stores write past the end.
constexpr std::size_t kPadding = boxtree::kWidth, kListPadding = 64;
// A query of fewer items ends before another thread wakes up.
constexpr std::size_t kParallelItems = 65536, kParallelBoxes = 16384;  // of a tree; of a list
// A mark in an item's number; ids are below 2^30.
constexpr std::uint32_t kInside = 0x80000000u;

template <class T>
void grow(Vector<T>& buffer, std::size_t size) {
    if (buffer.size() < size) buffer.resize(size);
}

// How many leaves a node one or two levels below the root may have below it. Where they are not consecutive, as many as
// its children can have in a tree of this height.
std::size_t most_leaves_below(const boxtree::Structure& structure, boxtree::NodeId n) {
    if (const std::size_t leaves = structure.leaf_ranges()[n].count; leaves > 0) return leaves;
    const boxtree::Node& node = structure.nodes()[n];
    const std::size_t all = std::max(structure.leaves().size(), structure.nodes().size());
    const unsigned depth = node.parent == 0 ? 1 : 2;
    std::size_t most = node.count;
    for (unsigned level = depth + 1; level < structure.height() && most < all; ++level) most *= boxtree::kWidth;
    return std::min(most, all);
}

}  // namespace

void leave_all_undecided(std::size_t count, ListKernelOutput& output) {
    output.resolved_count = output.false_positives = 0;
    output.open = output.undecided_count = count;
    for (std::size_t i = 0; i < count; ++i) output.undecided[i] = static_cast<std::uint32_t>(i);
    std::fill_n(output.visible, (count + 63) / 64, 0);
    std::fill_n(output.inside, (count + 63) / 64, 0);
}

// A large tree is queried subtree by subtree, two levels down, with one thread as with many. So the answer comes in
// the same order.
Query::Tasks::Tasks(const TreeKernelInput& input, bool many) {
    const std::uint64_t root = tree_entry(0, (1u << input.view->plane_count) - 1);
    std::uint64_t level[boxtree::kWidth];
    entries[0] = root;
    count = 1;
    if (!many) return;
    count = 0;
    const std::size_t first_count = expand_tree_kernel(input, root, level);
    for (std::size_t i = 0; i < first_count; ++i) count += expand_tree_kernel(input, level[i], entries + count);
}

void Query::start(std::size_t items) {
    visible_.size_ = visible_.inside_ = 0;
    visible_.statistics_ = {};
    grow(visible_.ids_, items + kPadding);
    grow(visible_.straddling_, items + kPadding);
}

// Each chunk writes its own words, so that threads may share them.
void Query::run(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Executor& executor) {
    visible_.statistics_ = {};
    const std::size_t words = (boxes.size() + 63) / 64;
    grow(visible_.bits_, 2 * words);
    std::uint64_t *const seen = visible_.bits_.data(), *const marked = seen + words;
    const glm::dvec3 origin = glm::abs(view_.frustum.origin);
    KernelView view;
    const bool vectors = set_planes(view_, view) && std::max({origin.x, origin.y, origin.z}) <= kFarthestOrigin;
    const ListChunks list{boxes, layer_masks, vectors ? &view : nullptr, seen, marked};
    const std::size_t chunks = (boxes.size() + kChunk - 1) / kChunk;
    if (boxes.size() < kParallelBoxes || executor.concurrency() == 1) {
        visible_.statistics_ = ask(list, 0, chunks);
    } else {
        std::mutex summing;
        executor.parallel_for(chunks, 1, [&](std::size_t begin, std::size_t end, unsigned) {
            const Statistics cost = Query(view_, visible_, options_).ask(list, begin, end);
            const std::lock_guard lock(summing);
            visible_.statistics_ += cost;
        });
    }
    finish(seen, marked, words, boxes.size());
}

Statistics Query::ask(const ListChunks& list, std::size_t begin, std::size_t end) {
    Statistics statistics;
    ListKernelOutput output;
    for (std::size_t first = begin * kChunk; first < std::min(end * kChunk, list.boxes.size()); first += kChunk) {
        const std::span<const Obb> boxes = list.boxes.subspan(first, std::min(kChunk, list.boxes.size() - first));
        if (list.view)
            run_direct_kernel({reinterpret_cast<const unsigned char*>(boxes.data()), boxes.size(), list.view,
                               options_.mode == CullMode::exact},
                              output);
        else
            leave_all_undecided(boxes.size(), output);
        decide(boxes, output, statistics);
        for (std::size_t w = 0; w < (boxes.size() + 63) / 64; ++w) {
            std::uint64_t visible = output.visible[w];
            if (!list.layer_masks.empty()) visible &= layer_bits(list.layer_masks.subspan(first + 64 * w));
            if (view_.layer_mask == 0) visible = 0;  // without layer masks, too
            if (options_.limits) visible = wanted_bits(visible, list.boxes, list.layer_masks, first + 64 * w);
            if (first / 64 + w < options_.candidate_mask.size()) visible &= options_.candidate_mask[first / 64 + w];
            list.seen[first / 64 + w] = visible;
            list.marked[first / 64 + w] = visible & ~output.inside[w];
        }
    }
    return statistics;
}

// Returns which of the first 64 layer masks share a layer with the view.
std::uint64_t Query::layer_bits(std::span<const std::uint32_t> layer_masks) const {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(64, layer_masks.size()); ++i)
        bits |= std::uint64_t{(layer_masks[i] & view_.layer_mask) != 0} << i;
    return bits;
}

// Returns which of up to 64 visible boxes, from `first` on, are within the draw limits.
std::uint64_t Query::wanted_bits(std::uint64_t visible, std::span<const Obb> boxes,
                                 std::span<const std::uint32_t> layer_masks, std::size_t first) {
    std::uint64_t result = visible;
    for (std::uint64_t rest = visible; rest; rest &= rest - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(rest));
        if (!is_wanted(boxes[i], static_cast<ItemId>(i), layer_masks.empty() ? ~0u : layer_masks[i]))
            result &= ~(rest & -rest);
    }
    return result;
}

// Decides the boxes that the kernel left undecided, and counts for the statistics.
void Query::decide(std::span<const Obb> boxes, ListKernelOutput& output, Statistics& statistics) const {
    std::size_t rejected = 0;
    for (std::size_t n = 0; n < output.undecided_count; ++n) {
        const std::uint32_t i = output.undecided[n];
        const Verdict verdict = classify(view_.frustum, boxes[i], options_.mode);
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        output.visible[i / 64] &= ~bit;
        output.inside[i / 64] &= ~bit;
        if (verdict != Verdict::outside) output.visible[i / 64] |= bit;
        if (verdict == Verdict::inside) output.inside[i / 64] |= bit;
        rejected += kCountStatistics && options_.mode == CullMode::exact && verdict == Verdict::outside &&
                    classify(view_.frustum, boxes[i], CullMode::conservative) != Verdict::outside;
    }
    if (!kCountStatistics) return;
    statistics.boxes_tested += boxes.size();
    statistics.exact_tests += output.resolved_count + output.undecided_count;
    statistics.false_positives += output.false_positives + rejected;
}

// Lists the ids of the bits in `seen`; those that are also in `marked` straddle.
void Query::finish(const std::uint64_t* seen, const std::uint64_t* marked, std::size_t words, std::size_t items) {
    grow(visible_.ids_, items + kListPadding);
    std::size_t size = 0, straddling = 0;
    for (std::size_t w = 0; w < words; ++w) straddling += static_cast<std::size_t>(std::popcount(marked[w]));
    if (options_.order == ResultOrder::ascending) {
        grow(visible_.verdicts_, items + 64);
        size = list_marked(seen, marked, words);
    } else {
        grow(visible_.straddling_, items + kListPadding);
        // Lists all visible items, then removes those that straddle. The rest is inside, in ascending order.
        Vector<std::uint64_t>& bits = visible_.bits_;
        for (std::size_t w = 0; w < words; ++w) bits[w] &= ~marked[w];
        size = list_bits_kernel(bits.data(), words, visible_.ids_.data());
        size += list_bits_kernel(marked, words, visible_.ids_.data() + size);
        visible_.verdicts_.clear();
    }
    visible_.size_ = size;
    visible_.inside_ = size - straddling;
    if (kCountStatistics) visible_.statistics_.straddling = straddling;
}

std::size_t Query::list_marked(const std::uint64_t* seen, const std::uint64_t* marked, std::size_t words) {
    constexpr MarkBytes kBytes{static_cast<std::uint8_t>(Verdict::straddling),
                               static_cast<std::uint8_t>(Verdict::inside)};
    static_assert(sizeof(Verdict) == 1);
    return list_marked_bits_kernel(seen, marked, words, kBytes, visible_.ids_.data(),
                                   reinterpret_cast<std::uint8_t*>(visible_.verdicts_.data()));
}

void Query::run(const boxtree::BoxTree& tree, Executor& executor) {
    const boxtree::Structure& structure = tree.structure();
    start(tree.boxes().size() + (moving_ ? moving_->size() : 0));
    if (!is_usable(view_.frustum) || !has_unit_normals(view_.frustum)) return run_all(tree, executor);
    grow(visible_.undecided_, tree.boxes().size() + kPadding);
    KernelView view = kernel_view_of(view_);
    bring_before(structure.nodes()[0].origin, structure.nodes()[0].l1_radius, view);
    TreeKernelInput input{structure.nodes().data(),
                          structure.leaves().data(),
                          structure.leaf_ranges().data(),
                          structure.leaf_counts().data(),
                          structure.slot_items().data(),
                          structure.axes().data(),
                          &view,
                          options_.mode == CullMode::exact};
    const Tasks tasks(input, tree.item_count() >= kParallelItems);
    if (executor.concurrency() > 1 && tasks.count > 1 && !options_.limits)
        return run_parallel(tree, input, tasks, executor);
    if (!options_.candidate_mask.empty() && !options_.limits && has_candidate_slots(structure)) {
        by_slots_ = true;
        input.leaves_with_candidates = visible_.candidate_slots_.leaves.data();
        input.nodes_with_candidates = visible_.candidate_slots_.nodes.data();
    }
    TreeKernelOutput output{};
    output.inside = visible_.ids_.data();
    output.straddling = visible_.straddling_.data();
    output.undecided = visible_.undecided_.data();
    output.work_size = structure.nodes().size() + structure.leaves().size() + kPadding;
    grow(visible_.work_, kWorkLists * output.work_size);
    output.work = visible_.work_.data();
    if (options_.limits) {
        KernelLimits limits = kernel_limits_of(*options_.limits);
        limits.radii_below = structure.node_radii().data();
        run_limited_tree_kernel(input, limits, output);
    } else {
        run_tree_kernel(input, tasks.entries, tasks.count, output);
    }
    std::size_t inside = output.inside_count, straddling = output.straddling_count;
    append_decided(output, decide(tree, output), inside, straddling);
    finish(tree, inside, straddling, executor);
}

// The subtrees two levels down are the tasks. Each range of them writes to its own part of the buffers. The parts are
// then put together in order, so that the answer does not depend on who did what.
void Query::run_parallel(const boxtree::BoxTree& tree, const TreeKernelInput& input, const Tasks& tasks,
                         Executor& executor) {
    constexpr std::size_t kGrain = kTreeGroup, kParts = Tasks::kMost / kGrain;
    const boxtree::Structure& structure = tree.structure();
    // Returns the largest size of each part; vectors write up to 16 past its end.
    const auto most = [&](std::uint64_t entry) {
        const auto child = static_cast<std::uint32_t>(entry >> 32);
        return boxtree::kWidth * (child & boxtree::kLeafBit ? 1 : most_leaves_below(structure, child));
    };
    std::size_t starts[kParts + 1] = {};
    const std::size_t parts = (tasks.count + kGrain - 1) / kGrain;
    for (std::size_t p = 0; p < parts; ++p) {
        starts[p + 1] = starts[p] + kPadding;
        for (std::size_t i = p * kGrain; i < std::min(tasks.count, (p + 1) * kGrain); ++i)
            starts[p + 1] += most(tasks.entries[i]);
    }
    grow(visible_.part_inside_, starts[parts]);
    grow(visible_.part_straddling_, starts[parts]);
    grow(visible_.undecided_, starts[parts]);
    // Below an entry there are no more nodes than leaves.
    const auto work_size = [&](std::size_t p) { return (starts[p + 1] - starts[p]) / boxtree::kWidth * 2 + kPadding; };
    grow(visible_.work_, kWorkLists * (starts[parts] / boxtree::kWidth * 2 + kPadding * parts));
    static_assert(sizeof(SlotRun) == sizeof(visible_.runs_[0]));
    grow(visible_.runs_, starts[parts] / boxtree::kWidth + parts);
    TreeKernelOutput outputs[kParts] = {};
    std::size_t kept[kParts] = {};
    executor.parallel_for(tasks.count, kGrain, [&](std::size_t begin, std::size_t end, unsigned) {
        const std::size_t p = begin / kGrain;
        TreeKernelOutput& output = outputs[p];
        output.inside = visible_.part_inside_.data() + starts[p];
        output.straddling = visible_.part_straddling_.data() + starts[p];
        output.undecided = visible_.undecided_.data() + starts[p];
        output.work = visible_.work_.data() + kWorkLists * (starts[p] / boxtree::kWidth * 2 + kPadding * p);
        output.work_size = work_size(p);
        output.runs = reinterpret_cast<SlotRun*>(visible_.runs_.data()) + starts[p] / boxtree::kWidth + p;
        run_tree_kernel(input, tasks.entries + begin, end - begin, output);
        kept[p] = decide(tree, output);
    });
    std::size_t whole = 0, inside = 0, straddling = 0, whole_at[kParts], inside_at[kParts], straddling_at[kParts];
    for (std::size_t p = 0; p < parts; ++p) {
        whole_at[p] = whole;
        straddling_at[p] = straddling;
        whole += outputs[p].whole_count;
        straddling += outputs[p].straddling_count;
    }
    inside = whole;
    for (std::size_t p = 0; p < parts; ++p) {
        inside_at[p] = inside;
        inside += outputs[p].inside_count;
    }
    executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t p = begin; p < end; ++p) {
            const TreeKernelOutput& part = outputs[p];
            boxtree::ItemId* to = visible_.ids_.data() + whole_at[p];
            for (std::size_t i = 0; i < part.run_count; ++i)
                to = std::copy_n(structure.slot_items().data() + part.runs[i].first, part.runs[i].count, to);
            std::copy_n(part.inside, part.inside_count, visible_.ids_.data() + inside_at[p]);
            std::copy_n(part.straddling, part.straddling_count, visible_.straddling_.data() + straddling_at[p]);
        }
    });
    for (std::size_t p = 0; p < parts; ++p) append_decided(outputs[p], kept[p], inside, straddling);
    finish(tree, inside, straddling, executor);
}

// A view that the kernels cannot take is tested item by item. If it is not finite, everything may be visible.
void Query::run_all(const boxtree::BoxTree& tree, Executor& executor) {
    const boxtree::Structure& structure = tree.structure();
    const std::span<const Obb> boxes = tree.boxes();
    std::size_t inside = 0, straddling = 0;
    for (boxtree::LeafId l = 0; l < structure.leaves().size(); ++l)
        for (std::uint32_t lane = 0; lane < structure.leaves()[l].count; ++lane) {
            if (!(structure.leaves()[l].layers[lane] & view_.layer_mask)) continue;
            const ItemId item = structure.slot_items()[l * boxtree::kWidth + lane];
            if (!is_wanted(boxes[item], item, structure.leaves()[l].layers[lane])) continue;
            const Verdict verdict = classify(view_.frustum, boxes[item], options_.mode);
            if (verdict == Verdict::inside) visible_.ids_[inside++] = item;
            if (verdict == Verdict::straddling) visible_.straddling_[straddling++] = item;
        }
    finish(tree, inside, straddling, executor);
}

// Replaces the undecided slots by the items that are visible, with kInside set for those inside. The others that no
// plane rejects count as false positives.
std::size_t Query::decide(const boxtree::BoxTree& tree, TreeKernelOutput& output) {
    const std::span<const ItemId> slot_items = tree.structure().slot_items();
    const std::span<const Obb> boxes = tree.boxes();
    const std::span<const std::uint32_t> layer_masks = tree.layer_masks();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < output.undecided_count; ++i) {
        // The boxes lie in the order of their ids, far from each other: prefetch them.
        constexpr std::size_t kAhead = 8;
        if (i + kAhead < output.undecided_count) hwy::Prefetch(&boxes[slot_items[output.undecided[i + kAhead]]]);
        const ItemId item = slot_items[output.undecided[i]];
        const Obb& box = boxes[item];
        if (!is_wanted(box, item, layer_masks[item])) continue;
        const Verdict verdict = classify_usable(view_.frustum, box, options_.mode);
        if (verdict != Verdict::outside)
            output.undecided[kept++] = verdict == Verdict::inside ? item | kInside : item;
        else if (kCountStatistics && options_.mode == CullMode::exact)
            output.false_positives += classify_usable(view_.frustum, box, CullMode::conservative) != Verdict::outside;
    }
    return kept;
}

// Appends them after the items that the kernel decided, so that the order does not depend on the threads.
void Query::append_decided(const TreeKernelOutput& output, std::size_t kept, std::size_t& inside,
                           std::size_t& straddling) {
    for (std::size_t i = 0; i < kept; ++i) {
        const std::uint32_t item = output.undecided[i];
        if (item & kInside)
            visible_.ids_[inside++] = item & ~kInside;
        else
            visible_.straddling_[straddling++] = item;
    }
    if (!kCountStatistics) return;
    Statistics& statistics = visible_.statistics_;
    statistics.nodes_tested += output.nodes_tested;
    statistics.boxes_tested += output.boxes_tested;
    statistics.accepted_whole += output.accepted_whole;
    statistics.exact_tests += output.undecided_count;
    statistics.false_positives += output.false_positives;
}

// Resting items that CullOptions::candidate_mask leaves out are dropped here, or by sort() if nothing moves.
void Query::finish(const boxtree::BoxTree& tree, std::size_t inside, std::size_t straddling, Executor& executor) {
    const std::span<const std::uint64_t> candidate_mask = options_.candidate_mask;
    if (!candidate_mask.empty() && !by_slots_) {
        visible_.candidate_slots_.looked_up += inside + straddling;
        straddling =
            keep_ids_kernel(visible_.straddling_.data(), straddling, candidate_mask.data(), candidate_mask.size());
        if (moving_ || options_.order == ResultOrder::tree)
            inside = keep_ids_kernel(visible_.ids_.data(), inside, candidate_mask.data(), candidate_mask.size());
    }
    if (moving_) add_moving(tree, inside, straddling, executor);
    finish(inside, straddling, tree.boxes().size());
}

void Query::finish(std::size_t inside, std::size_t straddling, std::size_t items) {
    if (kCountStatistics) visible_.statistics_.straddling = straddling;
    visible_.size_ = inside + straddling;
    visible_.inside_ = inside;
    if (options_.order == ResultOrder::ascending) {
        visible_.size_ = sort(inside, straddling, items);
        visible_.inside_ = visible_.size_ - straddling;
        return;
    }
    std::copy_n(visible_.straddling_.begin(), straddling, visible_.ids_.begin() + static_cast<std::ptrdiff_t>(inside));
    visible_.verdicts_.clear();
}

// Few ids among many items: comparing them costs less than a bit for each item. Returns how many there are.
std::size_t Query::sort_few(std::size_t inside, std::size_t straddling) {
    grow(visible_.verdicts_, inside + straddling);
    ItemId* const ids = visible_.ids_.data();
    const auto is_candidate = [&](ItemId id) {
        const std::span<const std::uint64_t> mask = options_.candidate_mask;
        return moving_ || by_slots_ || id / 64 >= mask.size() || (mask[id / 64] >> id % 64 & 1) != 0;
    };
    std::size_t count = 0;
    for (std::size_t i = 0; i < inside; ++i)
        if (is_candidate(ids[i])) ids[count++] = 2 * ids[i];
    for (std::size_t i = 0; i < straddling; ++i)
        if (is_candidate(visible_.straddling_[i])) ids[count++] = 2 * visible_.straddling_[i] + 1;
    std::sort(ids, ids + count);
    for (std::size_t i = 0; i < count; ++i) {
        visible_.verdicts_[i] = ids[i] % 2 != 0 ? Verdict::straddling : Verdict::inside;
        ids[i] /= 2;
    }
    return count;
}

// Sorts by setting a bit for each id: they are distinct and below the number of items. Few straddle. The place of such
// an id is found from how many ids lie in the words before its own. Returns how many there are.
std::size_t Query::sort(std::size_t inside, std::size_t straddling, std::size_t items) {
    constexpr std::size_t kFew = 32;           // one in so many words of bits
    const std::size_t words = items / 64 + 2;  // one more for the kernel
    if ((inside + straddling) * kFew < words) return sort_few(inside, straddling);
    grow(visible_.bits_, 2 * words);
    grow(visible_.verdicts_, items + 64);
    std::uint64_t *const seen = visible_.bits_.data(), *const before = seen + words;
    std::fill_n(seen, words, 0);
    mark_ids_kernel(visible_.straddling_.data(), straddling, seen);
    mark_ids_kernel(visible_.ids_.data(), inside, seen);
    if (!moving_ && !by_slots_)  // otherwise they are dropped already: what moves is never left out
        for (std::size_t w = 0; w < std::min(words, options_.candidate_mask.size()); ++w)
            seen[w] &= options_.candidate_mask[w];
    const std::size_t count = list_placed_bits_kernel(seen, words, visible_.ids_.data(), before);
    static_assert(sizeof(Verdict) == 1);
    std::uint8_t* const verdicts = reinterpret_cast<std::uint8_t*>(visible_.verdicts_.data());
    std::memset(verdicts, static_cast<int>(Verdict::inside), count);
    mark_placed_kernel(visible_.straddling_.data(), straddling, seen, before,
                       static_cast<std::uint8_t>(Verdict::straddling), verdicts);
    return count;
}

}  // namespace crofton::cull
