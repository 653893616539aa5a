// SPDX-License-Identifier: MIT
#include "item_tree.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <array>
#include <crofton/core/rank.hpp>
#include <crofton/geometry/float_lanes.hpp>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "leaf_bounds.hpp"

namespace crofton::collide {
namespace {

// A block with fewer lanes in use is given up, where it has siblings. A split leaves no less than the second.
constexpr std::size_t kFewestLanes = 5, kFewestAfterSplit = 6;
// A block is loose once its bounds have grown by this factor.
constexpr float kLooseGrowth = 1.1f;
// Leaves are worn once the sum of their extents has grown by the first, or there are so many times more than needed.
constexpr double kWornGrowth = 1.2, kWornCount = 1.5;

using detail::Lanes4;

Lanes4 load_lanes(const float* from) {
    return detail::load4(reinterpret_cast<const char*>(from));
}

// Bounds with a component for each axis side by side; the fourth is 0.
struct WideBounds {
    Lanes4 low, high;
    WideBounds() = default;
    WideBounds(const LaneBounds& bounds)
        : low{bounds.low[0], bounds.low[1], bounds.low[2], 0.0f},
          high{bounds.high[0], bounds.high[1], bounds.high[2], 0.0f} {}
    void include(const WideBounds& more) {
        low = detail::lesser(more.low, low);
        high = detail::larger(more.high, high);
    }
    [[nodiscard]] float extent() const {
        const Lanes4 size = high - low;
        return size[0] + size[1] + size[2];
    }
    [[nodiscard]] LaneBounds narrow() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

float extent_of(const LaneBounds& bounds) {
    return (bounds.high[0] - bounds.low[0]) + (bounds.high[1] - bounds.low[1]) + (bounds.high[2] - bounds.low[2]);
}

void put_lane(const LaneBounds& bounds, std::size_t lane, BoundBlock& block) {
    for (int i = 0; i < 3; ++i) {
        block.low[i][lane] = bounds.low[i];
        block.high[i][lane] = bounds.high[i];
    }
}

constexpr LaneBounds kEmpty = [] {
    constexpr float kLargest = std::numeric_limits<float>::max();
    return LaneBounds{{kLargest, kLargest, kLargest}, {-kLargest, -kLargest, -kLargest}};
}();

void include(const LaneBounds& more, LaneBounds& bounds) {
    for (int i = 0; i < 3; ++i) {
        bounds.low[i] = std::min(bounds.low[i], more.low[i]);
        bounds.high[i] = std::max(bounds.high[i], more.high[i]);
    }
}

bool are_equal(const LaneBounds& a, const LaneBounds& b) {
    return std::equal(a.low, a.low + 3, b.low) && std::equal(a.high, a.high + 3, b.high);
}

// The lane that grows least by taking the bounds in; of several the smallest. Empty lanes grow infinitely.
std::size_t lane_for(const BoundBlock& block, const LaneBounds& bounds) {
    float extents[kBoxBlock], growths[kBoxBlock];
    Lanes4 least_growth{};
    for (std::size_t first = 0; first < kBoxBlock; first += 4) {
        Lanes4 extent{}, growth{};
        for (int i = 0; i < 3; ++i) {
            const Lanes4 low = load_lanes(block.low[i] + first), high = load_lanes(block.high[i] + first);
            const Lanes4 grown_low = detail::lesser(low, detail::all_lanes(bounds.low[i])),
                         grown_high = detail::larger(high, detail::all_lanes(bounds.high[i]));
            extent = extent + (high - low);
            growth = growth + ((grown_high - high) + (low - grown_low));
        }
        std::memcpy(extents + first, &extent, sizeof extent);
        std::memcpy(growths + first, &growth, sizeof growth);
        least_growth = first == 0 ? growth : detail::lesser(growth, least_growth);
    }
    const float least = std::min({least_growth[0], least_growth[1], least_growth[2], float{least_growth[3]}});
    std::size_t best = kBoxBlock;
    for (std::size_t lane = kBoxBlock; lane-- > 0;)
        if (growths[lane] == least && (best == kBoxBlock || extents[lane] <= extents[best])) best = lane;
    return best;
}

// A block that is split has seventeen children; five vectors of keys.
constexpr std::size_t kSplitCount = kBoxBlock + 1, kSplitPadded = kBoxBlock + 4;

using SplitOrder = std::array<std::uint8_t, kSplitCount>;

// The order of the first seventeen keys; equal ones keep theirs.
void put_in_order(const float (&keys)[kSplitPadded], SplitOrder& order) {
    std::int32_t places[kSplitPadded];
    detail::rank<kSplitCount>(keys, places);
    for (std::size_t n = 0; n < kSplitCount; ++n)
        order[static_cast<std::size_t>(places[n])] = static_cast<std::uint8_t>(n);
}

// What seventeen children are ordered by: twice their centres along each axis, and their extents. Infinity follows.
struct SplitKeys {
    float of[4][kSplitPadded];

    SplitKeys(const BoundBlock& block, const LaneBounds& one_more) {
        for (std::size_t first = 0; first < kBoxBlock; first += 4) {
            Lanes4 low[3], high[3];
            for (int i = 0; i < 3; ++i) {
                low[i] = load_lanes(block.low[i] + first);
                high[i] = load_lanes(block.high[i] + first);
                put(i, first, low[i] + high[i]);
            }
            put(3, first, (high[0] - low[0]) + (high[1] - low[1]) + (high[2] - low[2]));
        }
        for (auto& key : of) std::fill_n(key + kSplitCount, kSplitPadded - kSplitCount, kInfinity);
        for (int i = 0; i < 3; ++i) of[i][kBoxBlock] = one_more.low[i] + one_more.high[i];
        of[3][kBoxBlock] = extent_of(one_more);
    }

  private:
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
    void put(int key, std::size_t first, const Lanes4& values) { std::memcpy(of[key] + first, &values, sizeof values); }
};

// arrange() gives a block above leaves so many: one more that fills later saves splitting the full ones.
constexpr std::size_t kArrangedLeaves = kBoxBlock - 1;

// Blocks that are made at once get room for a part more.
constexpr std::size_t kRoomPart = 16;

// Grows the room by an eighth: what is loaded and then changes a little does not double its memory.
template <class T>
void append(Vector<T>& values, std::size_t count, const T& value) {
    if (values.size() + count > values.capacity()) values.reserve(values.size() + values.size() / 8 + 4 * kBoxBlock);
    values.resize(values.size() + count, value);
}

}  // namespace

void ItemTree::clear() {
    arrange({});
}

void ItemTree::resize(std::size_t count) {
    if (count > places_.size())
        places_.append(count - places_.size(), kNowhere);
    else if (count < places_.size())
        places_.resize(count);
}

void ItemTree::Level::clear() {
    bounds.clear();
    children.clear();
    parents.clear();
    counts.clear();
    is_marked.clear();
    extents.clear();
    free.clear();
    marked.clear();
}

void ItemTree::Level::reserve(std::size_t blocks) {
    bounds.reserve(blocks);
    children.reserve(blocks * kBoxBlock);
    parents.reserve(blocks);
    counts.reserve(blocks);
    is_marked.reserve(blocks);
    extents.reserve(blocks);
}

void ItemTree::Level::settle() {
    bounds.settle();
    children.settle();
}

BoundTree ItemTree::view() const {
    BoundTree view{};
    for (std::size_t k = 0; k < level_count_; ++k) {
        const Level& level = levels_[k];
        view.levels[k] = level.bounds.data();
        view.children[k] = level.children.data();
        view.parents[k] = level.parents.data();
        view.counts[k] = level.counts.data();
        view.sizes[k] = level.counts.size();
    }
    view.level_count = level_count_;
    view.root = root_;
    return view;
}

void ItemTree::arrange(std::span<const std::uint32_t> order) {
    places_.assign(places_.size(), kNowhere);
    size_ = order.size();
    std::size_t below = order.size(), k = 0;
    for (; k < 2 || below > 1; ++k) {
        Level& level = levels_[k];
        const std::size_t most = k == 1 ? kArrangedLeaves : kBoxBlock,
                          blocks = std::max<std::size_t>(k > 0 ? 1 : 0, (below + most - 1) / most);
        if (blocks > level.bounds.capacity())
            level.reserve(blocks + blocks / kRoomPart + std::min(blocks, 3 * kBoxBlock));
        level.bounds.resize(blocks);
        level.children.assign(blocks * kBoxBlock, 0);
        level.parents.resize(blocks);
        level.counts.assign(blocks, static_cast<std::uint8_t>(most));
        level.is_marked.assign(blocks, 0);
        level.extents.assign(blocks, 0.0f);
        level.free.clear();
        level.marked.clear();
        if (blocks > 0) level.counts[blocks - 1] = static_cast<std::uint8_t>(below - (blocks - 1) * most);
        for (std::size_t n = 0; n < below; ++n) {
            const std::size_t place = n / most * kBoxBlock + n % most;
            level.children.set(place, k == 0 ? order[n] : static_cast<std::uint32_t>(n));
            set_place(k, level.children[place], static_cast<std::uint32_t>(place));
        }
        for (std::size_t block = 0; block < blocks; ++block) clear_unused(k, block);
        below = blocks;
    }
    for (std::size_t above = k; above < kMaxLevels; ++above) levels_[above].clear();
    level_count_ = k;
    root_ = 0;
}

void ItemTree::clear_unused(std::size_t level, std::size_t block) {
    for (std::size_t lane = levels_[level].counts[block]; lane < kBoxBlock; ++lane)
        put_lane(kEmpty, lane, levels_[level].bounds.edit(block));
}

void ItemTree::bound_all() {
    extent_ = remembered_ = 0.0;
    constexpr std::size_t kAtOnce = 64;
    LaneBounds unions[kAtOnce];
    for (std::size_t k = 0; k + 1 < level_count_; ++k) {
        const Level& level = levels_[k];
        for (std::size_t begin = 0; begin < level.counts.size(); begin += kAtOnce) {
            const std::size_t count = std::min(kAtOnce, level.counts.size() - begin);
            bound_blocks(level.bounds.data() + begin, nullptr, count, unions);
            for (std::size_t n = 0; n < count; ++n) {
                if (level.counts[begin + n] == 0) continue;
                const std::uint32_t place = level.parents[begin + n];
                put_lane(unions[n], place % kBoxBlock, levels_[k + 1].bounds.edit(place / kBoxBlock));
                if (k > 0 || unions[n].low[0] > unions[n].high[0]) continue;
                extent_ += static_cast<double>(extent_of(unions[n]));
                remembered_ += static_cast<double>(level.extents[begin + n]);
            }
        }
    }
}

void ItemTree::remember_extents() {
    for (std::size_t k = 0; k + 1 < level_count_; ++k)
        for (std::uint32_t block = 0; block < levels_[k].counts.size(); ++block)
            if (levels_[k].counts[block] != 0) levels_[k].extents[block] = extent_of(bounds_of(k, block));
    remembered_ = extent_;
}

bool ItemTree::is_worn() const {
    const auto leaves = static_cast<double>(levels_[0].counts.size() - levels_[0].free.size()),
               fewest = static_cast<double>(size_ / kBoxBlock + 1);
    return extent_ > kWornGrowth * remembered_ || leaves > kWornCount * fewest + 4.0;
}

LaneBounds ItemTree::bounds_of(std::size_t level, std::uint32_t block) const {
    const std::uint32_t place = levels_[level].parents[block];
    return lane_of(levels_[level + 1].bounds[place / kBoxBlock], place % kBoxBlock);
}

bool ItemTree::is_loose(std::size_t level, std::uint32_t block) const {
    return extent_of(bounds_of(level, block)) > kLooseGrowth * levels_[level].extents[block];
}

std::uint32_t ItemTree::make_block(std::size_t level) {
    Level& made = levels_[level];
    if (!made.free.empty()) {
        const std::uint32_t block = made.free.back();
        made.free.pop_back();
        return block;
    }
    made.bounds.append(BoundBlock());
    made.children.append(kBoxBlock, 0);
    append(made.parents, 1, std::uint32_t{0});
    append(made.counts, 1, std::uint8_t{0});
    append(made.is_marked, 1, std::uint8_t{0});
    append(made.extents, 1, 0.0f);
    return static_cast<std::uint32_t>(made.counts.size() - 1);
}

// The block's children are these alone.
void ItemTree::fill(std::size_t level, std::uint32_t block, std::span<const Entry> entries) {
    Level& filled = levels_[level];
    filled.counts[block] = static_cast<std::uint8_t>(entries.size());
    BoundBlock& bounds = filled.bounds.edit(block);
    for (std::size_t lane = 0; lane < kBoxBlock; ++lane) {
        const bool used = lane < entries.size();
        put_lane(used ? entries[lane].bounds : kEmpty, lane, bounds);
        filled.children.set(block * kBoxBlock + lane, used ? entries[lane].child : 0);
        if (used) set_place(level, entries[lane].child, static_cast<std::uint32_t>(block * kBoxBlock + lane));
    }
}

// Into the block of its level that grows least on the way down.
void ItemTree::put(const Entry& entry) {
    if (levels_[level_count_ - 1].counts[root_] == 0) return add_leaf(root_, entry);  // then there are two levels
    std::uint32_t block = root_, parent = root_;
    for (std::size_t k = level_count_ - 1; k > entry.level; --k) {
        parent = block;
        block = levels_[k].children[block * kBoxBlock + lane_for(levels_[k].bounds[block], entry.bounds)];
    }
    if (full_leaves_ == FullLeaves::share_one_more && entry.level == 0 && levels_[0].counts[block] == kBoxBlock) {
        const std::size_t leaves = levels_[1].counts[parent];
        if (leaves == kArrangedLeaves) return add_leaf(parent, entry);
        const std::uint32_t last = levels_[1].children[parent * kBoxBlock + leaves - 1];
        if (leaves == kBoxBlock && levels_[0].counts[last] < kBoxBlock) block = last;
    }
    add(entry.level, block, entry);
}

// A leaf of one item.
void ItemTree::add_leaf(std::uint32_t parent, const Entry& entry) {
    const std::uint32_t leaf = make_block(0);
    fill(0, leaf, {&entry, 1});
    levels_[0].extents[leaf] = extent_of(entry.bounds);
    add(1, parent, {1, leaf, entry.bounds});
}

void ItemTree::add(std::size_t level, std::uint32_t block, const Entry& entry) {
    Level& to = levels_[level];
    const std::size_t lane = to.counts[block];
    if (lane == kBoxBlock) return split(level, block, entry);
    ++to.counts[block];
    put_lane(entry.bounds, lane, to.bounds.edit(block));
    to.children.set(block * kBoxBlock + lane, entry.child);
    set_place(level, entry.child, static_cast<std::uint32_t>(block * kBoxBlock + lane));
    grow(level, block, entry.bounds);
}

// The bounds above a block take these in.
void ItemTree::grow(std::size_t level, std::uint32_t block, const LaneBounds& bounds) {
    for (std::size_t k = level; k + 1 < level_count_; ++k) {
        const std::uint32_t place = levels_[k].parents[block];
        BoundBlock& above = levels_[k + 1].bounds.edit(place / kBoxBlock);
        const LaneBounds before = lane_of(above, place % kBoxBlock);
        LaneBounds now = before;
        include(bounds, now);
        if (are_equal(now, before)) return;
        put_lane(now, place % kBoxBlock, above);
        levels_[k].extents[block] += extent_of(now) - extent_of(before);
        block = place / kBoxBlock;
    }
}

// Seventeen children in two blocks, cut along the axis, or by size, where the sum of both blocks' extents is least.
void ItemTree::split(std::size_t level, std::uint32_t block, const Entry& entry) {
    constexpr std::size_t kCount = kSplitCount;
    const BoundBlock& from = levels_[level].bounds[block];
    WideBounds wide[kCount];
    for (std::size_t lane = 0; lane < kBoxBlock; ++lane) wide[lane] = lane_of(from, lane);
    wide[kBoxBlock] = entry.bounds;
    float least = std::numeric_limits<float>::infinity();
    std::size_t cut = kCount / 2;
    SplitOrder order, best_order;
    std::iota(best_order.begin(), best_order.end(), std::uint8_t{0});
    const SplitKeys keys(from, entry.bounds);
    for (const auto& key : keys.of) {
        put_in_order(key, order);
        float extent_from[kCount + 1];
        WideBounds bounds = kEmpty;
        for (std::size_t n = kCount; n-- > kFewestAfterSplit;) {
            bounds.include(wide[order[n]]);
            extent_from[n] = bounds.extent();
        }
        bounds = kEmpty;
        const float least_before = least;
        for (std::size_t n = 1; n <= kCount - kFewestAfterSplit; ++n) {
            bounds.include(wide[order[n - 1]]);
            if (n < kFewestAfterSplit) continue;
            const float sum = bounds.extent() + extent_from[n];
            if (!(sum < least)) continue;
            least = sum;
            cut = n;
        }
        if (least < least_before) best_order = order;
    }
    Entry best[kCount];
    WideBounds bounds[2] = {kEmpty, kEmpty};
    for (std::size_t n = 0; n < kCount; ++n) {
        const std::size_t lane = best_order[n];
        const std::uint32_t child = lane == kBoxBlock ? entry.child : levels_[level].children[block * kBoxBlock + lane];
        best[n] = {level, child, wide[lane].narrow()};
        bounds[n < cut ? 0 : 1].include(wide[lane]);
    }
    const std::uint32_t other = make_block(level);
    fill(level, block, {best, cut});
    fill(level, other, {best + cut, kCount - cut});
    const Entry halves[2] = {{level + 1, block, bounds[0].narrow()}, {level + 1, other, bounds[1].narrow()}};
    for (const Entry& half : halves) levels_[level].extents[half.child] = extent_of(half.bounds);
    if (level + 1 == level_count_) {
        ++level_count_;
        root_ = make_block(level + 1);
        return fill(level + 1, root_, halves);
    }
    const std::uint32_t place = levels_[level].parents[block];
    put_lane(halves[0].bounds, place % kBoxBlock, levels_[level + 1].bounds.edit(place / kBoxBlock));
    grow(level + 1, place / kBoxBlock, halves[0].bounds);
    add(level + 1, place / kBoxBlock, halves[1]);
}

void ItemTree::insert(std::uint32_t item, const LaneBounds& bounds) {
    put({0, item, bounds});
    ++size_;
}

// The bounds above a block after it has lost something.
void ItemTree::shrink(std::size_t level, std::uint32_t block) {
    for (std::size_t k = level; k + 1 < level_count_; ++k) {
        LaneBounds now;
        bound_blocks(levels_[k].bounds.data(), &block, 1, &now);
        const std::uint32_t place = levels_[k].parents[block];
        BoundBlock& above = levels_[k + 1].bounds.edit(place / kBoxBlock);
        if (are_equal(now, lane_of(above, place % kBoxBlock))) return;
        put_lane(now, place % kBoxBlock, above);
        levels_[k].extents[block] = std::min(levels_[k].extents[block], extent_of(now));
        block = place / kBoxBlock;
    }
}

// A child out of its block, whose last child takes its lane. What is left of a block that is given up are orphans.
void ItemTree::take(std::size_t level, std::uint32_t place) {
    Level& from = levels_[level];
    const std::uint32_t block = place / kBoxBlock;
    const std::size_t last = --from.counts[block];
    if (place % kBoxBlock != last) {
        const std::uint32_t child = from.children[block * kBoxBlock + last];
        put_lane(lane_of(from.bounds[block], last), place % kBoxBlock, from.bounds.edit(block));
        from.children.set(place, child);
        set_place(level, child, place);
    }
    put_lane(kEmpty, last, from.bounds.edit(block));
    from.children.set(block * kBoxBlock + last, 0);
    if (level + 1 == level_count_) return;
    const std::uint32_t above = from.parents[block];
    const bool has_siblings = levels_[level + 1].counts[above / kBoxBlock] > 1;
    if (last > 0 && (last >= kFewestLanes || !has_siblings)) return shrink(level, block);
    give_up(level, block);
}

// The block's children become orphans.
void ItemTree::give_up(std::size_t level, std::uint32_t block) {
    Level& from = levels_[level];
    for (std::size_t lane = 0; lane < from.counts[block]; ++lane)
        orphans_.push_back({level, from.children[block * kBoxBlock + lane], lane_of(from.bounds[block], lane)});
    fill(level, block, {});
    from.free.push_back(block);
    take(level + 1, from.parents[block]);
}

void ItemTree::put_orphans() {
    while (!orphans_.empty()) {
        const Entry entry = orphans_.back();
        orphans_.pop_back();
        put(entry);
    }
    for (; level_count_ > 2 && levels_[level_count_ - 1].counts[root_] == 1; --level_count_) {
        const std::uint32_t child = levels_[level_count_ - 1].children[root_ * kBoxBlock];
        levels_[level_count_ - 1].clear();
        root_ = child;
    }
}

void ItemTree::remove(std::uint32_t item) {
    take(0, places_[item]);
    places_.set(item, kNowhere);
    --size_;
    put_orphans();
}

void ItemTree::mark(std::size_t level, std::uint32_t block) {
    if (levels_[level].is_marked[block] != 0) return;
    levels_[level].is_marked[block] = 1;
    levels_[level].marked.push_back(block);
}

void ItemTree::fetch_place(std::uint32_t item) const {
    hwy::Prefetch(&places_[item]);
}

void ItemTree::fetch_leaf(std::uint32_t item) const {
    if (!contains(item)) return;
    const char* const bytes = reinterpret_cast<const char*>(&levels_[0].bounds[places_[item] / kBoxBlock]);
    for (std::size_t byte = 0; byte < sizeof(BoundBlock); byte += 64) hwy::Prefetch(bytes + byte);
}

void ItemTree::move(std::uint32_t item, const LaneBounds& bounds) {
    const std::uint32_t place = places_[item];
    put_lane(bounds, place % kBoxBlock, levels_[0].bounds.edit(place / kBoxBlock));
    mark(0, place / kBoxBlock);
}

// The bounds above marked leaves; what they change is marked.
void ItemTree::bound_marked() {
    LaneBounds unions[kBoxBlock];
    for (std::size_t k = 0; k + 1 < level_count_; ++k) {
        Level& level = levels_[k];
        for (std::size_t begin = 0; begin < level.marked.size(); begin += kBoxBlock) {
            const std::size_t count = std::min(kBoxBlock, level.marked.size() - begin);
            bound_blocks(level.bounds.data(), level.marked.data() + begin, count, unions);
            for (std::size_t n = 0; n < count; ++n) {
                const std::uint32_t place = level.parents[level.marked[begin + n]];
                BoundBlock& above = levels_[k + 1].bounds.edit(place / kBoxBlock);
                if (are_equal(unions[n], lane_of(above, place % kBoxBlock))) continue;
                put_lane(unions[n], place % kBoxBlock, above);
                float& extent = level.extents[level.marked[begin + n]];
                extent = std::min(extent, extent_of(unions[n]));
                mark(k + 1, place / kBoxBlock);
            }
        }
    }
}

// Of the children that moved, those in loose blocks of a level; then all that is in blocks that are loose still.
void ItemTree::put_again(std::size_t level, std::span<const std::uint32_t> moved) {
    escaped_.clear();
    loose_.clear();
    for (const std::uint32_t child : moved) {
        if (level > 0 && levels_[level - 1].counts[child] == 0) continue;  // has been given up
        const std::uint32_t place = place_of(level, child);
        if (place == kNowhere || !is_loose(level, place / kBoxBlock)) continue;
        escaped_.push_back({level, child, lane_of(levels_[level].bounds[place / kBoxBlock], place % kBoxBlock)});
        loose_.push_back(place / kBoxBlock);
    }
    for (const Entry& entry : escaped_) {
        if (level >= level_count_) break;  // the tree has become lower: the child is its root
        take(level, place_of(level, entry.child));
        orphans_.push_back(entry);
        put_orphans();
    }
    for (const std::uint32_t block : loose_) {
        if (level + 1 >= level_count_) return;
        if (levels_[level].counts[block] == 0 || !is_loose(level, block)) continue;
        if (levels_[level + 1].counts[levels_[level].parents[block] / kBoxBlock] > 1) give_up(level, block);
        put_orphans();
    }
}

// From below: items that have gone far make the blocks above them loose only until they are put again.
void ItemTree::settle(std::span<const std::uint32_t> moved) {
    bound_marked();
    put_again(0, moved);
    for (std::size_t k = 1; k + 1 < level_count_; ++k) put_again(k, levels_[k - 1].marked);
    for (Level& level : levels_) {
        for (const std::uint32_t block : level.marked) level.is_marked[block] = 0;
        level.marked.clear();
        level.settle();
    }
    places_.settle();
}

}  // namespace crofton::collide
