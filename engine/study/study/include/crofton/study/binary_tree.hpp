// SPDX-License-Identifier: MIT
// A binary hierarchy of boxes built by the chance of a visit. It is for studying what a criterion is worth, and for
// items that come and go. BoxTree is the one to cull with where speed counts. This is the one to compare by, and its
// inner bounds may be oriented box by box (docs/notes/boxtree.md).
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
    median,  // halves along the longest axis: no measure at all
    nested,  // least Σ criterion(side) · items(side): the chance of a visit where bounds are nested
    sampled  // least Σ queries(side) · items(side), over the sampled queries that straddle *all* ancestors' bounds
};

struct BinaryTreeOptions {
    Split split = Split::nested;
    // What Split::nested weighs sides by. The area wins there even for frusta. items(side) overrates what is below a
    // side, and more so for M, which shrinks more slowly on the way down (docs/notes/boxtree.md).
    measure::Criterion split_criterion = measure::minimal_area();
    // What chooses places for insertion, and among bounds. Here the cost is the expected number of visits itself. With
    // (2) for the frustum in use it is exact for nested boxes.
    measure::Criterion criterion = measure::minimal_perimeter();
    // false: axis-aligned bounds, nested by nature. true: oriented ones, which need not lie within their parent's. Each
    // is the best of a few fits, by the criterion (nested, median) or by the queries that straddle all ancestors
    // (sampled).
    bool oriented = false;
    // For Split::sampled; where fewer than min_queries are left, the criterion decides. Lives as long as build().
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

    // Errors: a box that fails validate(Obb), by its index; more than 2^30; a criterion that fails validate;
    // Split::sampled without queries. Items are numbered as in `boxes`. Deterministic.
    [[nodiscard]] static Result<BinaryTree> build(std::span<const Obb> boxes, const BinaryTreeOptions& options = {});

    // Places the box where the expected number of visits grows least, by branch and bound over the whole tree. Δ =
    // criterion of the new inner node + what it adds to its ancestors. Goldsmith and Salmon (1987) descend greedily and
    // by area. Bounds that it changes become axis-aligned. Ids of removed items are used again. Errors: as
    // validate(Obb).
    [[nodiscard]] Result<ItemId> insert(const Obb& box);
    // False where there is no such item. The boxes above shrink again; bounds that change become axis-aligned.
    bool remove(ItemId item);

    [[nodiscard]] std::size_t item_count() const { return item_count_; }
    [[nodiscard]] std::size_t id_count() const { return leaf_of_.size(); }  // ids are below, removed ones included
    [[nodiscard]] std::uint32_t leaf(ItemId item) const { return leaf_of_[item]; }  // its node; kNone once removed
    [[nodiscard]] bool holds(ItemId item) const { return item < leaf_of_.size() && leaf_of_[item] != kNone; }
    [[nodiscard]] const Node* root() const { return root_ == kNone ? nullptr : &nodes_[root_]; }
    [[nodiscard]] const Node& node(std::uint32_t n) const { return nodes_[n]; }
    // Σ criterion over the inner nodes: half the expected number of tests below the root, up to a factor and a
    // constant.
    [[nodiscard]] double cost() const;

    // test(bound) → Visit for the root and for both children of every node that said descend. A leaf that says descend
    // or take is found. All leaves below a node that says take are found without further tests. Returns how many tests.
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

// Replaces `ids` by the items whose boxes the view sees, ascending; returns how many bounds were tested. Same answers
// as cull's queries of a BoxTree.
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
