// SPDX-License-Identifier: MIT
// All overlapping pairs of many boxes, and queries of one shape or ray against a tree of boxes.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/mesh/mesh_query.hpp>
#include <cstdint>
#include <optional>
#include <span>

namespace crofton::collide {

// ---- Broadphase: all overlapping pairs ----

// The collision layers of an item. Two items are tested iff each one's layers share a bit with the other's
// collides_with.
struct CollisionFilter {
    std::uint32_t layers = 1;
    std::uint32_t collides_with = ~0u;
};
[[nodiscard]] constexpr bool passes(const CollisionFilter& a, const CollisionFilter& b) {
    return (a.layers & b.collides_with) != 0 && (b.layers & a.collides_with) != 0;
}

struct BroadphaseOptions {
    // true: pairs of boxes that overlap; false: pairs whose axis-aligned bounds overlap. Both are decided exactly.
    bool exact_boxes = true;
    std::size_t max_pairs = std::size_t{1} << 28;  // of bounds; more is an error, so that memory is not exhausted
};

// Counts of one update. After update_moved, they count only pairs with an item that moved.
struct BroadphaseStatistics {
    std::uint64_t bound_pairs = 0;   // pairs that go to the exact test: bounds may overlap, filters pass
    std::uint64_t box_pairs = 0;     // pairs listed
    std::uint64_t nodes_tested = 0;  // pairs of leaves of sixteen that were compared
    BatchStatistics boxes;           // how the exact test decided, by groups of axes
    std::uint32_t rejected = 0;      // items whose box is invalid
    bool rebuilt = false;            // this update rebuilt the order of the items
};

// Called for two items whose boxes overlap and whose filters pass; return false to leave the pair out.
//
// first < second. It is called on the executor's threads. Its answer may change only for items that update_moved() is
// passed.
using PairTest = FunctionRef<bool(std::uint32_t first, std::uint32_t second)>;

// All overlapping pairs of boxes, kept from frame to frame.
//
// Call update() if most boxes move, and update_moved() if few do: the cost of update_moved() depends on the boxes that
// move, come and go, however many items and pairs there are. Between updates it keeps a tree of the items, in which
// neighbours in space are neighbours in memory. Answers do not depend on earlier updates.
class Broadphase {
  public:
    // update_moved() looks at items one by one while at most one in this many has moved, come or gone.
    static constexpr std::size_t kFewMovers = 8;

    explicit Broadphase(const BroadphaseOptions& options = {});
    ~Broadphase();
    Broadphase(Broadphase&&) noexcept;
    Broadphase& operator=(Broadphase&&) noexcept;

    // Finds all pairs of boxes that overlap (exactly; touching counts) and that pass `filters`.
    //
    // boxes[i] is the same item as in the last update; you may append items or drop them from the end. `filters` has
    // one entry per box, or is empty, and then all pairs pass. A box that validate(Obb) refuses overlaps nothing and is
    // listed in rejected(). Allocates only if there are more boxes or pairs than ever before. Errors: filters of
    // another size; 2^32 − 1 boxes or more; max_pairs exceeded (no pairs are kept then).
    Result<void> update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters = {},
                        Executor& executor = serial_executor());

    // Does the same as update() if only the boxes and filters of the items in `moved` differ from those of the last
    // update.
    //
    // `moved` may be in any order and may repeat items. Items that are appended or dropped from the end need not be
    // listed. To remove an item elsewhere, make its box invalid, for example with a NaN centre, and list it. If many
    // items have moved, and after an error, it processes all boxes, as update() does. Errors: those of update(); an
    // item that is not an index of `boxes`.
    Result<void> update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                              std::span<const CollisionFilter> filters = {}, Executor& executor = serial_executor());

    // Do the same with a test of pairs. Call update_moved() only after an update() with the same test.
    Result<void> update(std::span<const Obb> boxes, PairTest test, std::span<const CollisionFilter> filters = {},
                        Executor& executor = serial_executor());
    Result<void> update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved, PairTest test,
                              std::span<const CollisionFilter> filters = {}, Executor& executor = serial_executor());

    // Takes memory for so many items, so that items that come later copy nothing to larger memory.
    void reserve(std::size_t items);

    // Gives back the memory that updates of all items work with, and takes what updates of few need. All lists stay as
    // they are. Call it after loading many items, if the next updates move few.
    void release_scratch();

    // Any thread may call these. began() and ended() are ready after each update. The other lists, which are long, are
    // brought up to date by the first call after an update that has changed them; this costs as much as moving the list
    // in memory.
    [[nodiscard]] std::span<const IdPair> pairs() const;  // all, in order
    [[nodiscard]] std::span<const IdPair> began() const;  // in pairs() now, but not before this update
    [[nodiscard]] std::span<const IdPair> stayed() const;
    [[nodiscard]] std::span<const IdPair> ended() const;
    // The subset of pairs() that the last update tested: all pairs, or, if update_moved() processed only the moved
    // items, the pairs with an item that is new or was listed.
    [[nodiscard]] std::span<const IdPair> tested() const;
    [[nodiscard]] std::span<const std::uint32_t> rejected() const;  // ascending
    [[nodiscard]] const BroadphaseStatistics& statistics() const;

  private:
    struct State;
    Owner<State> state_;
};

// ---- Queries of a tree: overlaps, rays, nearest ----

// All queries skip items whose layers share no bit with `layers`. They require a tree that has been refitted since its
// last moves. They are const and thread-safe, and allocate only to grow the caller's vector.

// Replaces `items` by the items whose boxes overlap the shape, ascending, as intersects(box, shape) decides: exactly
// for boxes. A shape that is not finite or fails validate(Obb) overlaps nothing.
void overlapping(const boxtree::BoxTree& tree, const Obb& shape, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Sphere& shape, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Capsule& shape, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);

// Called for an item whose box may be near. Return the distance up to which other items are still of interest, such as
// the distance of the nearest so far. A negative number stops the visit.
using NearVisitor = FunctionRef<double(boxtree::ItemId item)>;

// Visits all items whose boxes are no farther from `bounds` than `distance` ≥ 0 and the visitor's last result, and some
// that are a little farther. Near items come roughly first where the distance is larger than the bounds. The order is
// always the same. If the bounds are empty or not finite, it visits nothing.
void visit_near(const Aabb& bounds, double distance, const boxtree::BoxTree& tree, NearVisitor visit,
                std::uint32_t layers = ~0u);

// Called for an item whose box the ray enters at t. Return the t up to which other boxes are still of interest, such as
// the t of the nearest hit so far. A negative number stops the visit.
using RayVisitor = FunctionRef<double(boxtree::ItemId item, double t)>;

// Visits items whose boxes the ray hits, with t as in raycast(ray, box), up to the visitor's last result (max_t before
// the first). Near items come roughly first, by the order of the tree's nodes. The order is always the same.
void visit_along(const Ray& ray, const boxtree::BoxTree& tree, RayVisitor visit, std::uint32_t layers = ~0u);

struct BoxHit {
    double t = 0.0;
    boxtree::ItemId item = 0;
};
// Returns the box that the ray enters first; of boxes with equal t, that of the lowest item.
[[nodiscard]] std::optional<BoxHit> raycast(const Ray& ray, const boxtree::BoxTree& tree, std::uint32_t layers = ~0u);

}  // namespace crofton::collide
