// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/study/binary_tree.hpp>
#include <limits>

#include "binary_tree_value.hpp"

namespace crofton::study {
namespace {

Aabb merged(Aabb a, const Aabb& b) {
    a.include(b);
    return a;
}

}  // namespace

std::uint32_t BinaryTree::new_node() {
    if (free_nodes_.empty()) {
        nodes_.emplace_back();
        return static_cast<std::uint32_t>(nodes_.size() - 1);
    }
    const std::uint32_t n = free_nodes_.back();
    free_nodes_.pop_back();
    nodes_[n] = Node{};
    return n;
}

std::uint32_t BinaryTree::best_sibling(const Aabb& box) const {
    // Best first: `inherited` is what the box adds to the inner nodes above; below a node it costs at least that plus
    // the criterion of the box itself as the new inner node.
    struct Candidate {
        double bound, inherited;
        std::uint32_t node;
    };
    const auto later = [](const Candidate& a, const Candidate& b) {
        return a.bound != b.bound ? a.bound > b.bound : a.node > b.node;
    };
    const double least_own = value(criterion_, box);
    Vector<Candidate> heap;
    heap.push_back({least_own, 0.0, root_});
    std::uint32_t best = root_;
    double best_cost = std::numeric_limits<double>::infinity();
    while (!heap.empty()) {
        std::pop_heap(heap.begin(), heap.end(), later);
        const Candidate c = heap.back();
        heap.pop_back();
        if (c.bound >= best_cost) break;
        const Node& node = nodes_[c.node];
        const double together = value(criterion_, merged(node.box, box)), cost = c.inherited + together;
        if (cost < best_cost) best_cost = cost, best = c.node;
        if (node.item != kNone) continue;
        const double inherited = c.inherited + together - value(criterion_, node.box);
        if (inherited + least_own >= best_cost) continue;
        for (const std::uint32_t child : node.child) {
            heap.push_back({inherited + least_own, inherited, child});
            std::push_heap(heap.begin(), heap.end(), later);
        }
    }
    return best;
}

Result<ItemId> BinaryTree::insert(const Obb& box) {
    if (auto valid = crofton::validate(box); !valid) return valid.error();
    ItemId item;
    if (free_items_.empty()) {
        item = static_cast<ItemId>(leaf_of_.size());
        leaf_of_.push_back(kNone);
    } else {
        item = free_items_.back();
        free_items_.pop_back();
    }
    const Aabb aligned = aabb_of(box);
    const std::uint32_t sibling = root_ == kNone ? kNone : best_sibling(aligned);
    const std::uint32_t leaf = new_node();
    nodes_[leaf].item = item;
    nodes_[leaf].box = aligned;
    nodes_[leaf].bound = box;
    leaf_of_[item] = leaf;
    ++item_count_;
    if (sibling == kNone) {
        root_ = leaf;
        return item;
    }
    const std::uint32_t parent = new_node(), above = nodes_[sibling].parent;
    nodes_[parent].parent = above;
    nodes_[parent].child[0] = sibling;
    nodes_[parent].child[1] = leaf;
    nodes_[sibling].parent = nodes_[leaf].parent = parent;
    if (above == kNone)
        root_ = parent;
    else
        nodes_[above].child[nodes_[above].child[1] == sibling] = parent;
    refit_upward(parent, oriented_);
    return item;
}

bool BinaryTree::remove(ItemId item) {
    if (!holds(item)) return false;
    const std::uint32_t leaf = leaf_of_[item], parent = nodes_[leaf].parent;
    leaf_of_[item] = kNone;
    free_items_.push_back(item);
    free_nodes_.push_back(leaf);
    --item_count_;
    if (parent == kNone) {
        root_ = kNone;
        return true;
    }
    const std::uint32_t sibling = nodes_[parent].child[nodes_[parent].child[0] == leaf], above = nodes_[parent].parent;
    nodes_[sibling].parent = above;
    free_nodes_.push_back(parent);
    if (above == kNone)
        root_ = sibling;
    else
        nodes_[above].child[nodes_[above].child[1] == parent] = sibling;
    refit_upward(above, false);
    return true;
}

void BinaryTree::refit_upward(std::uint32_t n, bool replace) {
    for (; n != kNone; n = nodes_[n].parent) {
        Node& node = nodes_[n];
        const Aabb box = merged(nodes_[node.child[0]].box, nodes_[node.child[1]].box);
        if (!replace && box.min == node.box.min && box.max == node.box.max) return;
        node.box = box;
        node.bound = obb_of(box);
    }
}

double BinaryTree::cost() const {
    double sum = 0.0;
    if (root_ == kNone) return sum;
    visit([](const Obb&) { return Visit::descend; },
          [&](ItemId item) {
              // Each inner node is counted once: by the leaf that is first below it.
              std::uint32_t n = leaf_of_[item];
              for (std::uint32_t p = nodes_[n].parent; p != kNone && nodes_[p].child[0] == n;
                   n = p, p = nodes_[p].parent)
                  sum += value(criterion_, nodes_[p].box);
          });
    return sum;
}

}  // namespace crofton::study
