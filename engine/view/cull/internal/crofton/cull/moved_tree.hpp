// SPDX-License-Identifier: MIT
// Queries of trees whose boxes are stored relative to an origin: one view, many trees.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/geometry/move.hpp>
#include <span>

namespace crofton::cull {

class MovedTreesQuery {
  public:
    MovedTreesQuery();
    ~MovedTreesQuery();

    // Begins with a view, which must live until the last question.
    void start(const View& view);

    static constexpr std::uint32_t kAllPlanes = ~std::uint32_t{0};
    // Returns the planes that the box is not certainly inside of: bit i is plane i. 0: the view contains the box.
    // kAllPlanes, if the view is not one that filters can take.
    [[nodiscard]] std::uint32_t planes_that_may_cut(const Obb& box) const;

    // As find_visible() of a tree, with each box moved: exact for the moved boxes. Requires that all of them are inside
    // of the planes that `planes` leaves out, and options without limits.
    void find_visible(const boxtree::BoxTree& tree, const Move& move, std::uint32_t planes, VisibleSet& visible,
                      const CullOptions& options = {});

  private:
    struct State;
    Owner<State> state_;
};

}  // namespace crofton::cull
