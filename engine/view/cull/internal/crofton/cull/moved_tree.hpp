// SPDX-License-Identifier: MIT
// One view against many trees whose boxes are stored relative to an origin.
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

    // The view must outlive all queries.
    void start(const View& view);

    static constexpr std::uint32_t kAllPlanes = ~std::uint32_t{0};
    // Returns the planes that the box may cross or lie outside of, bit i for plane i. 0: the view contains the box.
    // Returns kAllPlanes for a view that filters cannot handle.
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
