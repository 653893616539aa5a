// What an engine's adapter keeps: one box per engine object, inserted, moved and removed as objects come and go.
#pragma once
#include <crofton/cull/cull.hpp>
#include <optional>
#include <vector>

namespace crofton::adapter {

// Ids are small and reused. Changes are gathered and given to the tree by the next query.
class CullIndex {
  public:
    CullIndex();

    // Requires a box that passes validate(Obb).
    [[nodiscard]] cull::ItemId insert(const Obb& box, std::uint32_t layer_mask = ~0u);
    void move(cull::ItemId item, const Obb& box);
    void remove(cull::ItemId item);

    // Brings the tree up to date with the changes so far; cull() does so as well.
    void update();

    // The items that the view sees, ascending: the order in which most engines allocated the objects behind them. Valid
    // until the next call.
    [[nodiscard]] const cull::VisibleSet& cull(const cull::View& view);

    [[nodiscard]] const std::vector<Obb>& boxes() const { return boxes_; }

  private:
    std::vector<Obb> boxes_;
    std::vector<std::uint32_t> layer_masks_;
    std::vector<cull::ItemId> free_;
    std::optional<tree::BoxTree> tree_;
    cull::VisibleSet visible_;
};

}  // namespace crofton::adapter
