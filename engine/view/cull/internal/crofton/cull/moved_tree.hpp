// SPDX-License-Identifier: MIT
// One view against many trees whose boxes are stored relative to an origin.
#pragma once
#include <crofton/boxtree/tree_arrays.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/answer_list.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/move.hpp>
#include <span>

namespace crofton::cull {

// A tree, and where its boxes are.
struct MovedTree {
    boxtree::TreeArrays arrays;
    std::uint32_t first_id = 0;               // added to ids in answers
    float root_l1_radius = 0.0f;              // of the root node, with
    double root_origin[3] = {0.0, 0.0, 0.0};  // its origin
    Move move;
};
[[nodiscard]] MovedTree moved_tree_of(const boxtree::BoxTree& tree, const Move& move, std::uint32_t first_id);

class MovedTreesQuery {
  public:
    MovedTreesQuery();
    ~MovedTreesQuery();

    // The view must outlive all queries.
    void start(const View& view);

    // Returns the planes that an aligned box may cross or lie outside of, bit i for plane i. 0: the view contains the
    // box. All bits, if filters cannot handle the view.
    [[nodiscard]] std::uint32_t planes_that_may_cut(const Obb& box) const;

    // A tree, and the planes that its boxes are to be tested against: they are inside of all others.
    struct Asked {
        const MovedTree* tree = nullptr;
        std::uint32_t planes = 0;
    };
    static constexpr std::size_t kMost = 64;  // trees at once

    // Appends what is inside, and what straddles; exact for the moved boxes. In the trees' order, not sorted. Returns
    // how many are inside.
    std::size_t find_visible(std::span<const Asked> trees, CullMode mode, AnswerList<std::uint32_t>& inside,
                             AnswerList<std::uint32_t>& straddling);
    // The same, for list(). The trees must live until then.
    void find_visible(std::span<const Asked> trees, CullMode mode);
    // Appends what the last find_visible() without lists has found of a tree, in order of ids. `shown` has a bit for
    // each item that may be listed; empty: all may. Returns how many are inside.
    std::size_t list(std::size_t tree, std::span<const std::uint64_t> shown, AnswerList<std::uint32_t>& ids,
                     AnswerList<Verdict>& verdicts);
    // Appends all ids of a tree.
    static void list_all(const MovedTree& tree, AnswerList<std::uint32_t>& ids);

    [[nodiscard]] const Statistics& statistics() const;  // since start()

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::cull
