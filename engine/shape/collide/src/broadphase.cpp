// SPDX-License-Identifier: MIT
// Finds all pairs of boxes that overlap, and follows them from update to update.
#include <algorithm>
#include <atomic>
#include <bit>
#include <crofton/geometry/finite.hpp>
#include <string>
#include <utility>

#include "bounds_meet.hpp"
#include "broadphase_state.hpp"
#include "leaf_bounds.hpp"

namespace crofton::collide {
namespace {

constexpr std::size_t kLeafGrain = 64;    // leaves a task
constexpr std::size_t kBlockGrain = 4;    // blocks of leaves a task
constexpr std::size_t kPairGrain = 2048;  // pairs a task

}  // namespace

Broadphase::Broadphase(const BroadphaseOptions& options) : state_(Owner<State>::make()) {
    state_->options = options;
    state_->options.max_pairs = std::min<std::size_t>(options.max_pairs, 0xffffffffu);  // counted in 32 bits
}
Broadphase::~Broadphase() = default;
Broadphase::Broadphase(Broadphase&&) noexcept = default;
Broadphase& Broadphase::operator=(Broadphase&&) noexcept = default;

void Broadphase::State::bound_leaf(std::span<const Obb> boxes, std::size_t leaf, BroadphaseWorker& worker) {
    const std::span<const std::uint32_t> items = tree.items_of(leaf);
    if (items.empty()) return;
    // Neighbours in space lie anywhere in memory: ask for the leaf after next.
    const std::span<const std::uint32_t> later = tree.items_of(std::min(leaf + 2, tree.leaf_count() - 1));
    BoundBlock& bounds = tree.leaf(leaf);
    const std::uint32_t used = (1u << items.size()) - 1u;
    std::uint32_t absent = 0;
    for (std::uint32_t suspect = bound_items(boxes, items, later, origin, bounds); suspect != 0;
         suspect &= suspect - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(suspect));
        if (validate(boxes[items[lane]]).has_value()) continue;
        worker.absent.push_back(items[lane]);
        absent |= 1u << lane;
    }
    tree.clear_unused(leaf);
    // Until absent items are taken out, they are where another item of the leaf is.
    const auto present = static_cast<std::size_t>(std::countr_zero(used & ~absent));
    for (; absent != 0; absent &= absent - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(absent));
        for (int i = 0; i < 3; ++i) {
            bounds.low[i][lane] = present < kBoxBlock ? bounds.low[i][present] : 0.0f;
            bounds.high[i][lane] = present < kBoxBlock ? bounds.high[i][present] : 0.0f;
        }
    }
}

void Broadphase::State::refit(std::span<const Obb> boxes, Executor& executor) {
    for (BroadphaseWorker& worker : workers) worker.absent.clear();
    tree.begin_bounds();
    executor.parallel_for(tree.leaf_count(), kLeafGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) bound_leaf(boxes, leaf, workers[worker]);
    });
    tree.bound_all();
    now.clear();
    for (const BroadphaseWorker& worker : workers) now.insert(now.end(), worker.absent.begin(), worker.absent.end());
    std::sort(now.begin(), now.end());
    for (const std::uint32_t item : now) tree.remove(item);
}

void Broadphase::State::sort(std::span<const Obb> boxes, Executor& executor) {
    tree.clear();
    tree.resize(boxes.size());
    order.sort(boxes);
    tree.arrange(order.items());
    refit(boxes, executor);
    tree.remember_extents();
    statistics.rebuilt = true;
}

// All valid boxes into the tree: where they are, few that are new one by one, or all in a new order.
void Broadphase::State::place_all(std::span<const Obb> boxes, Executor& executor) {
    origin = middle_of(boxes);
    const std::size_t items_before = tree.item_count(), most = boxes.size() / kFewMovers;
    const bool many_went = items_before > boxes.size() && items_before - boxes.size() > most;
    if (many_went || tree.size() == 0) return sort(boxes, executor);
    for (std::size_t item = boxes.size(); item < items_before; ++item)
        if (tree.contains(static_cast<std::uint32_t>(item))) tree.remove(static_cast<std::uint32_t>(item));
    tree.resize(boxes.size());
    came.clear();
    for (std::uint32_t item = 0; item < boxes.size(); ++item)
        if (!tree.contains(item) && is_in_range(boxes[item].center) && validate(boxes[item])) came.push_back(item);
    if (came.size() > most) return sort(boxes, executor);
    refit(boxes, executor);
    for (const std::uint32_t item : came) {
        BoundBlock bounds;
        bound_items(boxes, {&item, 1}, {}, origin, bounds);
        tree.insert(item, lane_of(bounds, 0));
    }
    if (tree.is_worn()) sort(boxes, executor);
}

// Makes room for more pairs; false when there are too many.
bool Broadphase::State::grow(SlotPairs& slots, BroadphaseWorker& worker) const {
    if (slots.count > options.max_pairs) return false;
    const std::size_t size = std::max(2 * kPairRoom, 2 * worker.first.size());
    worker.first.resize(size);
    worker.second.resize(size);
    slots.first = worker.first.data();
    slots.second = worker.second.data();
    slots.capacity = size;
    return true;
}

// Pairs of slots whose bounds meet, into the workers' lists; false when there are too many.
bool Broadphase::State::collect(Executor& executor) {
    std::atomic<bool> too_many = false;
    for (BroadphaseWorker& worker : workers)
        worker.pairs = {worker.first.data(), worker.second.data(), 0, worker.first.size(), 0};
    const BoundTree view = tree.view();
    executor.parallel_for(view.sizes[1], kBlockGrain, [&](std::size_t begin, std::size_t end, unsigned index) {
        BroadphaseWorker& worker = workers[index];
        if (too_many) return;
        find_pairs(view, begin, end, worker.pairs, [&](SlotPairs& slots) {
            const bool grown = grow(slots, worker);
            if (!grown) too_many = true;
            return grown;
        });
    });
    std::uint64_t total = 0;
    for (const BroadphaseWorker& worker : workers) {
        total += worker.pairs.count;
        statistics.nodes_tested += worker.pairs.leaf_pairs;
    }
    return !too_many && total <= options.max_pairs;
}

// Of the pairs of slots that a worker has found, the pairs of items that meet. In the order in which they were found,
// where neighbours come together.
void Broadphase::State::keep_pairs_that_meet(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                             const PairTest* test, BroadphaseWorker& worker) const {
    const BoundTree view = tree.view();
    const std::uint32_t* const items = view.children[0];
    std::uint32_t *const first = worker.first.data(), *const second = worker.second.data();
    std::size_t kept = 0;
    worker.bound_pairs = 0;
    worker.boxes = {};
    worker.candidates.resize(kPairGrain);
    worker.hits.resize(kPairGrain);
    for (std::size_t begin = 0; begin < worker.pairs.count; begin += kPairGrain) {
        const std::size_t end = std::min(begin + kPairGrain, worker.pairs.count);
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t a = items[first[i]], b = items[second[i]];
            if (!filters.empty() && !passes(filters[a], filters[b])) continue;
            worker.candidates[count++] = {std::min(a, b), std::max(a, b)};
        }
        const auto some = std::span<const IdPair>(worker.candidates).first(count);
        test_some(boxes, some, test, std::span(worker.hits).first(count), worker.boxes);
        worker.bound_pairs += count;
        for (std::size_t i = 0; i < count; ++i) {
            first[kept] = some[i].first;
            second[kept] = some[i].second;
            kept += worker.hits[i];
        }
    }
    worker.pairs.count = kept;
}

void Broadphase::State::sort_pairs(std::size_t item_count, Vector<IdPair>& sorted) {
    const auto listed = [](const BroadphaseWorker& worker, const Vector<std::uint32_t>& items) {
        return std::span<const std::uint32_t>(items).first(worker.pairs.count);
    };
    list.begin(item_count);
    for (const BroadphaseWorker& worker : workers) list.count(listed(worker, worker.first));
    list.place(sorted);
    for (const BroadphaseWorker& worker : workers)
        list.add(listed(worker, worker.first), listed(worker, worker.second), sorted);
    list.finish(sorted);
}

void Broadphase::State::test_some(std::span<const Obb> boxes, std::span<const IdPair> candidates, const PairTest* test,
                                  std::span<std::uint8_t> verdicts, BatchStatistics& counted) const {
    if (options.exact_boxes)
        counted += intersects(boxes, candidates, verdicts);
    else
        for (std::size_t i = 0; i < candidates.size(); ++i)
            verdicts[i] = bounds_meet(boxes[candidates[i].first], boxes[candidates[i].second]);
    if (test == nullptr) return;
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (verdicts[i] != 0) verdicts[i] = (*test)(candidates[i].first, candidates[i].second);
}

// Into `hits`, which of the candidates meet.
void Broadphase::State::test_pairs(std::span<const Obb> boxes, std::span<const IdPair> candidates, Executor& executor,
                                   const PairTest* test) {
    hits.resize(candidates.size());
    for (BroadphaseWorker& worker : workers) worker.boxes = {};
    executor.parallel_for(candidates.size(), kPairGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        test_some(boxes, candidates.subspan(begin, end - begin), test,
                  std::span<std::uint8_t>(hits).subspan(begin, end - begin), workers[worker].boxes);
    });
    for (const BroadphaseWorker& worker : workers) statistics.boxes += worker.boxes;
}

// All pairs of the update before have ended.
Result<void> Broadphase::State::drop_pairs() {
    statistics.rejected = static_cast<std::uint32_t>(tree.item_count() - tree.size());
    ended = pairs.get();
    began.clear();
    pairs.values().clear();
    stayed.forget();
    table_is_current = false;
    all_are_tested = true;
    return fail(ErrorCode::budget_exceeded, kNoItem,
                {"broadphase: the bounds of more than ", options.max_pairs, " pairs meet"});
}

Result<void> Broadphase::State::check(std::span<const Obb> boxes, std::span<const CollisionFilter> filters) {
    if (!filters.empty() && filters.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, filters.size(), "broadphase: filters and boxes differ in number");
    if (boxes.size() >= 0xffffffffu)
        return fail(ErrorCode::out_of_range, boxes.size(), "broadphase: at most 2^32 - 2 boxes");
    return {};
}

Result<void> Broadphase::State::update_all(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                           Executor& executor, const PairTest* test) {
    statistics = {};
    table_is_current = false;
    all_are_tested = true;
    rejected.forget();
    stayed.forget();
    workers.resize(std::max<std::size_t>(workers.size(), executor.concurrency()));
    place_all(boxes, executor);
    if (!collect(executor)) return drop_pairs();
    executor.parallel_for(workers.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t w = begin; w < end; ++w) keep_pairs_that_meet(boxes, filters, test, workers[w]);
    });
    for (const BroadphaseWorker& worker : workers) {
        statistics.bound_pairs += worker.bound_pairs;
        statistics.boxes += worker.boxes;
    }
    std::swap(pairs.values(), previous);
    Vector<IdPair>& now_there = pairs.values();
    sort_pairs(boxes.size(), now_there);
    statistics.box_pairs = now_there.size();
    statistics.rejected = static_cast<std::uint32_t>(tree.item_count() - tree.size());
    compare_pairs(previous, now_there, began, ended);
    current = true;
    return {};
}

// What the lists for callers are made of stays.
void Broadphase::State::release_scratch() {
    order.release();
    list.release();
    const auto release = [](auto&... lists) { (std::exchange(lists, {}), ...); };
    release(workers, previous, movers, partners, partners_begin, queries, query_movers, query_bounds, found_begin, now,
            came, left, ended_entries);
    if (!current) return;
    workers.resize(1);
    (void)grow(workers.front().pairs, workers.front());
    note_count(tree.item_count());
    begin_table();
}

void Broadphase::State::begin_table() {
    if (!table_is_current) table.assign(tree.item_count(), pairs.get());
    table_is_current = true;
}

void Broadphase::reserve(std::size_t items) {
    state_->tree.reserve(items);
    state_->table.reserve(items);
    state_->is_moved.reserve(items);
}

void Broadphase::release_scratch() {
    state_->release_scratch();
}

Result<void> Broadphase::State::update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                       Executor& executor, const PairTest* test) {
    current = false;
    if (auto checked = check(boxes, filters); !checked) return checked;
    return update_all(boxes, filters, executor, test);
}

Result<void> Broadphase::State::update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                             std::span<const CollisionFilter> filters, Executor& executor,
                                             const PairTest* test) {
    // After an error the pairs are no longer those of the last boxes: what moved in them is not known.
    const bool was_current = std::exchange(current, false);
    if (auto checked = check(boxes, filters); !checked) return checked;
    if (const auto last = std::max_element(moved.begin(), moved.end()); last != moved.end() && *last >= boxes.size())
        return fail(ErrorCode::out_of_range, *last, "broadphase: an item in `moved` is no index of a box");
    const std::size_t before = tree.item_count(),
                      came_or_went = std::max(before, boxes.size()) - std::min(before, boxes.size());
    const auto old_moved = std::count_if(moved.begin(), moved.end(), [&](std::uint32_t item) { return item < before; });
    const bool few = static_cast<std::size_t>(old_moved) + came_or_went <= boxes.size() / kFewMovers;
    if (!was_current || !few) return update_all(boxes, filters, executor, test);
    return update_few(boxes, moved, filters, executor, test);
}

Result<void> Broadphase::update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                Executor& executor) {
    return state_->update(boxes, filters, executor, nullptr);
}
Result<void> Broadphase::update(std::span<const Obb> boxes, PairTest test, std::span<const CollisionFilter> filters,
                                Executor& executor) {
    return state_->update(boxes, filters, executor, &test);
}
Result<void> Broadphase::update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                      std::span<const CollisionFilter> filters, Executor& executor) {
    return state_->update_moved(boxes, moved, filters, executor, nullptr);
}
Result<void> Broadphase::update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved, PairTest test,
                                      std::span<const CollisionFilter> filters, Executor& executor) {
    return state_->update_moved(boxes, moved, filters, executor, &test);
}

}  // namespace crofton::collide
