// SPDX-License-Identifier: MIT
// A binary hierarchy of boxes, built by the probability of a visit. Use it to compare criteria, and for items that come
// and go; its inner bounds may be oriented box by box (docs/notes/boxtree.md). BoxTree is faster for culling.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/study/query_sample.hpp>
#include <cstdint>
#include <span>

namespace crofton::study {

using boxtree::ItemId;
inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

enum class Split : std::uint8_t {
    median,  // halves along the longest axis, without any measure
    nested,  // least Σ criterion(side) · items(side): the probability of a visit if bounds are nested
    sampled  // least Σ queries(side) · items(side), over the sampled queries that straddle *all* ancestors' bounds
};

struct BinaryTreeOptions {
    Split split = Split::nested;
    // The weight of sides for Split::nested. The area is best even for frusta, because items(side) overestimates the
    // cost below a side, and more so for M, which shrinks more slowly on the way down (docs/notes/boxtree.md).
    measure::Criterion split_criterion = measure::minimal_area();
    // The criterion that chooses places for insertion, and among bounds. Here the cost is the expected number of visits
    // itself. With (2) for the frustum in use it is exact for nested boxes.
    measure::Criterion criterion = measure::minimal_perimeter();
    // false: axis-aligned bounds, which are always nested. true: oriented bounds, which need not lie within their
    // parent's. Each is the best of a few fits, by the criterion (nested, median) or by the queries that straddle all
    // ancestors (sampled).
    bool oriented = false;
    // For Split::sampled. If fewer than min_queries are left, the criterion decides. It must live as long as build()
    // runs.
    const QuerySample* queries = nullptr;
    std::uint32_t min_queries = 64;
};

enum class Visit : std::uint8_t { skip, descend, take };

class BinaryTree {
  public:
    struct Node {
        Obb bound;  // contains all boxes below; a leaf's is the item's own box
        Aabb box;   // axis-aligned, likewise; an inner node's bound is this one unless the tree is oriented
        std::uint32_t parent = kNone;
        std::uint32_t child[2] = {kNone, kNone};
        ItemId item = kNone;  // leaves only
    };

    // Builds a tree; deterministic. Items are numbered as in `boxes`. Errors: a box that fails validate(Obb), by its
    // index; more than 2^30; a criterion that fails validate; Split::sampled without queries.
    [[nodiscard]] static Result<BinaryTree> build(std::span<const Obb> boxes, const BinaryTreeOptions& options = {});

    // Inserts a box where the expected number of visits grows least, by branch and bound over the whole tree.
    //
    // Δ = criterion of the new inner node + its addition to its ancestors. (Goldsmith and Salmon (1987) descend
    // greedily and by area.) Bounds that it changes become axis-aligned. Ids of removed items are reused. Errors: as
    // validate(Obb).
    [[nodiscard]] Result<ItemId> insert(const Obb& box);
    // Removes an item; returns false if it does not exist. The boxes above shrink again; bounds that change become
    // axis-aligned.
    bool remove(ItemId item);

    [[nodiscard]] std::size_t item_count() const { return item_count_; }
    [[nodiscard]] std::uint32_t leaf(ItemId item) const { return leaf_of_[item]; }  // its node; kNone once removed
    [[nodiscard]] bool holds(ItemId item) const { return item < leaf_of_.size() && leaf_of_[item] != kNone; }
    [[nodiscard]] const Node* root() const { return root_ == kNone ? nullptr : &nodes_[root_]; }
    [[nodiscard]] const Node& node(std::uint32_t n) const { return nodes_[n]; }
    // Returns Σ criterion over the inner nodes: half the expected number of tests below the root, up to a factor and a
    // constant.
    [[nodiscard]] double cost() const;

    // Visits the tree. It calls test(bound) → Visit for the root and for both children of every node that returned
    // descend. A leaf that returned descend or take is found. All leaves below a node that returned take are found
    // without further tests. Returns the number of tests.
    template <class Test, class Found>
    std::size_t visit(Test test, Found found) const;

  private:
    friend class BinaryTreeBuilder;
    [[nodiscard]] std::uint32_t new_node();
    [[nodiscard]] std::uint32_t best_sibling(const Aabb& box) const;
    // From n to the root; stops where a box stays the same unless oriented bounds must be replaced, which know nothing
    // of it.
    void refit_upward(std::uint32_t n, bool replace);

    measure::Criterion criterion_;
    bool oriented_ = false;
    Vector<Node> nodes_;
    Vector<std::uint32_t> leaf_of_;  // by item
    Vector<std::uint32_t> free_nodes_;
    Vector<ItemId> free_items_;
    std::uint32_t root_ = kNone;
    std::size_t item_count_ = 0;
};

// Replaces `ids` by the items whose boxes the view sees, ascending; returns the number of tested bounds. The answers
// are those of cull's queries of a BoxTree.
std::size_t find_visible(const BinaryTree& tree, const cull::View& view, Vector<ItemId>& ids);

template <class Test, class Found>
std::size_t BinaryTree::visit(Test test, Found found) const {
    // By parent links: no stack, whatever the depth.
    std::size_t tests = 0;
    std::uint32_t taken = kNone;  // the node below which all is taken
    for (std::uint32_t n = root_; n != kNone;) {
        Visit verdict = Visit::take;
        if (taken == kNone) {
            verdict = test(nodes_[n].bound);
            ++tests;
            if (verdict == Visit::take) taken = n;
        }
        if (verdict != Visit::skip) {
            if (nodes_[n].item == kNone) {
                n = nodes_[n].child[0];
                continue;
            }
            found(nodes_[n].item);
        }
        for (;;) {  // to the next sibling up the path
            if (n == taken) taken = kNone;
            const std::uint32_t parent = nodes_[n].parent;
            if (parent == kNone) return tests;
            if (nodes_[parent].child[0] == n) {
                n = nodes_[parent].child[1];
                break;
            }
            n = parent;
        }
    }
    return tests;
}

}  // namespace crofton::study
