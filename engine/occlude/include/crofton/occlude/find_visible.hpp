// SPDX-License-Identifier: MIT
// Which items does a view see, occluders considered? Of a tree, of a list, of what moves.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/moving_boxes.hpp>
#include <crofton/occlude/occlusion_buffer.hpp>
#include <cstdint>
#include <span>

namespace crofton::occlude {

// cull's verdicts, and `occluded`: neither outside nor seen.
enum class Verdict : std::uint8_t { outside, straddling, inside, occluded };

struct VisibleStatistics {
    std::uint64_t nodes_tested = 0;   // bounds of nodes and leaves
    std::uint64_t nodes_outside = 0;  // beside the picture
    std::uint64_t nodes_hidden = 0;   // behind occluders: nothing below them was looked at
    std::uint64_t items_tested = 0;
    std::uint64_t items_hidden = 0;  // behind occluders, in leaves that were not; some may be outside as well
};

// Kept from frame to frame: once it has grown to the largest answer, queries allocate nothing.
class VisibleSet {
  public:
    // Ascending; each is inside or straddling.
    [[nodiscard]] std::span<const boxtree::ItemId> ids() const { return std::span(ids_).first(size_); }
    [[nodiscard]] std::span<const cull::Verdict> verdicts() const { return visible_.verdicts(); }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t inside_count() const { return visible_.inside_count(); }
    [[nodiscard]] const VisibleStatistics& statistics() const { return statistics_; }

  private:
    friend class VisibleQuery;
    Vector<boxtree::ItemId> ids_, candidates_, stack_;
    Vector<std::uint32_t> places_;
    Vector<Obb> boxes_;
    Vector<std::uint64_t> bits_;
    cull::VisibleSet visible_;
    VisibleStatistics statistics_;
    std::size_t size_ = 0;
};

struct VisibleOptions {
    std::uint32_t layer_mask = ~std::uint32_t{0};
    cull::CullMode mode = cull::CullMode::exact;
    const cull::DrawLimits* limits = nullptr;  // what is too small or too far is left out
};

// The items that cull::find_visible() finds in the buffer's view, less those that the buffer hides: an item is
// hidden if its box is, or the bound of a node above it. Requires a buffer that has been drawn.
void find_visible(const boxtree::BoxTree& tree, const OcclusionBuffer& buffer, VisibleSet& visible,
                  const VisibleOptions& options = {});
// What rests and what moves in one answer. Requires the tree that `moving` was updated with.
void find_visible(const boxtree::BoxTree& resting, const cull::MovingBoxes& moving, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options = {});
// Item i is boxes[i] with layer mask layer_masks[i], or all layers if that span is empty.
void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const OcclusionBuffer& buffer,
                  VisibleSet& visible, const VisibleOptions& options = {});

// Bit i % 64 of word i / 64 is bound i's.
struct OcclusionBits {
    cull::VerdictBits frustum;  // as if there were no occluders
    Vector<std::uint64_t> occluded;

    [[nodiscard]] Verdict verdict(std::size_t i) const {
        if (occluded[i / 64] >> (i % 64) & 1) return Verdict::occluded;
        return static_cast<Verdict>(frustum.verdict(i));
    }
};

// Every bound of a list; `bounds` are those that the set was given.
void find_visible(const cull::BoxSet& set, std::span<const Obb> bounds, const OcclusionBuffer& buffer,
                  OcclusionBits& bits, cull::CullMode mode = cull::CullMode::exact,
                  Executor& executor = serial_executor());

}  // namespace crofton::occlude
