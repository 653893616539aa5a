// SPDX-License-Identifier: MIT
// What an engine's adapter keeps: one box per engine object, inserted, moved and removed as objects come and go.
#pragma once
#include <crofton/cull/cull.hpp>
#include <optional>
#include <vector>

namespace crofton::adapter {

// The first query builds a tree over all that has been inserted so far; changes after that go into the tree.
class CullIndex {
  public:
    // Requires a box that passes validate(Obb). Ids are small and reused.
    [[nodiscard]] cull::ItemId insert(const Obb& box);
    void move(cull::ItemId item, const Obb& box);
    void remove(cull::ItemId item);

    // Brings the tree up to date with the changes so far; needed before cull() where there were any.
    void update();

    // The items that the view sees, ascending: the order in which most engines allocated the objects behind them.
    // Valid until the next call.
    [[nodiscard]] const cull::VisibleSet& cull(const cull::View& view);

  private:
    void build();

    std::vector<Obb> boxes_;     // while there is no tree
    std::vector<bool> removed_;  // the same
    std::optional<boxtree::BoxTree> tree_;
    bool changed_ = false;
    cull::VisibleSet visible_;
};

}  // namespace crofton::adapter
