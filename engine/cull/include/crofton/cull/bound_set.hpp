// SPDX-License-Identifier: MIT
// Flat lists of boxes, axis-aligned boxes or spheres, laid out for testing all of them against views at the speed of
// memory.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/cull/classify.hpp>
#include <crofton/cull/cull.hpp>
#include <crofton/cull/list_layout.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace crofton::cull {

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

    // Bounds that are not valid (not finite, beyond 1e30, an empty Aabb, a negative radius) may be among them: they are
    // straddling.
    void assign(std::span<const Bound> bounds, Executor& executor = serial_executor());
    // bounds[i] has changed, for each of `items`. Requires indices below size(). Bounds that move far from where they
    // were cost their queries more; when many have, their chunk is laid out anew.
    void update(std::span<const std::uint32_t> items, std::span<const Bound> bounds);
    // All may have changed, and be more or fewer than before. Returns the first that is not valid (see assign; a box
    // must pass validate(Obb)), or size().
    std::size_t update(std::span<const Bound> bounds, Executor& executor = serial_executor());

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::span<const RowBlock> rows() const { return rows_; }
    [[nodiscard]] std::span<const Record> records() const { return records_; }
    [[nodiscard]] std::span<const ListChunk> chunks() const { return chunks_; }

  private:
    void assign_chunk(std::size_t c, std::span<const Bound> bounds);
    void resize(std::size_t size);
    void choose_frame(std::size_t c, std::span<const Bound> bounds);
    std::size_t fill_chunk(std::size_t c, std::span<const Bound> bounds);
    void write(std::size_t i, const Bound& bound);
    [[nodiscard]] static bool wants_new_frame(const ListChunk& chunk);

    std::size_t size_ = 0;
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

// Up to 32 views in one pass: bit v of view_masks[i] says that views[v] sees bound i. Without layer masks everything is
// in all layers; layers are looked at last, so that `statistics`, one per view or none, count all bounds. Requires one
// view mask, and one layer mask or none, per bound. Allocates nothing.
template <class Bound>
void find_visible(const BoundSet<Bound>& set, std::type_identity_t<std::span<const Bound>> bounds,
                  std::span<const std::uint32_t> layer_masks, std::span<const View> views,
                  std::span<std::uint32_t> view_masks, CullMode mode = CullMode::exact,
                  Executor& executor = serial_executor(), std::span<Statistics> statistics = {});

// The indices of the bits that are set, ascending, into `ids`, which needs room for 16 more than there are; returns how
// many.
std::size_t list_bits(std::span<const std::uint64_t> bits, std::span<ItemId> ids);

}  // namespace crofton::cull
