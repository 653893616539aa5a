// SPDX-License-Identifier: MIT
#include "builder.hpp"

#include <algorithm>
#include <cmath>
#include <crofton/boxtree/items.hpp>
#include <crofton/geometry/trigonometry.hpp>

namespace crofton::boxtree {
namespace {

constexpr std::uint32_t kClusterRow = kWidth * kWidth;  // items of a cluster, times the leaves of a node
constexpr double kCells = 1u << 20;
constexpr std::size_t kWorkOfUnit = 16;  // the unit of budgets in the splitter's
constexpr std::size_t kCrowd = 256;      // items; a cell with more of them is sorted by smaller cells

// Moves ten bits to every third place.
std::uint32_t spread(std::uint32_t v) {
    v = (v | v << 16) & 0x030000ffu;
    v = (v | v << 8) & 0x0300f00fu;
    v = (v | v << 4) & 0x030c30c3u;
    return (v | v << 2) & 0x09249249u;
}

std::uint64_t z_order(const std::array<std::uint32_t, 3>& cell, unsigned shift) {
    std::uint32_t code = 0;
    for (unsigned j = 0; j < 3; ++j) code |= spread(cell[j] >> shift & 1023u) << j;
    return code;
}

}  // namespace

Builder::Builder(const Aabb& scene, std::size_t items, const measure::Criterion& criterion, Orientation orientation,
                 const BuildGrain& grain)
    : cost_(criterion),
      orientation_(orientation),
      small_crowd_(grain.small_crowd),
      middle_(scene.is_empty() ? glm::dvec3(0.0) : scene.center()) {
    if (!scene.is_empty())
        for (int j = 0; j < 3; ++j) half_size_ = std::max(half_size_, scene.half_extents()[j]);
    // One scale for all axes, so that cells are cubes.
    if (half_size_ > 1e-30) cells_per_unit_ = kCells / (2.0 * half_size_);
    cell_ = static_cast<float>(2.0 * half_size_ / cube_root(static_cast<double>(std::max<std::size_t>(items, 1))));
    result_.node_leaves = grain.node_leaves;
    keys_.reserve(with_room(items));
    keys_next_.reserve(with_room(items));
}

std::array<std::uint32_t, 3> Builder::cell_of(const glm::dvec3& center) const {
    std::array<std::uint32_t, 3> cell;
    for (int j = 0; j < 3; ++j) {
        const double position = (center[j] - middle_[j] + half_size_) * cells_per_unit_;
        cell[static_cast<std::size_t>(j)] = static_cast<std::uint32_t>(std::clamp(position, 0.0, kCells - 1.0));
    }
    return cell;
}

ItemId Builder::item_of(std::uint64_t key) {
    return static_cast<ItemId>(key & ((std::uint64_t{1} << kItemBits) - 1));
}

// The key by which items are sorted: large boxes first, then along a Z-order curve through the centres. Beside small
// boxes a large one would make every bound large. Sizes are compared by powers of two of a cell.
std::uint64_t Builder::key_of(ItemId id, const Obb& box) const {
    float half_size = 0.0f;
    for (int j = 0; j < 3; ++j) {
        float sum = 0.0f;
        for (int k = 0; k < 3; ++k) sum += std::fabs(box.axes[k][j]) * box.half_extents[k];
        half_size = std::max(half_size, sum);
    }
    std::uint64_t size_class = 0;
    for (float limit = 4.0f * cell_; half_size > limit && size_class < 15; limit *= 2.0f) ++size_class;
    return ((15 - size_class) << 3 * kFineBits | z_order(cell_of(box.center), kFineBits)) << kItemBits | id;
}

void Builder::add(ItemId id, const Obb& box) {
    const std::uint64_t key = key_of(id, box);
    for (unsigned pass = 0; pass < kPasses; ++pass)
        ++histograms_[pass][key >> (kItemBits + pass * kDigitBits) & (histograms_[pass].size() - 1)];
    keys_.push_back(key);
    keys_next_.push_back(0);
}

bool Builder::step(std::size_t budget, std::span<const Obb> boxes, const Movers& movers) {
    if (!prepare_some(budget, boxes, movers)) return false;
    while (next_ < subtrees_.size()) {
        result_.leaves.resize(subtrees_[next_].first_leaf + std::size_t{subtrees_[next_].leaves});
        if (subtrees_[next_].is_leaf()) {
            (void)build(next_++, subtree_builder_, boxes, ~std::size_t{0}, [] { return false; });
            continue;
        }
        if (!std::exchange(building_, true)) subtree_builder_.start(subtrees_[next_], middle_);
        if (!subtree_builder_.step(budget, cost_, orientation_, boxes, result_)) return false;
        building_ = false;
        ++next_;
    }
    return true;
}

bool Builder::build(std::size_t subtree, SubtreeBuilder& with, std::span<const Obb> boxes, std::size_t budget,
                    FunctionRef<bool()> wants_stop) {
    with.start(subtrees_[subtree], middle_);
    for (std::size_t left = budget; !with.step(left, cost_, orientation_, boxes, result_); left = budget)
        if (wants_stop()) return false;
    return !wants_stop();
}

bool Builder::prepare(std::size_t budget, std::span<const Obb> boxes, const Movers& movers) {
    return prepare_some(budget, boxes, movers);
}

bool Builder::prepare_some(std::size_t& budget, std::span<const Obb> boxes, const Movers& movers) {
    if (phase_ == Phase::sort && pass_ == 0 && next_ == 0 && keys_.size() <= small_crowd_) place_all();
    while (phase_ != Phase::ready && budget > 0) budget -= std::min(budget, prepare_on(budget, boxes, movers));
    return phase_ == Phase::ready;
}

std::size_t Builder::prepare_on(std::size_t budget, std::span<const Obb> boxes, const Movers& movers) {
    switch (phase_) {
        case Phase::sort:
            return sort_pass(budget);
        case Phase::crowding:
            return find_crowding(budget, boxes);
        case Phase::gather:
            return gather_items(budget, boxes, movers);
        case Phase::append:
            return append_moving(budget);
        case Phase::gather_all:
            return gather_all(budget);
        case Phase::label:
            return label_items(budget);
        case Phase::bound:
            return bound_clusters(budget, boxes);
        default:
            return place_clusters(budget);
    }
}

// A radix sort, the least significant digit first.
std::size_t Builder::sort_pass(std::size_t budget) {
    auto& places = histograms_[pass_];
    if (next_ == 0) {
        std::uint32_t sum = 0;
        for (std::uint32_t& count : places) sum += std::exchange(count, sum);
    }
    const unsigned shift = kItemBits + pass_ * kDigitBits;
    const std::size_t end = std::min(keys_.size(), next_ + budget + budget / 2), spent = (end - next_) * 2 / 3 + 1;
    for (; next_ < end; ++next_) keys_next_[places[keys_[next_] >> shift & (places.size() - 1)]++] = keys_[next_];
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    keys_.swap(keys_next_);
    if (++pass_ == kPasses) phase_ = Phase::crowding;
    return spent;
}

// Sorts cells that hold many items by smaller cells. Where a far outlier makes even these too large, the whole crowd is
// split from the top instead.
std::size_t Builder::find_crowding(std::size_t budget, std::span<const Obb> boxes) {
    const std::size_t first = next_;
    while (next_ < keys_.size() && (next_ - first) / 4 < budget) {
        const std::size_t begin = next_++;
        while (next_ < keys_.size() && keys_[next_] >> kItemBits == keys_[begin] >> kItemBits) ++next_;
        if (next_ - begin > kCrowd) sort_crowd(std::span(keys_).subspan(begin, next_ - begin), boxes);
    }
    const std::size_t spent = (next_ - first + 3) / 4;
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    if (crowded_ > keys_.size() / 4) {
        place_all();
    } else {
        result_.order.reserve(keys_.size());
        cluster_of_.reserve(with_room(boxes.size()));
        phase_ = Phase::gather;
    }
    return spent;
}

void Builder::sort_crowd(std::span<std::uint64_t> keys, std::span<const Obb> boxes) {
    const std::uint64_t cell = keys[0] >> kItemBits << kItemBits;
    for (std::uint64_t& key : keys) key = z_order(cell_of(boxes[item_of(key)].center), 0) << kItemBits | item_of(key);
    std::sort(keys.begin(), keys.end());
    for (std::size_t i = 1; i < keys.size(); ++i) crowded_ += keys[i] >> kItemBits == keys[i - 1] >> kItemBits;
    for (std::uint64_t& key : keys) key = cell | item_of(key);
}

// Cuts the sorted items into clusters: first those at rest, then those that move.
std::size_t Builder::gather_items(std::size_t budget, std::span<const Obb> boxes, const Movers& movers) {
    const std::size_t end = std::min(keys_.size(), next_ + budget), spent = end - next_;
    for (; next_ < end; ++next_) {
        const ItemId item = item_of(keys_[next_]);
        (movers.contain(movers.context, item) ? moving_ : result_.order).push_back(item);
    }
    cluster_of_.resize(std::max(cluster_of_.size(), boxes.size() * next_ / keys_.size()), kNone);
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    resting_count_ = result_.order.size();
    phase_ = Phase::append;
    return spent;
}

std::size_t Builder::append_moving(std::size_t budget) {
    const std::size_t end = std::min(moving_.size(), next_ + 4 * budget), spent = (end - next_ + 3) / 4;
    for (; next_ < end; ++next_) result_.order.push_back(moving_[next_]);
    if (next_ < moving_.size()) return spent;
    start_clusters();
    return spent;
}

void Builder::start_clusters() {
    const auto end = static_cast<std::uint32_t>(result_.order.size());
    const auto resting = static_cast<std::uint32_t>(resting_count_);
    const std::uint32_t size = kClusterRow * result_.node_leaves;
    for (std::uint32_t begin = 0; begin < resting; begin += size)
        cluster_ranges_.push_back({begin, std::min(begin + size, resting)});
    for (std::uint32_t begin = resting; begin < end; begin += size)
        cluster_ranges_.push_back({begin, std::min(begin + size, end)});
    clusters_.assign(cluster_ranges_.size(), kNothing);
    for (std::uint32_t c = 0; c < clusters_.size(); ++c) clusters_[c].set_id(c);
    next_ = 0;
    phase_ = Phase::label;
}

// Notes each item's cluster, so that boxes can be read in the order in which they are stored.
std::size_t Builder::label_items(std::size_t budget) {
    const std::size_t all = result_.order.size(), end = std::min(all, next_ + budget), spent = end - next_;
    for (; next_ < end; ++next_) {
        while (next_ == cluster_ranges_[labels_].end) ++labels_;
        cluster_of_[result_.order[next_]] = labels_;
    }
    if (next_ == all) {
        next_ = 0;
        phase_ = Phase::bound;
    }
    return spent;
}

std::size_t Builder::bound_clusters(std::size_t budget, std::span<const Obb> boxes) {
    const std::size_t end = std::min(cluster_of_.size(), next_ + budget), spent = end - next_;
    for (; next_ < end; ++next_)
        if (cluster_of_[next_] != kNone) {
            BuildItem& cluster = clusters_[cluster_of_[next_]];
            const std::uint32_t id = cluster.id();
            cluster.include(build_item(0, boxes[next_], middle_));
            cluster.set_id(id);
        }
    if (next_ == cluster_of_.size()) phase_ = Phase::place;
    return spent;
}

// Makes the nodes above the clusters by splitting from the top. Then gives the clusters places in the order of a walk.
std::size_t Builder::place_clusters(std::size_t budget) {
    Above& above = above_;
    std::size_t work = std::min(budget, ~std::size_t{0} / kWorkOfUnit) * kWorkOfUnit;
    if (above.tasks.empty() && above.divided == kNone) {
        above.splitter.begin(clusters_);
        above.tasks.push_back({{0, static_cast<std::uint32_t>(clusters_.size())}, kNone, 0, 0});
    }
    if (!above.splitter.sort_on(work)) return budget;
    while (!above.tasks.empty() || above.divided != kNone) {
        if (above.divided != kNone) {
            if (!above.splitter.divide_on(cost_, work)) return budget;
            const Children& children = above.splitter.children();
            result_.nodes[above.divided].count = children.count;
            for (std::uint32_t lane = children.count; lane-- > 0;)
                above.tasks.push_back({children.ranges[lane], above.divided, lane, above.depth + 1});
            above.divided = kNone;
        }
        if (work == 0) return budget;
        work -= std::min(work, kWorkOfUnit);
        const Above::Task task = above.tasks.back();
        above.tasks.pop_back();
        if (task.range.size() == 1) {
            Subtree subtree(cluster_ranges_[above.splitter.order()[task.range.begin]], result_.node_leaves);
            subtree.parent = task.parent;
            subtree.lane_in_parent = task.lane;
            result_.height = std::max(result_.height, task.depth + (subtree.is_leaf() ? 0 : subtree.height));
            subtrees_.push_back(subtree);
            continue;
        }
        above.divided = static_cast<NodeId>(result_.nodes.size());
        above.depth = task.depth;
        Topology::NodeRecord& record = result_.nodes.emplace_back();
        record.parent = task.parent;
        record.lane_in_parent = task.lane;
        if (task.parent != kNone) result_.nodes[task.parent].child[task.lane] = above.divided;
        above.splitter.begin_division(task.range, 1);
    }
    above_ = {};
    place_subtrees();
    return budget - work / kWorkOfUnit;
}

// Splits all items from the root, without clusters.
void Builder::place_all() {
    result_.order.clear();
    result_.order.reserve(keys_.size());
    next_ = 0;
    phase_ = Phase::gather_all;
}

std::size_t Builder::gather_all(std::size_t budget) {
    const std::size_t end = std::min(keys_.size(), next_ + 8 * budget), spent = (end - next_ + 7) / 8;
    for (; next_ < end; ++next_) result_.order.push_back(item_of(keys_[next_]));
    if (next_ < keys_.size()) return spent;
    subtrees_.emplace_back(Range{0, static_cast<std::uint32_t>(keys_.size())}, result_.node_leaves);
    result_.height = subtrees_[0].height;
    place_subtrees();
    return spent;
}

void Builder::place_subtrees() {
    const std::size_t above = result_.nodes.size();
    auto node = static_cast<NodeId>(above);
    LeafId leaf = 0;
    for (Subtree& subtree : subtrees_) {
        subtree.first_node = node;
        subtree.first_leaf = leaf;
        if (subtree.is_leaf()) subtree.nodes = 0;
        if (subtree.parent != kNone)
            result_.nodes[subtree.parent].child[subtree.lane_in_parent] = subtree.is_leaf() ? leaf | kLeafBit : node;
        node += subtree.nodes;
        leaf += subtree.leaves;
    }
    result_.nodes.resize(node);
    if (orientation_ != Orientation::aligned) result_.axes.resize(std::size_t{node} + 1);
    leaf_count_ = leaf;
    result_.leaves.reserve(leaf);
    for (const Subtree& subtree : subtrees_)
        if (!subtree.is_leaf()) result_.nodes[subtree.first_node].leaves = {subtree.first_leaf, subtree.leaves};
    for (auto n = static_cast<NodeId>(above); n-- > 0;) {
        Topology::NodeRecord& record = result_.nodes[n];
        const auto leaves_of = [&](std::uint32_t child) {
            return child & kLeafBit ? LeafRange{child & ~kLeafBit, 1} : result_.nodes[child].leaves;
        };
        const LeafRange last = leaves_of(record.child[record.count - 1]);
        record.leaves.first = leaves_of(record.child[0]).first;
        record.leaves.count = last.first + last.count - record.leaves.first;
    }
    keys_ = {};
    keys_next_ = {};
    cluster_of_ = {};
    next_ = 0;
    phase_ = Phase::ready;
}

}  // namespace crofton::boxtree
