// SPDX-License-Identifier: MIT
#include <hwy/cache_control.h>
#include <algorithm>
#include <atomic>
#include <bit>
#include <string>
#include <utility>

#include "bounds_meet.hpp"
#include "box_lanes.hpp"
#include "broadphase_state.hpp"

namespace crofton::collide {
namespace {

constexpr std::size_t kLeafGrain = 64;    // leaves a task
constexpr std::size_t kBlockGrain = 4;    // blocks of leaves a task
constexpr std::size_t kPairGrain = 2048;  // pairs a task
// Items are looked at one by one while fewer than one in this many move: then both ways cost about the same.
constexpr std::size_t kFewMovers = 8;

}  // namespace

Broadphase::Broadphase(const BroadphaseOptions& options) : state_(Owner<State>::make()) {
    state_->options = options;
    state_->options.max_pairs = std::min<std::size_t>(options.max_pairs, 0xffffffffu);  // counted in 32 bits
}
Broadphase::~Broadphase() = default;
Broadphase::Broadphase(Broadphase&&) noexcept = default;
Broadphase& Broadphase::operator=(Broadphase&&) noexcept = default;

std::span<const IdPair> Broadphase::pairs() const {
    return state_->pairs;
}
std::span<const IdPair> Broadphase::began() const {
    return state_->began;
}
std::span<const IdPair> Broadphase::stayed() const {
    return state_->stayed;
}
std::span<const IdPair> Broadphase::ended() const {
    return state_->ended;
}
std::span<const std::uint32_t> Broadphase::rejected() const {
    return state_->rejected;
}
const BroadphaseStatistics& Broadphase::statistics() const {
    return state_->statistics;
}

void Broadphase::State::bound_leaf(std::span<const Obb> boxes, std::size_t leaf, BroadphaseWorker& worker) {
    BoxBlock block;
    const std::span<const std::uint32_t> items = order.items();
    const std::size_t begin = leaf * kBoxBlock, count = std::min(kBoxBlock, items.size() - begin);
    for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
        const Obb& box = boxes[items[begin + std::min(lane, count - 1)]];
        // Neighbours in space lie anywhere in memory: ask for the leaf after next.
        const char* ahead =
            reinterpret_cast<const char*>(&boxes[items[std::min(begin + lane + 2 * kBoxBlock, items.size() - 1)]]);
        hwy::Prefetch(ahead);
        hwy::Prefetch(ahead + sizeof(Obb) - 1);
        put_center(box.center - origin, lane, block);
        put_shape(box, lane, block);
    }
    BoundBlock& bounds = levels[0][leaf];
    std::uint32_t suspect = bound_boxes(block, bounds) & ((1u << count) - 1u);
    for (; suspect != 0; suspect &= suspect - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(suspect));
        const std::uint32_t item = items[begin + lane];
        if (validate(boxes[item]).has_value()) continue;
        worker.rejected.push_back(item);
        clear_lane(bounds, lane);
    }
    for (std::size_t lane = count; lane < kBoxBlock; ++lane) clear_lane(bounds, lane);
}

void Broadphase::State::build_levels() {
    std::size_t k = 0;
    tree.level_count = 1;
    for (; k == 0 || levels[k].size() > 1; ++k) {
        const std::size_t size = levels[k].size(), above = (size + kBoxBlock - 1) / kBoxBlock;
        levels[k + 1].resize(above);
        bound_blocks(levels[k].data(), 0, size, levels[k + 1].data());
        for (std::size_t lane = size; lane < above * kBoxBlock; ++lane)
            clear_lane(levels[k + 1][lane / kBoxBlock], lane % kBoxBlock);
        ++tree.level_count;
    }
    for (std::size_t level = 0; level < tree.level_count; ++level) {
        tree.levels[level] = levels[level].data();
        tree.sizes[level] = levels[level].size();
    }
    leaf_extent = 0.0;
    for (const BoundBlock& block : levels[1])
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane) leaf_extent += extent_of_lane(block, lane);
}

void Broadphase::State::refit(std::span<const Obb> boxes, Executor& executor) {
    levels[0].resize((boxes.size() + kBoxBlock - 1) / kBoxBlock);
    for (BroadphaseWorker& worker : workers) worker.rejected.clear();
    executor.parallel_for(levels[0].size(), kLeafGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) bound_leaf(boxes, leaf, workers[worker]);
    });
    build_levels();
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
    executor.parallel_for(tree.sizes[1], kBlockGrain, [&](std::size_t begin, std::size_t end, unsigned index) {
        BroadphaseWorker& worker = workers[index];
        if (too_many) return;
        find_pairs(tree, begin, end, worker.pairs, [&](SlotPairs& slots) {
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

void Broadphase::State::sort_pairs(std::size_t item_count, std::span<const CollisionFilter> filters) {
    const auto slots_of = [](BroadphaseWorker& worker, Vector<std::uint32_t>& slots) {
        return std::span<std::uint32_t>(slots).first(worker.pairs.count);
    };
    list.begin(item_count);
    for (BroadphaseWorker& worker : workers)
        list.count(slots_of(worker, worker.first), slots_of(worker, worker.second), order.items(), filters);
    list.place(pairs);
    for (BroadphaseWorker& worker : workers)
        list.add(slots_of(worker, worker.first), slots_of(worker, worker.second), pairs);
    list.finish(pairs);
}

void Broadphase::State::keep_pairs_that_meet(std::span<const Obb> boxes, Vector<IdPair>& candidates,
                                             Executor& executor) {
    hits.resize(candidates.size());
    for (BroadphaseWorker& worker : workers) worker.boxes = {};
    executor.parallel_for(candidates.size(), kPairGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        const auto some = std::span<const IdPair>(candidates).subspan(begin, end - begin);
        const auto verdicts = std::span<std::uint8_t>(hits).subspan(begin, end - begin);
        if (options.exact_boxes) {
            workers[worker].boxes += intersects(boxes, some, verdicts);
            return;
        }
        for (std::size_t i = 0; i < some.size(); ++i)
            verdicts[i] = bounds_meet(boxes[some[i].first], boxes[some[i].second]);
    });
    std::size_t kept_count = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[kept_count] = candidates[i];
        kept_count += hits[i];
    }
    candidates.resize(kept_count);
    for (const BroadphaseWorker& worker : workers) statistics.boxes += worker.boxes;
}

// `previous` are those of the update before; none are now.
Result<void> Broadphase::State::drop_pairs() {
    statistics.rejected = static_cast<std::uint32_t>(rejected.size());
    compare_pairs(previous, pairs, began, stayed, ended);
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
                                           Executor& executor) {
    statistics = {};
    rejected.clear();
    std::swap(pairs, previous);
    pairs.clear();
    workers.resize(std::max<std::size_t>(workers.size(), executor.concurrency()));
    if (!boxes.empty()) {
        origin = middle_of(boxes);
        statistics.rebuilt = order.items().size() != boxes.size();
        if (!statistics.rebuilt) {
            refit(boxes, executor);
            statistics.rebuilt = leaf_extent > kWornOut * leaf_extent_when_sorted;
        }
        if (statistics.rebuilt) {
            order.sort(boxes);
            refit(boxes, executor);
            leaf_extent_when_sorted = leaf_extent;
        }
        for (const BroadphaseWorker& worker : workers)
            rejected.insert(rejected.end(), worker.rejected.begin(), worker.rejected.end());
        std::sort(rejected.begin(), rejected.end());
        if (!collect(executor)) return drop_pairs();
        sort_pairs(boxes.size(), filters);
        statistics.bound_pairs = pairs.size();
        keep_pairs_that_meet(boxes, pairs, executor);
    }
    statistics.box_pairs = pairs.size();
    statistics.rejected = static_cast<std::uint32_t>(rejected.size());
    compare_pairs(previous, pairs, began, stayed, ended);
    current = order.items().size() == boxes.size();
    return {};
}

Result<void> Broadphase::update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters,
                                Executor& executor) {
    state_->current = false;
    if (auto checked = state_->check(boxes, filters); !checked) return checked;
    return state_->update_all(boxes, filters, executor);
}

Result<void> Broadphase::update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                                      std::span<const CollisionFilter> filters, Executor& executor) {
    State& s = *state_;
    // After an error the pairs are no longer those of the last boxes: what moved in them is not known.
    const bool was_current = std::exchange(s.current, false);
    if (auto checked = s.check(boxes, filters); !checked) return checked;
    if (const auto last = std::max_element(moved.begin(), moved.end()); last != moved.end() && *last >= boxes.size())
        return fail(ErrorCode::out_of_range, *last, "broadphase: an item in `moved` is no index of a box");
    const bool few = moved.size() <= boxes.size() / kFewMovers && s.leaf_extent <= kWornOut * s.leaf_extent_when_sorted;
    if (!was_current || s.order.items().size() != boxes.size() || !few) return s.update_all(boxes, filters, executor);
    s.gather_movers(boxes.size(), moved);
    return s.update_few(boxes, filters, executor);
}

}  // namespace crofton::collide
