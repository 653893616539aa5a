// SPDX-License-Identifier: MIT
// Lists of bounds: of any kind at rest, boxes that move.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace crofton::cull {

// Flat lists of boxes, axis-aligned boxes or spheres, laid out for testing all of them against views at the speed of
// memory.

// Laid out for vector kernels (internal).
struct RowBlock;
struct ListChunk;
struct BoxRecord;
struct AabbRecord;
struct SphereRecord;
template <class Bound>
struct RecordOf;
template <>
struct RecordOf<Obb> {
    using Type = BoxRecord;
};
template <>
struct RecordOf<Aabb> {
    using Type = AabbRecord;
};
template <>
struct RecordOf<Sphere> {
    using Type = SphereRecord;
};

// 40 bytes a box (24 a sphere) beside the user's bounds, which queries ask for again: the few that floats cannot decide
// are decided there.
template <class Bound>
class BoundSet {
  public:
    using Record = typename RecordOf<Bound>::Type;

    BoundSet();
    ~BoundSet();
    BoundSet(const BoundSet&);
    BoundSet& operator=(const BoundSet&);
    BoundSet(BoundSet&&) noexcept;
    BoundSet& operator=(BoundSet&&) noexcept;

    // Bounds that are not valid (not finite, beyond 1e30, an empty Aabb, a negative radius) may be among them: they are
    // straddling.
    void assign(std::span<const Bound> bounds, Executor& executor = serial_executor());
    // bounds[i] has changed, for each of `items`. Requires indices below size(). Bounds that move far from where they
    // were cost their queries more; when many have, their chunk is laid out anew.
    void update(std::span<const std::uint32_t> items, std::span<const Bound> bounds);
    // All may have changed, and be more or fewer than before. Returns the first that is not valid (see assign; a box
    // must pass validate(Obb)), or size().
    std::size_t update(std::span<const Bound> bounds, Executor& executor = serial_executor());

    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] std::span<const RowBlock> rows() const;
    [[nodiscard]] std::span<const Record> records() const;
    [[nodiscard]] std::span<const ListChunk> chunks() const;

  private:
    friend class MovingBoxes;
    void assign_chunk(std::size_t c, std::span<const Bound> bounds);
    void resize(std::size_t size);
    void choose_frame(std::size_t c, std::span<const Bound> bounds);
    std::size_t fill_chunk(std::size_t c, std::span<const Bound> bounds);
    void write(std::size_t i, const Bound& bound);
    [[nodiscard]] static bool wants_new_frame(const ListChunk& chunk);

    Vector<RowBlock> rows_;
    Vector<Record> records_;
    Vector<ListChunk> chunks_;
};

using BoxSet = BoundSet<Obb>;
using AabbSet = BoundSet<Aabb>;
using SphereSet = BoundSet<Sphere>;

// The verdicts of classify(view.frustum, bounds[i], mode) for all bounds; `bounds` are those that the set was given.
// The view's layers are not looked at. Allocates nothing once `verdicts` has been used for a set of this size.
template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  VerdictBits& verdicts, CullMode mode = CullMode::exact, Executor& executor = serial_executor());

// As above, without what is not worth drawing: bounds[i] is item i of `limits`, in all layers of the view. Statistics
// count what the view sees.
template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  const DrawLimits& limits, VerdictBits& verdicts, CullMode mode = CullMode::exact,
                  Executor& executor = serial_executor());

// Up to 32 views in one pass: bit v of view_masks[i] says that views[v] sees bound i. Without layer masks everything is
// in all layers; layers are looked at last, so that `statistics`, one per view or none, count all bounds. Requires one
// view mask, and one layer mask or none, per bound. Allocates nothing.
template <class Bound>
Result<void> find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds,
                          std::span<const std::uint32_t> layer_masks, std::span<const View> views,
                          std::span<std::uint32_t> view_masks, CullMode mode = CullMode::exact,
                          Executor& executor = serial_executor(), std::span<Statistics> statistics = {});

// The indices of the bits that are set, ascending, into `ids`, which needs room for 16 more than there are; returns how
// many.
std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids);

// ---- Moving boxes: a list beside the tree ----

// The ids are the tree's. An item is taken out of the tree when it begins to move (BoxTree::detach). It is put back
// when it comes to rest. The layers are the tree's too. 80 bytes an item beside the caller's boxes.
class MovingBoxes {
  public:
    // From now on these are the items that move, each once, and boxes[k] is that of items[k]. Both are the caller's and
    // are not copied: they must stay as they are until the next update. It reads each box once, whatever has changed.
    // Errors leave the list as it was: as many boxes as items are needed; an item that has not been detached; a box
    // that fails validate(Obb), named by its item. Where it was overwritten in place, put it right before the next
    // query.
    [[nodiscard]] Result<void> update(const boxtree::BoxTree& tree, std::span<const ItemId> items,
                                      std::span<const Obb> boxes, Executor& executor = serial_executor());

    // An update in pieces, for boxes that come from many places: each is read and checked once, and queries see none
    // before finish(). The k-th box, `stride` bytes after the one before, is that of items()[entries[k]]; of several
    // for one entry the last counts. Takes them up to the first that is not certainly valid, and returns how many.
    // Requires entries below size().
    std::size_t stage(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride);
    // What has been staged for the entry does not count: finish() reads its box. Any entry.
    void unstage(std::size_t entry) {
        if (entry / 64 < staged_.size()) staged_[entry / 64] &= ~(std::uint64_t{1} << entry % 64);
    }
    // Nothing counts of what has been staged.
    void unstage_all() { staged_.clear(); }
    // As update(), but without its checks: boxes[k] must be what has been staged for entry k, and is read where nothing
    // has. Requires valid boxes, and detached items; there may be more of them or fewer than before.
    void finish(std::span<const ItemId> items, std::span<const Obb> boxes, Executor& executor = serial_executor());

    [[nodiscard]] std::span<const ItemId> items() const { return items_; }
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::size_t size() const { return items().size(); }
    [[nodiscard]] const BoxSet& set() const { return sets_[now_]; }  // over boxes()

  private:
    void begin_staging();
    void finish_chunk(std::size_t c, std::span<const Obb> boxes);

    ResetOnMove<std::span<const ItemId>> items_;
    ResetOnMove<std::span<const Obb>> boxes_;
    BoxSet sets_[2];                // an update is written into the one, and counts once all of it is known to be good
    Vector<std::uint64_t> staged_;  // one bit an entry: written into that set; empty: nothing is staged
    unsigned now_ = 0;
};

// As find_visible() with the tree alone, in every respect: what rests and what moves in one answer. In
// ResultOrder::tree the items that move follow those that rest, inside and straddling apart. Requires the tree that
// `moving` was updated with.
void find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, const View& view, VisibleSet& visible,
                  const CullOptions& options = {}, Executor& executor = serial_executor());

// Up to kMaxViews views in one pass, more are an error; the items that move come last.
Result<void> find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, std::span<const View> views,
                          MaskedVisibleSet& visible, CullMode mode = CullMode::exact,
                          const DrawLimits* limits = nullptr);

}  // namespace crofton::cull
