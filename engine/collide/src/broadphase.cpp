#include <hwy/cache_control.h>
#include <algorithm>
#include <atomic>
#include <bit>
#include <crofton/collide/broadphase.hpp>
#include <limits>
#include <string>

#include "bound_blocks.hpp"
#include "box_lanes.hpp"
#include "pair_list.hpp"
#include "space_order.hpp"

namespace crofton::collide {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr std::size_t kLeafGrain = 64;    // leaves a task
constexpr std::size_t kBlockGrain = 4;    // blocks of leaves a task
constexpr std::size_t kPairGrain = 2048;  // pairs a task
// The order is made anew once the leaves' bounds have grown by this factor; a sort costs about as much as one update.
constexpr double kWornOut = 1.2;

void clear_lane(BoundBlock& block, std::size_t lane) {
    for (int i = 0; i < 3; ++i) {
        block.low[i][lane] = kLargest;
        block.high[i][lane] = -kLargest;
    }
}

struct Worker {
    Vector<std::uint32_t> first, second;
    SlotPairs pairs;
    Vector<std::uint32_t> rejected;
    BatchStatistics boxes;
};

}  // namespace

struct Broadphase::State {
    BroadphaseOptions options;
    BroadphaseStatistics statistics;
    SpaceOrder order;
    glm::dvec3 origin{0.0};
    Vector<BoundBlock> levels[kMaxLevels];
    BoundTree tree{};
    double leaf_extent = 0.0, leaf_extent_when_sorted = 0.0;
    Vector<Worker> workers;
    PairList list;
    Vector<std::uint8_t> hits;
    Vector<IdPair> pairs, previous, began, stayed, ended;
    Vector<std::uint32_t> rejected;

    void refit(std::span<const Obb> boxes, Executor& executor);
    void bound_leaf(std::span<const Obb> boxes, std::size_t leaf, Worker& worker);
    void build_levels();
    [[nodiscard]] bool collect(Executor& executor);
    void sort_pairs(std::size_t item_count, std::span<const Filter> filters);
    void keep_boxes_that_meet(std::span<const Obb> boxes, Executor& executor);
};

Broadphase::Broadphase(const BroadphaseOptions& options) : state_(std::make_unique<State>()) {
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

void Broadphase::State::bound_leaf(std::span<const Obb> boxes, std::size_t leaf, Worker& worker) {
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
        for (std::size_t lane = 0; lane < kBoxBlock; ++lane)
            for (int i = 0; i < 3; ++i)
                if (block.low[i][lane] <= block.high[i][lane])
                    leaf_extent += static_cast<double>(block.high[i][lane]) - static_cast<double>(block.low[i][lane]);
}

void Broadphase::State::refit(std::span<const Obb> boxes, Executor& executor) {
    levels[0].resize((boxes.size() + kBoxBlock - 1) / kBoxBlock);
    for (Worker& worker : workers) worker.rejected.clear();
    executor.parallel_for(levels[0].size(), kLeafGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) bound_leaf(boxes, leaf, workers[worker]);
    });
    build_levels();
}

// Pairs of slots whose bounds meet, into the workers' lists; false when there are too many.
bool Broadphase::State::collect(Executor& executor) {
    std::atomic<bool> too_many = false;
    for (Worker& worker : workers)
        worker.pairs = {worker.first.data(), worker.second.data(), 0, worker.first.size(), 0};
    executor.parallel_for(tree.sizes[1], kBlockGrain, [&](std::size_t begin, std::size_t end, unsigned index) {
        Worker& worker = workers[index];
        if (too_many) return;
        find_pairs(tree, begin, end, worker.pairs, [&](SlotPairs& found) {
            if (found.count > options.max_pairs) {
                too_many = true;
                return false;
            }
            const std::size_t size = std::max(2 * kPairRoom, 2 * worker.first.size());
            worker.first.resize(size);
            worker.second.resize(size);
            found.first = worker.first.data();
            found.second = worker.second.data();
            found.capacity = size;
            return true;
        });
    });
    std::uint64_t total = 0;
    for (const Worker& worker : workers) {
        total += worker.pairs.count;
        statistics.nodes_tested += worker.pairs.leaf_pairs;
    }
    return !too_many && total <= options.max_pairs;
}

void Broadphase::State::sort_pairs(std::size_t item_count, std::span<const Filter> filters) {
    const auto found = [](Worker& worker, Vector<std::uint32_t>& slots) {
        return std::span<std::uint32_t>(slots).first(worker.pairs.count);
    };
    list.begin(item_count);
    for (Worker& worker : workers)
        list.count(found(worker, worker.first), found(worker, worker.second), order.items(), filters);
    list.place(pairs);
    for (Worker& worker : workers) list.add(found(worker, worker.first), found(worker, worker.second), pairs);
    list.finish(pairs);
}

void Broadphase::State::keep_boxes_that_meet(std::span<const Obb> boxes, Executor& executor) {
    hits.resize(pairs.size());
    for (Worker& worker : workers) worker.boxes = {};
    executor.parallel_for(pairs.size(), kPairGrain, [&](std::size_t begin, std::size_t end, unsigned worker) {
        workers[worker].boxes += intersects(boxes, std::span<const IdPair>(pairs).subspan(begin, end - begin),
                                            std::span<std::uint8_t>(hits).subspan(begin, end - begin));
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[kept] = pairs[i];
        kept += hits[i];
    }
    pairs.resize(kept);
    for (const Worker& worker : workers) statistics.boxes += worker.boxes;
}

Result<void> Broadphase::update(std::span<const Obb> boxes, std::span<const Filter> filters, Executor& executor) {
    State& s = *state_;
    if (!filters.empty() && filters.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, filters.size(), "broadphase: filters and boxes differ in number");
    if (boxes.size() >= 0xffffffffu)
        return fail(ErrorCode::out_of_range, boxes.size(), "broadphase: at most 2^32 - 2 boxes");
    s.statistics = {};
    s.rejected.clear();
    std::swap(s.pairs, s.previous);
    s.pairs.clear();
    s.workers.resize(std::max<std::size_t>(s.workers.size(), executor.concurrency()));
    if (!boxes.empty()) {
        s.origin = middle_of(boxes);
        s.statistics.rebuilt = s.order.items().size() != boxes.size();
        if (!s.statistics.rebuilt) {
            s.refit(boxes, executor);
            s.statistics.rebuilt = s.leaf_extent > kWornOut * s.leaf_extent_when_sorted;
        }
        if (s.statistics.rebuilt) {
            s.order.sort(boxes);
            s.refit(boxes, executor);
            s.leaf_extent_when_sorted = s.leaf_extent;
        }
        for (const Worker& worker : s.workers)
            s.rejected.insert(s.rejected.end(), worker.rejected.begin(), worker.rejected.end());
        std::sort(s.rejected.begin(), s.rejected.end());
        if (!s.collect(executor))
            return fail(ErrorCode::budget_exceeded, kNoItem,
                        "broadphase: the bounds of more than " + std::to_string(s.options.max_pairs) + " pairs meet");
        s.sort_pairs(boxes.size(), filters);
        s.statistics.bound_pairs = s.pairs.size();
        if (s.options.exact_boxes) s.keep_boxes_that_meet(boxes, executor);
    }
    s.statistics.box_pairs = s.pairs.size();
    s.statistics.rejected = static_cast<std::uint32_t>(s.rejected.size());
    compare_pairs(s.previous, s.pairs, s.began, s.stayed, s.ended);
    return {};
}

}  // namespace crofton::collide
