// Shadow cascades, cube faces, two eyes: up to 32 views in one walk through the tree.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdint>
#include <span>

namespace crofton::cull {

class ManyVisible {
  public:
    // The items that at least one view sees, each once, in the tree's order; bit v of view_masks()[i]: view v sees
    // ids()[i].
    [[nodiscard]] std::span<const ItemId> ids() const { return std::span(ids_).first(size_); }
    [[nodiscard]] std::span<const std::uint32_t> view_masks() const { return std::span(masks_).first(size_); }
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    friend class ManyViewsQuery;
    Vector<ItemId> ids_;
    Vector<std::uint32_t> masks_;
    Vector<std::uint64_t> stack_;
    std::size_t size_ = 0;
};

// For each view the items that cull() finds for it alone. Requires at most 32 views. Allocates nothing once `visible`
// has been used for a tree of this size.
void cull(const tree::BoxTree& tree, std::span<const View> views, ManyVisible& visible, Mode mode = Mode::exact);

}  // namespace crofton::cull
