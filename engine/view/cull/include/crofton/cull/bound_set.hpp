// SPDX-License-Identifier: MIT
// Lists of bounds, and a list of moving boxes to use with a tree.
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

// Flat lists of boxes, axis-aligned boxes or spheres, laid out so that queries test all of them at the speed of memory.

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

// A list of bounds. It takes 40 bytes a box (24 a sphere) in addition to your bounds. Pass these to queries again: the
// few bounds that floats cannot decide are decided from them.
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

    // Sets all bounds. Bounds that are not valid (not finite, beyond 1e30, an empty Aabb, a negative radius) are
    // allowed and are straddling.
    void assign(std::span<const Bound> bounds, Executor& executor = serial_executor());
    // Updates bounds[i] for each i of `items`. Requires indices below size(). Queries of bounds that have moved far
    // cost more; once many have, their chunk is laid out again.
    void update(std::span<const std::uint32_t> items, std::span<const Bound> bounds);
    // Updates all bounds; there may be more or fewer than before. Returns the index of the first that is not valid (see
    // assign; a box must pass validate(Obb)), or size().
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

// Computes the verdicts of classify(view.frustum, bounds[i], mode) for all bounds. Pass the `bounds` that the set was
// given. Ignores the view's layers. Allocates nothing once `verdicts` has been used for a set of this size.
template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  VerdictBits& verdicts, CullMode mode = CullMode::exact, Executor& executor = serial_executor());

// Does the same with draw limits: bounds[i] is item i of `limits`, in all layers of the view. Statistics count the
// bounds that the view sees.
template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds, const View& view,
                  const DrawLimits& limits, VerdictBits& verdicts, CullMode mode = CullMode::exact,
                  Executor& executor = serial_executor());

// Tests up to 32 views in one pass: bit v of view_masks[i] is set if views[v] sees bound i.
//
// Without layer masks every bound is in all layers. Layers are tested last, so `statistics`, one per view or none,
// count all bounds. Requires one view mask, and one layer mask or none, per bound. Allocates nothing.
template <class Bound>
Result<void> find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds,
                          std::span<const std::uint32_t> layer_masks, std::span<const View> views,
                          std::span<std::uint32_t> view_masks, CullMode mode = CullMode::exact,
                          Executor& executor = serial_executor(), std::span<Statistics> statistics = {});

// Writes the indices of the set bits to `ids`, ascending, and returns their number. `ids` needs room for 16 more than
// there are.
std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids);

// ---- Moving boxes: a list to use with a tree ----

// A list of moving boxes, used together with a tree. The ids and layers are the tree's.
//
// Take an item out of the tree when it begins to move (BoxTree::detach), and put it back when it comes to rest. The
// list takes 80 bytes an item in addition to your boxes.
class MovingBoxes {
  public:
    // Sets the moving items, each once; boxes[k] is the box of items[k].
    //
    // Both arrays are yours and are not copied: they must stay unchanged until the next update. It reads each box once,
    // whatever has changed. Errors leave the list unchanged: different numbers of boxes and items; an item that has not
    // been detached; a box that fails validate(Obb), named by its item. If you have overwritten that box in place,
    // correct it before the next query.
    [[nodiscard]] Result<void> update(const boxtree::BoxTree& tree, std::span<const ItemId> items,
                                      std::span<const Obb> boxes, Executor& executor = serial_executor());

    // Stages part of an update, for boxes that come from many places. Each box is read and checked once, and queries
    // see none before finish().
    //
    // The k-th box, `stride` bytes after the one before, belongs to items()[entries[k]]; of several boxes for one entry
    // the last counts. Stops at the first box that is not certainly valid, and returns the number of staged boxes.
    // Requires entries below size().
    //
    // Both or neither of the last two: `before`, which must be boxes() as they were at the last finish(), so that boxes
    // that have moved without turning cost less; and `differs`, of size() bytes, of which that of an entry becomes 1 if
    // its staged box differs from the one before, bit for bit, else 0.
    std::size_t stage(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride,
                      const Obb* before = nullptr, std::uint8_t* differs = nullptr);
    // Discards the staged box of any entry; finish() reads its box.
    void unstage(std::size_t entry) {
        if (entry / 64 < staged_.size()) staged_[entry / 64] &= ~(std::uint64_t{1} << entry % 64);
    }
    // Discards everything staged.
    void unstage_all() { staged_.clear(); }
    // Finishes the update like update(), but without its checks. boxes[k] must be the box that was staged for entry k;
    // it is read if none was staged. Requires valid boxes and detached items; there may be more or fewer of them than
    // before.
    void finish(std::span<const ItemId> items, std::span<const Obb> boxes, Executor& executor = serial_executor());

    [[nodiscard]] std::span<const ItemId> items() const { return items_; }
    [[nodiscard]] std::span<const Obb> boxes() const { return boxes_; }
    [[nodiscard]] std::size_t size() const { return items().size(); }
    [[nodiscard]] const BoxSet& set() const { return sets_[now_]; }  // over boxes()

  private:
    void begin_staging();
    void finish_chunk(std::size_t c, std::span<const Obb> boxes);
    void assign_chunk(std::size_t c, std::span<const Obb> boxes);

    ResetOnMove<std::span<const ItemId>> items_;
    ResetOnMove<std::span<const Obb>> boxes_;
    BoxSet sets_[2];                // an update is written into the one, and counts once all of it is known to be good
    Vector<std::uint64_t> staged_;  // one bit an entry: written into that set; empty: nothing is staged
    Vector<std::uint8_t> shapes_;   // of that set, a byte for sixteen entries (list/box_writer.hpp); may be empty
    unsigned now_ = 0;
};

// Finds static and moving items in one answer, in every respect as find_visible() of the tree alone.
//
// In ResultOrder::tree the moving items follow the static ones, separately for inside and straddling. Requires the tree
// that `moving` was updated with.
void find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, const View& view, VisibleSet& visible,
                  const CullOptions& options = {}, Executor& executor = serial_executor());

// Does the same for up to kMaxViews views in one pass; more are an error. Moving items come last.
Result<void> find_visible(const boxtree::BoxTree& resting, const MovingBoxes& moving, std::span<const View> views,
                          MaskedVisibleSet& visible, CullMode mode = CullMode::exact,
                          const DrawLimits* limits = nullptr);

}  // namespace crofton::cull
