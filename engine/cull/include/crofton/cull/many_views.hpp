// SPDX-License-Identifier: MIT
// Shadow cascades, cube faces, two eyes: up to 32 views in one walk through the tree.
#pragma once
#include <crofton/core/memory.hpp>
#include <crofton/cull/cull.hpp>
#include <cstdint>
#include <cstring>
#include <span>

namespace crofton::cull {

class ManyVisible {
  public:
    // The items that at least one view sees, each once: first those in leaves that each view sees whole or not at all,
    // then the others, both in the order of the tree's slots.
    [[nodiscard]] std::span<const ItemId> ids() const { return std::span(ids_).first(size_); }
    // Bit v: view v sees ids()[i].
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const {
        std::uint32_t mask = 0;
        std::memcpy(&mask, masks_.data() + i * mask_bytes_, mask_bytes_);
        return mask;
    }
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    friend class ManyViewsQuery;
    Vector<ItemId> ids_;
    Vector<std::uint8_t> masks_;  // as many bytes a mask as the views need bits
    std::size_t mask_bytes_ = 4;
    Vector<std::uint32_t> whole_, open_, listed_;  // by leaf
    Vector<std::uint16_t> planes_;                 // by view, by leaf
    Vector<std::uint64_t> touched_, stack_;
    Vector<std::uint32_t> moving_masks_;
    std::size_t size_ = 0;
};

// For each view the items that find_visible() finds for it alone. Requires at most 32 views. Allocates nothing once
// `visible` has been used for as many views of a tree of this size.
void find_visible(const boxtree::BoxTree& tree, std::span<const View> views, ManyVisible& visible,
                  CullMode mode = CullMode::exact);

}  // namespace crofton::cull
