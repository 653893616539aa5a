// SPDX-License-Identifier: MIT
// Queries of trees and lists: the items that one view or many views see, as lists, bits and runs; shadow casters.
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

// The answer to a query, in buffers that are kept from frame to frame.

class VisibleSet {
  public:
    // The items seen, each once. In ResultOrder::ascending they come by id. In ResultOrder::tree the order depends on
    // tree and view alone: those inside first, then those straddling, each part by and large along the tree.
    [[nodiscard]] std::span<const boxtree::ItemId> ids() const { return {ids_.data(), size()}; }
    [[nodiscard]] std::size_t size() const { return ids_.empty() ? 0 : size_; }  // empty: moved from
    [[nodiscard]] std::size_t inside_count() const { return ids_.empty() ? 0 : inside_; }
    // In ResultOrder::ascending the verdict of ids()[i] is verdicts()[i]. In ResultOrder::tree there are none: the
    // first inside_count() ids are inside, the others straddle.
    [[nodiscard]] std::span<const Verdict> verdicts() const {
        return {verdicts_.data(), verdicts_.empty() ? 0 : size()};
    }
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
    // CullOptions::candidate_mask of the last queries, and once that pays its bits in the order of the tree's slots.
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

// Which items does a view see? From a list of boxes or from a tree of them.

using boxtree::ItemId;

// Sees the items whose layer mask shares a bit with its own.
struct View {
    Frustum frustum;
    std::uint32_t layer_mask = ~std::uint32_t{0};
};

inline constexpr std::size_t kMaxViews = 32;  // in one pass

// Error: more than kMaxViews, which do not fit one pass (out_of_range; item: the first view too many).
[[nodiscard]] Result<void> check_view_count(std::size_t views);

// Tree order costs nothing and is the same on every run. A renderer that lays its items out in the tree's order
// (BoxTree::slot_items) gets long ascending runs.
enum class ResultOrder : std::uint8_t { ascending, tree };

struct CullOptions {
    CullMode mode = CullMode::exact;
    ResultOrder order = ResultOrder::ascending;
    // Leaves out what is too small or too far. A query without limits pays nothing for them; one of a tree with
    // limits uses no other thread.
    const DrawLimits* limits = nullptr;
    // Items that may be seen at all: bit i % 64 of word i / 64 is item i. Items beyond the span may be seen, and so may
    // all if it is empty. pvs::Pvs::visible_from() gives such sets. In a query of what rests and what moves it says
    // nothing about what moves.
    std::span<const std::uint64_t> candidate_mask = {};
};

// Whether a set as CullOptions::candidate_mask has the item.
[[nodiscard]] constexpr bool is_candidate(std::span<const std::uint64_t> set, boxtree::ItemId item) {
    return item / 64 >= set.size() || (set[item / 64] >> (item % 64) & 1) != 0;
}

// Finds the items that `view` sees and whose box is not outside. `visible` is overwritten; once it has grown to the
// largest answer, nothing is allocated. Same answer, bit for bit, from tree and list, with any executor and instruction
// set.
void find_visible(const boxtree::BoxTree& tree, const View& view, VisibleSet& visible, const CullOptions& options = {},
                  Executor& executor = serial_executor());

// Item i is boxes[i] with layer mask layer_masks[i], or all layers if that span is empty. Boxes that are not finite are
// straddling: reported, never lost. From 16,384 boxes on the executor's threads share the list.
void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view,
                  VisibleSet& visible, const CullOptions& options = {}, Executor& executor = serial_executor());

// Shadow cascades, cube faces: a list for each view, visible[v] as find_visible() for views[v] alone. Any number of
// views. They are shared among threads where there are as many views as threads; else the threads share each. Where
// lists are wanted this is faster than masks (MaskedVisibleSet). Requires visible.size() ==
// views.size().
void find_visible(const boxtree::BoxTree& tree, std::span<const View> views, std::span<VisibleSet> visible,
                  const CullOptions& options = {}, Executor& executor = serial_executor());

// Two eyes, cascades that draw together: up to 32 views in one walk through the tree, and a mask of views an item.

class MaskedVisibleSet {
  public:
    // The items that at least one view sees, each once, in the order of the tree's slots. Those in leaves that each
    // view sees whole or not at all come first.
    [[nodiscard]] std::span<const ItemId> ids() const { return {ids_.data(), size()}; }
    // Bit v: view v sees ids()[i].
    [[nodiscard]] std::uint32_t view_mask(std::size_t i) const {
        std::uint32_t mask = 0;
        std::memcpy(&mask, masks_.data() + i * mask_bytes_, mask_bytes_);
        return mask;
    }
    [[nodiscard]] std::size_t size() const { return ids_.empty() ? 0 : size_; }  // empty: moved from

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

// For each view the items that find_visible() finds for it alone, within `limits` if there are any: one eye for all
// views. Allocates nothing once `visible` has been used for as many views of a tree of this size. Error: more than
// kMaxViews views.
Result<void> find_visible(const boxtree::BoxTree& tree, std::span<const View> views, MaskedVisibleSet& visible,
                          CullMode mode = CullMode::exact, const DrawLimits* limits = nullptr);

// ---- Bit sets and draw ranges ----

// Items [first, first + count).
struct ItemRange {
    boxtree::ItemId first = 0;
    std::uint32_t count = 0;
};

// Bit id % 64 of word id / 64 for each id; `bits` is made as long as `items` needs. Requires ids below `items`,
// each once.
void to_bits(std::span<const boxtree::ItemId> ids, std::size_t items, Vector<std::uint64_t>& bits);

// The runs of set bits, ascending. Runs that are at most `max_gap` items apart become one: drawing a few items in vain
// is cheaper than another draw call. Runs are long where ids follow the tree's order: number the instances by
// BoxTree::slot_items().
void merge_ranges(std::span<const std::uint64_t> bits, std::uint32_t max_gap, Vector<ItemRange>& ranges);

// ---- Shadow volumes ----

// All points from which going away from a far light one may come into `view`: { x + s · toward_light : x in view, s ≥ 0
// }. The planes, at most 12 for a camera's 6, come from eliminating s (Fourier, Motzkin). Those that look along the
// light stay. Every pair of one that does and one that does not makes one parallel to the light. Exact up to the
// rounding of the new planes. Errors: a direction that is zero or not finite; a view of more than 6 planes; a volume
// that is all of space.
[[nodiscard]] Result<Frustum> shadow_volume(const Frustum& view, const glm::dvec3& toward_light);

// As above for a light at a point: the convex hull of the view and the light.
[[nodiscard]] Result<Frustum> shadow_volume_of_point(const Frustum& view, const glm::dvec3& light_position);

}  // namespace crofton::cull
