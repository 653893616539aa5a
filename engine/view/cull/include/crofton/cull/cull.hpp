// SPDX-License-Identifier: MIT
// Queries of trees and lists: the items in one view or in many, as lists, bits and ranges; shadow volumes.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/geometry/camera.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <span>

namespace crofton::cull {

// Holds the answer to a query, in buffers that are kept from frame to frame.

class VisibleSet {
  public:
    // Returns the visible items, each once. In ResultOrder::ascending they are ordered by id. In ResultOrder::tree the
    // order depends only on tree and view: first the items that are inside, then the straddling ones, each part roughly
    // in the tree's order.
    [[nodiscard]] std::span<const boxtree::ItemId> ids() const { return {ids_.data(), size()}; }
    [[nodiscard]] std::size_t size() const { return ids_.size() == 0 ? 0 : size_; }  // empty: moved from
    [[nodiscard]] std::size_t inside_count() const { return ids_.size() == 0 ? 0 : inside_; }
    // Returns the verdicts of ids() in ResultOrder::ascending. In ResultOrder::tree it is empty: the first
    // inside_count() ids are inside, the others straddle.
    [[nodiscard]] std::span<const Verdict> verdicts() const;
    [[nodiscard]] const Statistics& statistics() const { return statistics_; }

  private:
    friend class Query;
    Vector<boxtree::ItemId> ids_;  // as long as its largest use so far
    Vector<boxtree::ItemId> straddling_;
    Vector<boxtree::ItemId> part_inside_, part_straddling_;
    Vector<std::uint32_t> undecided_;
    Vector<Verdict> verdicts_;
    Vector<std::uint64_t> bits_;
    Vector<std::uint64_t> runs_;
    Vector<std::uint32_t> work_;
    VerdictBits moving_bits_;
    Vector<std::uint32_t> listed_;
    // CullOptions::candidate_mask of the last queries, and, once that pays, its bits in the order of the tree's slots.
    struct CandidateSlots {
        Vector<std::uint64_t> set;
        std::uint64_t structure = 0, changes = 0;  // the tree's
        std::uint64_t looked_up = 0;               // items, one by one, since set and tree are these
        bool made = false;
        Vector<std::uint16_t> leaves, nodes;  // slots that the set has; children with such slots below
    };
    CandidateSlots candidate_slots_;
    std::size_t size_ = 0, inside_ = 0;
    Statistics statistics_;
};

// Queries for one view, of a list of boxes or of a tree.

using boxtree::ItemId;

// A view. It sees the items whose layer mask shares a bit with its own.
struct View {
    Frustum frustum;
    std::uint32_t layer_mask = ~std::uint32_t{0};
};

inline constexpr std::size_t kMaxViews = 32;  // in one pass

// Checks the number of views of one pass. Error: more than kMaxViews (out_of_range; item: the first view too many).
[[nodiscard]] Result<void> check_view_count(std::size_t views);

// The order of ids. Tree order is free and is the same on every run. A renderer that stores its items in the tree's
// order (BoxTree::slot_items) gets long ascending runs.
enum class ResultOrder : std::uint8_t { ascending, tree };

struct CullOptions {
    CullMode mode = CullMode::exact;
    ResultOrder order = ResultOrder::ascending;
    // Leaves out items that are too small or too far. A query without limits pays nothing for this option; a query of a
    // tree with limits uses one thread.
    const DrawLimits* limits = nullptr;
    // The items to consider: bit i % 64 of word i / 64 is item i. Items beyond the span are considered, and so are all
    // items if it is empty. pvs::Pvs::visible_from() returns such sets. In a query of static and moving items it
    // applies only to the static ones, unless `mask_moving` is true.
    std::span<const std::uint64_t> candidate_mask = {};
    bool mask_moving = false;
};

// Tests whether a set such as CullOptions::candidate_mask contains the item.
[[nodiscard]] constexpr bool is_candidate(std::span<const std::uint64_t> set, boxtree::ItemId item) {
    return item / 64 >= set.size() || (set[item / 64] >> (item % 64) & 1) != 0;
}

// Finds the items that `view` sees and whose box is not outside.
//
// Overwrites `visible`; once that has grown to the largest answer, nothing is allocated. The answer has the same bits
// from tree and list, with any executor and on any instruction set.
void find_visible(const boxtree::BoxTree& tree, const View& view, VisibleSet& visible, const CullOptions& options = {},
                  Executor& executor = serial_executor());

// Does the same for a list: item i is boxes[i] with layer mask layer_masks[i], or in all layers if that span is empty.
// Boxes that are not finite are reported as straddling, so they are never lost. From 16,384 boxes on, the executor's
// threads share the list.
void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view,
                  VisibleSet& visible, const CullOptions& options = {}, Executor& executor = serial_executor());

// Makes a list for each view, as for shadow cascades and cube faces: visible[v] is that of find_visible() for views[v]
// alone. Any number of views.
//
// If there are at least as many views as threads, the threads share the views; otherwise they share each view. If you
// need lists, this is faster than masks (MaskedVisibleSet). Requires visible.size() == views.size().
void find_visible(const boxtree::BoxTree& tree, std::span<const View> views, std::span<VisibleSet> visible,
                  const CullOptions& options = {}, Executor& executor = serial_executor());

// Up to 32 views in one pass through the tree, with a mask of views per item, for two eyes or cascades that are drawn
// together.

class MaskedVisibleSet {
  public:
    // Returns the items that at least one view sees, each once, in the order of the tree's slots. Items in leaves that
    // every view sees entirely or not at all come first.
    [[nodiscard]] std::span<const ItemId> ids() const { return {ids_.data(), size()}; }
    // Returns the mask of ids()[i]: bit v is set if view v sees it.
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const {
        std::uint32_t mask = 0;
        std::memcpy(&mask, masks_.data() + i * mask_bytes_, mask_bytes_);
        return mask;
    }
    [[nodiscard]] std::size_t size() const { return ids_.size() == 0 ? 0 : size_; }  // empty: moved from

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

// Finds, for each view, the items that find_visible() finds for it alone, within `limits` if given: one eye for all
// views.
//
// Allocates nothing once `visible` has been used for as many views of a tree of this size. Error: more than kMaxViews
// views.
Result<void> find_visible(const boxtree::BoxTree& tree, std::span<const View> views, MaskedVisibleSet& visible,
                          CullMode mode = CullMode::exact, const DrawLimits* limits = nullptr);

// ---- Bit sets and draw ranges ----

// The items [first, first + count).
struct ItemRange {
    boxtree::ItemId first = 0;
    std::uint32_t count = 0;
};

// Sets bit id % 64 of word id / 64 for each id. `bits` gets the length that `items` needs. Requires ids below `items`,
// each once.
void to_bits(std::span<const boxtree::ItemId> ids, std::size_t items, Vector<std::uint64_t>& bits);

// Lists the runs of set bits, ascending. Runs that are at most `max_gap` items apart are merged, because drawing a few
// more items is cheaper than another draw call. Runs are long if ids follow the tree's order: number the instances by
// BoxTree::slot_items().
void merge_ranges(std::span<const std::uint64_t> bits, std::uint32_t max_gap, Vector<ItemRange>& ranges);

// ---- Shadow volumes ----

// Returns the volume of all points that can cast a shadow of a distant light into `view`: { x + s · toward_light : x in
// view, s ≥ 0 }.
//
// Its planes, at most 12 for a camera's 6, come from eliminating s (Fourier, Motzkin): planes that face along the light
// stay, and each pair of one that does and one that does not gives one plane parallel to the light. Exact up to the
// rounding of the new planes. Errors: a direction that is zero or not finite; a view of more than 6 planes; a volume
// that is all of space.
[[nodiscard]] Result<Frustum> shadow_volume(const Frustum& view, const glm::dvec3& toward_light);

// Does the same for a light at a point: returns the convex hull of the view and the light.
[[nodiscard]] Result<Frustum> shadow_volume_of_point(const Frustum& view, const glm::dvec3& light_position);

}  // namespace crofton::cull
