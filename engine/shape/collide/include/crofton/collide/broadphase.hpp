// SPDX-License-Identifier: MIT
// All pairs of many bodies; one body against a tree of boxes.
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

// Two items are tested iff each one's layers meet what the other collides with.
struct CollisionFilter {
    std::uint32_t layers = 1;
    std::uint32_t collides_with = ~0u;
};
[[nodiscard]] constexpr bool passes(const CollisionFilter& a, const CollisionFilter& b) {
    return (a.layers & b.collides_with) != 0 && (b.layers & a.collides_with) != 0;
}

struct BroadphaseOptions {
    // Pairs of boxes that meet; false: pairs whose axis-aligned bounds meet. Both are decided exactly.
    bool exact_boxes = true;
    std::size_t max_pairs = std::size_t{1} << 28;  // of bounds; more is an error, not an exhausted memory
};

// Of one update. After update_moved, counts are of pairs with an item that moved.
struct BroadphaseStatistics {
    std::uint64_t bound_pairs = 0;   // pairs of bounds that may meet and whose filters pass: given to the exact test
    std::uint64_t box_pairs = 0;     // pairs listed
    std::uint64_t nodes_tested = 0;  // pairs of leaves of sixteen that were compared
    BatchStatistics boxes;           // how the exact test decided, by group of axes
    std::uint32_t rejected = 0;      // items whose box is invalid
    bool rebuilt = false;            // the order of the items was made anew in this update
};

// Asked of two items whose boxes meet and whose filters pass; false leaves the pair out. first < second. Called on the
// executor's threads. The answer may change only with what update_moved() is told of.
using PairTest = FunctionRef<bool(std::uint32_t first, std::uint32_t second)>;

// All pairs of boxes that meet, kept from frame to frame. Call update() when most boxes move, update_moved() when few
// do: its cost follows what moves, comes and goes, however many items and pairs there are. Between updates it keeps a
// tree of the items, in which neighbours in space are neighbours in memory. Answers do not depend on that history.
class Broadphase {
  public:
    explicit Broadphase(const BroadphaseOptions& options = {});
    ~Broadphase();
    Broadphase(Broadphase&&) noexcept;
    Broadphase& operator=(Broadphase&&) noexcept;

    // Finds all pairs of boxes that meet (exactly; touching counts) and that `filters` let pass. boxes[i] is the same
    // item as in the update before; items may be added at the end or dropped from it. `filters` is empty, which lets
    // all pass, or has one entry a box. A box that validate(Obb) refuses meets nothing and is listed in rejected().
    // Allocates only where more boxes or pairs than ever before need it. Errors: filters of another size; 2^32 − 1
    // boxes or more; max_pairs exceeded (no pairs are kept then).
    Result<void> update(std::span<const Obb> boxes, std::span<const CollisionFilter> filters = {},
                        Executor& executor = serial_executor());

    // As update(), where only the boxes and filters of the items in `moved` differ from those of the update before. Any
    // order; repeated items count once. Boxes that are added at the end or dropped from it need not be named. So items
    // come and go in two ways: at the end, or by a box that is invalid, such as one with a centre of NaN, while they
    // are away. With many items moved, and after an error, it looks at all boxes, as update() does. Errors: those of
    // update(); an item that is no index of `boxes`.
    Result<void> update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved,
                              std::span<const CollisionFilter> filters = {}, Executor& executor = serial_executor());

    // The same with a test of pairs; update_moved() after an update() with the same test.
    Result<void> update(std::span<const Obb> boxes, PairTest test, std::span<const CollisionFilter> filters = {},
                        Executor& executor = serial_executor());
    Result<void> update_moved(std::span<const Obb> boxes, std::span<const std::uint32_t> moved, PairTest test,
                              std::span<const CollisionFilter> filters = {}, Executor& executor = serial_executor());

    // Any thread may ask. began() and ended() are there after each update. The other lists, which are long, are brought
    // up to date by the first call after an update that has changed them: it costs what the list's memory costs to
    // move.
    [[nodiscard]] std::span<const IdPair> pairs() const;  // all, in order
    [[nodiscard]] std::span<const IdPair> began() const;  // in pairs() now, not after the update before
    [[nodiscard]] std::span<const IdPair> stayed() const;
    [[nodiscard]] std::span<const IdPair> ended() const;
    // Of pairs(), those that the last update has tested: all, or where update_moved() has looked at what moved alone,
    // those of which an item is new or was named.
    [[nodiscard]] std::span<const IdPair> tested() const;
    [[nodiscard]] std::span<const std::uint32_t> rejected() const;  // ascending
    [[nodiscard]] const BroadphaseStatistics& statistics() const;

  private:
    struct State;
    Owner<State> state_;
};

// ---- Queries of a tree: overlaps, rays, nearest ----

// All queries leave out items whose layers share no bit with `layers`, and want a tree whose moves have been refitted.
// const, thread-safe; no allocation beyond the growth of the caller's vector.

// Replaces `items` by those whose boxes meet the body, ascending. Right as intersects(box, body) is: exactly for boxes.
// A body that is not finite or fails validate(Obb) meets nothing.
void overlapping(const boxtree::BoxTree& tree, const Obb& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Sphere& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);
void overlapping(const boxtree::BoxTree& tree, const Capsule& body, Vector<boxtree::ItemId>& items,
                 std::uint32_t layers = ~0u);

// Told of an item whose box may be near. Answers how near others must be to be of interest still. That may be the
// distance of the nearest so far; a negative number stops.
using NearVisitor = FunctionRef<double(boxtree::ItemId item)>;

// Visits all items whose boxes are no farther from `bounds` than `distance` ≥ 0 and the visitor's last answer, and some
// that are a little farther. The order is always the same. Bounds that are empty or not finite are near to nothing.
void visit_near(const Aabb& bounds, double distance, const boxtree::BoxTree& tree, NearVisitor visit,
                std::uint32_t layers = ~0u);

// Told of an item whose box the ray enters at t. Answers how far along the ray boxes are still of interest. That may be
// the t of the nearest hit so far; a negative number stops.
using RayVisitor = FunctionRef<double(boxtree::ItemId item, double t)>;

// Visits items whose boxes the ray meets (t as raycast(ray, box) gives it) no farther than the visitor's last answer;
// before the first, than max_t. Near ones come first as far as the tree's nodes tell, and always in the same order.
void visit_along(const Ray& ray, const boxtree::BoxTree& tree, RayVisitor visit, std::uint32_t layers = ~0u);

struct BoxHit {
    double t = 0.0;
    boxtree::ItemId item = 0;
};
// The box that the ray enters first; of boxes with equal t that of the lowest item.
[[nodiscard]] std::optional<BoxHit> raycast(const Ray& ray, const boxtree::BoxTree& tree, std::uint32_t layers = ~0u);

}  // namespace crofton::collide
