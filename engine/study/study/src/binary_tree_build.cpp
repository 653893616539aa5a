// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/core/select.hpp>
#include <crofton/fit/fit.hpp>
#include <crofton/study/binary_tree.hpp>
#include <limits>
#include <numeric>

#include "binary_tree_value.hpp"

namespace crofton::study {
namespace {

constexpr unsigned kBins = 16;
constexpr std::size_t kMaxItems = std::size_t{1} << 30;

}  // namespace

class BinaryTreeBuilder {
  public:
    BinaryTreeBuilder(std::span<const Obb> boxes, const BinaryTreeOptions& options, BinaryTree& tree)
        : boxes_(boxes), options_(options), tree_(tree) {}

    void run() {
        tree_.criterion_ = options_.criterion;
        tree_.oriented_ = options_.oriented;
        tree_.leaf_of_.assign(boxes_.size(), kNone);
        tree_.item_count_ = boxes_.size();
        if (boxes_.empty()) return;
        tree_.nodes_.reserve(2 * boxes_.size() - 1);
        for (const Obb& box : boxes_) item_boxes_.push_back(aabb_of(box));
        order_.resize(boxes_.size());
        std::iota(order_.begin(), order_.end(), ItemId{0});
        struct Task {
            std::uint32_t begin, end, parent;
            int side;
            Vector<std::uint32_t> alive;  // queries that straddle all ancestors
        };
        Vector<Task> tasks;
        Vector<std::uint32_t> all;
        if (options_.split == Split::sampled) all = options_.queries->all();
        tasks.push_back({0, static_cast<std::uint32_t>(boxes_.size()), kNone, 0, std::move(all)});
        while (!tasks.empty()) {
            Task task = std::move(tasks.back());
            tasks.pop_back();
            const std::span<ItemId> items = std::span<ItemId>(order_).subspan(task.begin, task.end - task.begin);
            const auto n = static_cast<std::uint32_t>(tree_.nodes_.size());
            tree_.nodes_.push_back(make_node(items, task.alive));
            tree_.nodes_[n].parent = task.parent;
            (task.parent == kNone ? tree_.root_ : tree_.nodes_[task.parent].child[task.side]) = n;
            if (items.size() == 1) {
                tree_.leaf_of_[items[0]] = n;
                continue;
            }
            std::erase_if(task.alive,
                          [&](std::uint32_t q) { return !options_.queries->straddles(q, tree_.nodes_[n].bound); });
            const std::uint32_t middle = task.begin + split(items, task.alive);
            tasks.push_back({middle, task.end, n, 1, task.alive});
            tasks.push_back({task.begin, middle, n, 0, std::move(task.alive)});
        }
    }

  private:
    BinaryTree::Node make_node(std::span<const ItemId> items, std::span<const std::uint32_t> alive) {
        BinaryTree::Node node;
        for (const ItemId i : items) node.box.include(item_boxes_[i]);
        node.bound = obb_of(node.box);
        if (items.size() == 1) {
            node.item = items[0];
            node.bound = boxes_[items[0]];
        } else if (options_.oriented) {
            node.bound = best_bound(items, node.bound, alive);
        }
        return node;
    }

    Obb best_bound(std::span<const ItemId> items, const Obb& aligned, std::span<const std::uint32_t> alive) {
        points_.clear();
        for (const ItemId i : items) {
            const auto c = corners(boxes_[i]);
            points_.insert(points_.end(), c.begin(), c.end());
        }
        std::array<Obb, 4> candidates = {aligned};
        std::size_t count = 1;
        const auto add = [&](Result<Obb> box) {
            if (box && grow(*box)) candidates[count++] = *box;
        };
        add(fit::fit_obb(points_, {.criterion = options_.criterion, .quality = fit::Quality::fast}));
        add(fit::fit_oriented(points_, boxes_[items[0]].axes));
        if (options_.split == Split::sampled)
            add(fit::fit_obb(points_, {.criterion = measure::minimal_area(), .quality = fit::Quality::fast}));
        std::size_t best = 0;
        const bool counted = alive.size() >= options_.min_queries;
        const auto straddling = [&](const Obb& box) {
            return std::count_if(alive.begin(), alive.end(),
                                 [&](std::uint32_t q) { return options_.queries->straddles(q, box); });
        };
        auto least_hits = counted ? straddling(candidates[0]) : 0;
        double least = value(options_.criterion, candidates[0]);
        for (std::size_t i = 1; i < count; ++i) {
            const double v = value(options_.criterion, candidates[i]);
            const auto hits = counted ? straddling(candidates[i]) : 0;
            if (hits < least_hits || (hits == least_hits && v < least)) best = i, least = v, least_hits = hits;
        }
        return candidates[best];
    }

    // Each coordinate of a corner is rounded by less than 3 · 2^-52 of the largest: an item's exact box may exceed its
    // corners by that.
    bool grow(Obb& box) const {
        double largest = 0.0;
        for (const glm::dvec3& p : points_) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        for (int k = 0; k < 3; ++k)
            box.half_extents[k] = std::nextafter(static_cast<float>(double{box.half_extents[k]} + 0x1p-49 * largest),
                                                 std::numeric_limits<float>::infinity());
        return validate(box).has_value();
    }

    double centroid(ItemId i, int axis) const { return item_boxes_[i].min[axis] + item_boxes_[i].max[axis]; }

    // Reorders the items and returns how many go left; at least one on each side.
    std::uint32_t split(std::span<ItemId> items, std::span<const std::uint32_t> alive) {
        Aabb centers;
        for (const ItemId i : items) centers.include(item_boxes_[i].min + item_boxes_[i].max);
        const glm::dvec3 extent = centers.max - centers.min;
        int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
        auto left = static_cast<std::uint32_t>(items.size() / 2);
        if (options_.split != Split::median && items.size() > 2) {
            double best = std::numeric_limits<double>::infinity();
            for (int j = 0; j < 3; ++j) best_cut(items, alive, j, centers, best, axis, left);
        }
        crofton::detail::select(items.begin(), items.begin() + left, items.end(), [&](ItemId a, ItemId b) {
            const double x = centroid(a, axis), y = centroid(b, axis);
            return x != y ? x < y : a < b;
        });
        return left;
    }

    void best_cut(std::span<const ItemId> items, std::span<const std::uint32_t> alive, int axis, const Aabb& centers,
                  double& best, int& best_axis, std::uint32_t& best_left) const {
        const double low = centers.min[axis], extent = centers.max[axis] - low;
        if (!(extent > 0.0)) return;
        std::array<Aabb, kBins> boxes;
        std::array<std::uint32_t, kBins> counts{};
        for (const ItemId i : items) {
            const auto bin = std::min(kBins - 1, static_cast<unsigned>((centroid(i, axis) - low) / extent * kBins));
            boxes[bin].include(item_boxes_[i]);
            ++counts[bin];
        }
        std::array<double, kBins> right{};
        Aabb box;
        std::uint32_t count = 0;
        for (unsigned b = kBins - 1; b > 0; --b) {
            box.include(boxes[b]);
            count += counts[b];
            right[b] = count ? chance(box, alive) * count : 0.0;
        }
        box = {};
        count = 0;
        for (unsigned b = 0; b + 1 < kBins; ++b) {
            box.include(boxes[b]);
            count += counts[b];
            if (counts[b] == 0 || count == items.size()) continue;
            const double cost = chance(box, alive) * count + right[b + 1];
            if (cost < best) best = cost, best_axis = axis, best_left = count;
        }
    }

    double chance(const Aabb& box, std::span<const std::uint32_t> alive) const {
        if (options_.split != Split::sampled || alive.size() < options_.min_queries)
            return value(options_.split_criterion, box);
        const Obb bound = obb_of(box);
        std::size_t hits = 0;
        for (const std::uint32_t q : alive) hits += options_.queries->straddles(q, bound);
        return static_cast<double>(hits);
    }

    std::span<const Obb> boxes_;
    const BinaryTreeOptions& options_;
    BinaryTree& tree_;
    Vector<Aabb> item_boxes_;
    Vector<ItemId> order_;
    Vector<glm::dvec3> points_;
};

Result<BinaryTree> BinaryTree::build(std::span<const Obb> boxes, const BinaryTreeOptions& options) {
    if (boxes.size() > kMaxItems) return fail(ErrorCode::out_of_range, kMaxItems, "visit tree: more than 2^30 boxes");
    if (auto valid = measure::validate(options.criterion); !valid) return valid.error();
    if (auto valid = measure::validate(options.split_criterion); !valid) return valid.error();
    if (options.split == Split::sampled && options.queries == nullptr)
        return fail(ErrorCode::invalid_argument, kNoItem, "visit tree: to split by sampled queries it needs some");
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (auto valid = crofton::validate(boxes[i], i); !valid) return valid.error();
    BinaryTree tree;
    BinaryTreeBuilder(boxes, options, tree).run();
    return tree;
}

}  // namespace crofton::study
