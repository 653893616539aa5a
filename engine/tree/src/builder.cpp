#include "builder.hpp"

#include <algorithm>
#include <cmath>

namespace crofton::tree {
namespace {

constexpr std::uint32_t kClusterItems = kWidth * kWidth * kWidth;
// Up to here the whole crowd is split from the top: the best tree, at a cost that grows with n log n.
constexpr std::size_t kSmallCrowd = 32768;
constexpr unsigned kDigitBits = 11;
constexpr unsigned kPasses = 5;
constexpr unsigned kAxisBits = 17;  // three times that and four bits for the size make five digits
constexpr float kMostCell = static_cast<float>((1u << kAxisBits) - 1);

// Spreads 20 bits to every third.
std::uint64_t spread(std::uint64_t v) {
    v = (v | v << 32) & 0x001f00000000ffffu;
    v = (v | v << 16) & 0x001f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    return (v | v << 2) & 0x1249249249249249u;
}

}  // namespace

Builder::Builder(const Aabb& scene, std::size_t items, const measure::Criterion& criterion)
    : cost_(criterion), middle_(scene.is_empty() ? glm::dvec3(0.0) : scene.center()) {
    float largest = 0.0f;
    for (int j = 0; j < 3; ++j) {
        const double half = scene.is_empty() ? 0.0 : scene.half_extents()[j];
        low_[j] = static_cast<float>(-half);
        largest = std::max(largest, static_cast<float>(2.0 * half));
    }
    // One scale for all axes, so that cells are cubes.
    for (float& scale : inverse_size_) scale = largest > 1e-30f ? 1.0f / largest : 0.0f;
    cell_ = largest / static_cast<float>(std::cbrt(static_cast<double>(std::max<std::size_t>(items, 1))));
    items_.reserve(items);
}

void Builder::add(ItemId id, const Obb& box) {
    BuildItem item{};
    for (int j = 0; j < 3; ++j) {
        double reach = 0.0;
        for (int k = 0; k < 3; ++k) reach += std::fabs(double{box.axes[k][j]}) * double{box.half_extents[k]};
        const double center = box.center[j] - middle_[j];
        item.extreme[j] = static_cast<float>(reach - center);
        item.extreme[4 + j] = static_cast<float>(center + reach);
    }
    item.set_id(id);
    items_.push_back(item);
}

bool Builder::step(std::size_t budget, const Movers& movers, Executor& executor) {
    if (phase_ == Phase::keys && next_ == 0 && items_.size() <= kSmallCrowd) start_assembly();
    while (phase_ != Phase::done) {
        std::size_t spent = 0;
        switch (phase_) {
            case Phase::keys:
                spent = compute_keys(budget);
                break;
            case Phase::sort:
                spent = sort_pass(budget);
                break;
            case Phase::crowding:
                spent = find_crowding(budget);
                break;
            case Phase::gather:
                spent = gather_items(budget, movers);
                break;
            case Phase::append:
                spent = append_moving(budget);
                break;
            case Phase::clusters:
                spent = make_clusters(budget);
                break;
            case Phase::split:
                spent = split_clusters(budget, executor);
                break;
            case Phase::assemble:
                spent = assemble(budget);
                break;
            default:
                spent = list_order(budget);
                break;
        }
        if (spent >= budget) return phase_ == Phase::done;
        budget -= spent;
    }
    return true;
}

// Large boxes first, by powers of two of their size in cells of the mean spacing: beside small ones they would blow up
// bounds. Then a Z-order curve through the centres.
std::size_t Builder::compute_keys(std::size_t budget) {
    const std::size_t end = std::min(items_.size(), next_ + budget), spent = end - next_;
    keys_.reserve(items_.size());
    keys_next_.reserve(items_.size());
    keys_next_.resize(end);
    for (; next_ < end; ++next_) {
        const BuildItem& item = items_[next_];
        std::uint64_t code = 0;
        float extent = 0.0f;
        for (unsigned j = 0; j < 3; ++j) {
            extent = std::max(extent, item.extreme[4 + j] + item.extreme[j]);
            const float position = (0.5f * item.twice_center(j) - low_[j]) * inverse_size_[j];
            code |= spread(static_cast<std::uint64_t>(std::clamp(position, 0.0f, 1.0f) * kMostCell)) << j;
        }
        int size_class = 0;
        for (float limit = 8.0f * cell_; extent > limit && size_class < 15; limit *= 2.0f) ++size_class;
        keys_.push_back({static_cast<std::uint64_t>(15 - size_class) << (3 * kAxisBits) | code,
                         static_cast<std::uint32_t>(next_)});
    }
    if (next_ == items_.size()) {
        next_ = 0;
        phase_ = Phase::sort;
    }
    return spent;
}

// One half of a pass of a least-significant-digit radix sort: counting or moving.
std::size_t Builder::sort_pass(std::size_t budget) {
    const unsigned shift = pass_ * kDigitBits;
    const auto digit = [&](const Key& key) { return key.code >> shift & (histogram_.size() - 1); };
    const std::size_t end = std::min(keys_.size(), next_ + 2 * budget), spent = (end - next_ + 1) / 2;
    if (counting_)
        for (; next_ < end; ++next_) ++histogram_[digit(keys_[next_])];
    else
        for (; next_ < end; ++next_) keys_next_[histogram_[digit(keys_[next_])]++] = keys_[next_];
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    if (counting_) {
        std::uint32_t sum = 0;
        for (std::uint32_t& count : histogram_) sum += std::exchange(count, sum);
    } else {
        histogram_.fill(0);
        keys_.swap(keys_next_);
        if (++pass_ == kPasses) phase_ = Phase::crowding;
    }
    counting_ = !counting_;
    return spent;
}

// Centres too crowded for the curve's cells (a far outlier stretches them): split from the top after all.
std::size_t Builder::find_crowding(std::size_t budget) {
    const std::size_t end = std::min(keys_.size(), next_ + 4 * budget), spent = (end - next_ + 3) / 4;
    for (; next_ < end; ++next_) equal_keys_ += next_ > 0 && keys_[next_].code == keys_[next_ - 1].code;
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    if (equal_keys_ > keys_.size() / 4) {
        start_assembly();
    } else {
        sorted_.reserve(items_.size());
        phase_ = Phase::gather;
    }
    return spent;
}

// Along the curve: those at rest, then those that move.
std::size_t Builder::gather_items(std::size_t budget, const Movers& movers) {
    // From all over memory: worth two of what comes in order.
    const std::size_t end = std::min(keys_.size(), next_ + (budget + 1) / 2), spent = 2 * (end - next_);
    for (; next_ < end; ++next_) {
        const BuildItem& item = items_[keys_[next_].index];
        (movers.contain(movers.context, item.id()) ? moving_ : sorted_).push_back(item);
    }
    if (next_ < keys_.size()) return spent;
    next_ = 0;
    resting_count_ = sorted_.size();
    phase_ = Phase::append;
    return spent;
}

std::size_t Builder::append_moving(std::size_t budget) {
    const std::size_t end = std::min(moving_.size(), next_ + budget), spent = end - next_;
    for (; next_ < end; ++next_) sorted_.push_back(moving_[next_]);
    if (next_ < moving_.size()) return spent;
    next_ = 0;
    items_.swap(sorted_);
    const auto clusters_for = [](std::size_t items) { return (items + kClusterItems - 1) / kClusterItems; };
    clusters_.assign(clusters_for(resting_count_) + clusters_for(moving_.size()), kNothing);
    cluster_children_.resize(clusters_.size());
    phase_ = Phase::clusters;
    return spent;
}

std::size_t Builder::make_clusters(std::size_t budget) {
    const std::size_t first = next_, last = std::min(clusters_.size(), first + budget / kClusterItems + 1);
    for (; next_ < last; ++next_) {
        const Range range = items_of_cluster(static_cast<std::uint32_t>(next_));
        for (std::uint32_t i = range.begin; i < range.end; ++i) clusters_[next_].include(items_[i]);
        clusters_[next_].set_id(static_cast<std::uint32_t>(next_));
    }
    if (next_ == clusters_.size()) {
        next_ = 0;
        phase_ = Phase::split;
    }
    return (last - first) * kClusterItems;
}

Range Builder::items_of_cluster(std::uint32_t cluster) const {
    const std::size_t resting_clusters = (resting_count_ + kClusterItems - 1) / kClusterItems;
    const bool rests = cluster < resting_clusters;
    const std::size_t begin = rests ? std::size_t{cluster} * kClusterItems
                                    : resting_count_ + (cluster - resting_clusters) * kClusterItems;
    const std::size_t end = std::min(begin + kClusterItems, rests ? resting_count_ : items_.size());
    return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

std::size_t Builder::split_clusters(std::size_t budget, Executor& executor) {
    const std::size_t first = next_, count = std::min(cluster_children_.size() - first, budget / kClusterItems / 2 + 1);
    executor.parallel_for(count, 16, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t c = first + begin; c < first + end; ++c)
            cluster_children_[c] = divide(items_, items_of_cluster(static_cast<std::uint32_t>(c)), kWidth, cost_);
    });
    next_ += count;
    if (next_ == cluster_children_.size()) start_assembly();
    return count * kClusterItems * 2;
}

void Builder::start_assembly() {
    const auto units = static_cast<std::uint32_t>(clusters_.empty() ? items_.size() : clusters_.size());
    tasks_.push_back({{0, units}, kNone, 0, 1, !clusters_.empty()});
    phase_ = Phase::assemble;
}

std::size_t Builder::assemble(std::size_t budget) {
    std::size_t spent = 0;
    while (!tasks_.empty() && spent < budget) {
        Task task = tasks_.back();
        tasks_.pop_back();
        std::uint32_t cluster = kNone;
        if (task.of_clusters && task.range.size() == 1) {
            cluster = clusters_[task.range.begin].id();
            task.range = items_of_cluster(cluster);
            task.of_clusters = false;
        }
        if (task.parent != kNone && !task.of_clusters && task.range.size() <= kWidth) {
            add_leaf(task);
            spent += kWidth;
            continue;
        }
        const auto node = static_cast<NodeId>(result_.nodes.size());
        result_.nodes.emplace_back();
        result_.height = std::max(result_.height, task.depth);
        if (task.parent != kNone) result_.nodes[task.parent].child[task.lane] = node;
        Topology::NodeRecord& record = result_.nodes.back();
        record.parent = task.parent;
        record.lane_in_parent = task.lane;
        const Children children = cluster != kNone ? cluster_children_[cluster]
                                                   : divide(task.of_clusters ? std::span(clusters_) : std::span(items_),
                                                            task.range, task.of_clusters ? 1 : kWidth, cost_);
        record.count = children.count;
        spent += cluster != kNone ? kWidth : 4 * std::size_t{task.range.size()};
        // Last in, first out: leaves come out in the order of the lanes.
        for (std::uint32_t lane = record.count; lane-- > 0;)
            tasks_.push_back({children.ranges[lane], node, lane, task.depth + 1, task.of_clusters});
    }
    if (tasks_.empty()) {
        number_leaves();
        next_ = 0;
        phase_ = Phase::order;
    }
    return spent;
}

std::size_t Builder::list_order(std::size_t budget) {
    const std::size_t end = std::min(items_.size(), next_ + 4 * budget), spent = (end - next_ + 3) / 4;
    result_.order.reserve(items_.size());
    for (; next_ < end; ++next_) result_.order.push_back(items_[next_].id());
    if (next_ == items_.size()) phase_ = Phase::done;
    return spent;
}

void Builder::add_leaf(const Task& task) {
    const auto leaf = static_cast<LeafId>(result_.leaves.size());
    result_.leaves.push_back({task.range.begin, task.range.size(), task.parent, task.lane});
    result_.nodes[task.parent].child[task.lane] = leaf | kLeafBit;
}

void Builder::number_leaves() {
    for (auto n = static_cast<NodeId>(result_.nodes.size()); n-- > 0;) {
        Topology::NodeRecord& node = result_.nodes[n];
        if (node.count == 0) continue;
        const auto leaves_of = [&](std::uint32_t child) {
            return child & kLeafBit ? LeafRange{child & ~kLeafBit, 1} : result_.nodes[child].leaves;
        };
        const LeafRange last = leaves_of(node.child[node.count - 1]);
        node.leaves.first = leaves_of(node.child[0]).first;
        node.leaves.count = last.first + last.count - node.leaves.first;
    }
}

}  // namespace crofton::tree
