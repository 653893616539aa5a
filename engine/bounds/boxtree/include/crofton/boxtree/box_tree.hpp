// SPDX-License-Identifier: MIT
// A dynamic hierarchy of oriented boxes for culling, collision and ray queries.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/core/stop.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crofton::boxtree {

class Items;
class Rebuilder;
class Structure;
using ItemId = std::uint32_t;

// The axes of the tree's inner bounds.
//
// - aligned: the world's axes.
// - oriented: the axes along which the bounds below a node have the least perimeters.
// - automatic: those axes only if they save more visits than rotating a view's planes costs.
enum class Orientation : std::uint8_t { aligned, oriented, automatic };

struct BuildOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    // Items that will move nearly every frame, if you know them. In a tree of more than 32,768 items they share leaves
    // with each other, so that a frame touches few other leaves. rebuild_step() finds such items by itself.
    std::span<const ItemId> moving = {};
    std::span<const ItemId> detached = {};  // detached from the start: see BoxTree::detach
    // The tree keeps this setting: rebuild_step() chooses new axes, insert() uses the existing ones.
    Orientation orientation = Orientation::aligned;
    // Takes memory for so many items more, and leaves room in the nodes above leaves, so that the first insertions copy
    // no arrays and split few leaves.
    std::size_t room = 0;
    // Ends the build with the error `cancelled`. It is asked every few thousand items.
    StopCallback should_stop = nullptr;
    void* stop_user = nullptr;
};

// How much deserialise() may trust its input. `contents`: a checksum has shown that serialise() wrote these bytes.
// deserialise() then checks only links, which takes a tenth of the time.
enum class Trust : std::uint8_t { nothing, contents };

// A tree of items with boxes. Item i's box is boxes()[i]. Every bound contains (exactly) all boxes of the items below
// it. Const functions may run on any number of threads at once; the others need exclusive access to the tree.
class BoxTree {
  public:
    // Builds a tree. Item i is visible in the layers layer_masks[i], or in all layers if there are no masks. A tree
    // without boxes is valid.
    //
    // Errors: a box that fails validate(Obb), named by its index; more than 2^30 boxes; a criterion that fails
    // validate; layer_masks neither empty nor as many as boxes.
    [[nodiscard]] static Result<BoxTree> build(std::span<const Obb> boxes, const BuildOptions& options = {},
                                               Executor& executor = serial_executor());
    [[nodiscard]] static Result<BoxTree> build(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                                               const BuildOptions& options = {},
                                               Executor& executor = serial_executor());
    ~BoxTree();
    BoxTree(BoxTree&&) noexcept;
    BoxTree& operator=(BoxTree&&) noexcept;

    // These functions change items. After moves and removals, bounds are right and tight again after refit(); insert
    // keeps them right.
    //
    // Errors, which leave the tree unchanged: a box that fails validate(Obb); an item that is not in the tree (item =
    // its id); 2^30 items.
    [[nodiscard]] Result<void> move(ItemId item, const Obb& box);
    [[nodiscard]] Result<void> move(std::span<const ItemId> items, std::span<const Obb> boxes);  // all or none
    [[nodiscard]] Result<ItemId> insert(const Obb& box, std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> remove(ItemId item);  // a later insert reuses its id
    [[nodiscard]] Result<void> set_layer_mask(ItemId item, std::uint32_t layer_mask);
    void refit();

    // Takes memory for so many items in all, so that no insertion copies their boxes to larger memory. Leaves and nodes
    // grow in parts. Does nothing if there is as much. Error: more than 2^30 items.
    [[nodiscard]] Result<void> reserve(std::size_t items);

    // For items that move every frame, which cull::MovingBoxes stores separately from the tree. A detached item is in
    // no leaf. It keeps its id and layers until attach() puts it back or remove() frees the id. Otherwise as remove and
    // insert.
    [[nodiscard]] Result<void> detach(ItemId item);
    [[nodiscard]] Result<ItemId> insert_detached(std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> attach(ItemId item, const Obb& box);
    [[nodiscard]] bool is_detached(ItemId item) const;
    // Makes `box` the item's entry in boxes(), for callers that look boxes up there; no query reads it. Requires an id
    // below boxes().size() of an item that is in no leaf: detached or removed. Requires a box that passes validate(Obb)
    // but for the signs of its half extents: a rebuild that has begun earlier may still read it.
    void keep_box(ItemId item, const Obb& box);

    // Does one step of a rebuild in the background; returns true if it has just completed one. Call it once a frame,
    // after refit(), if items move for a long time.
    //
    // `budget` bounds the work of a step. Its unit is adding an item: a whole build costs some 10 per item. Changes
    // since the last call cost extra: 80 for an insertion, 4 for any other change. Items that moved before each of the
    // last two refits count as always moving (BuildOptions).
    bool rebuild_step(std::size_t budget);

    // Checks all invariants: links, counts, slots, bounds. Errors name the node, leaf or item; cancelled, by the
    // callback.
    [[nodiscard]] Result<void> validate(StopCallback should_stop = nullptr, void* stop_user = nullptr) const;

    // Returns bytes from which deserialise() makes an equal tree, on machines of the same byte order. Errors: damaged
    // bytes; cancelled, by the callback.
    [[nodiscard]] Vector<std::byte> serialise() const;
    [[nodiscard]] static Result<BoxTree> deserialise(std::span<const std::byte> bytes, Trust trust = Trust::nothing,
                                                     StopCallback should_stop = nullptr, void* stop_user = nullptr);

    // Indexed by ItemId. Ids are below boxes().size(), those of removed items included.
    [[nodiscard]] std::span<const Obb> boxes() const;
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const;
    [[nodiscard]] bool contains(ItemId item) const;      // in a leaf: neither removed nor detached
    [[nodiscard]] std::size_t item_count() const;        // the number of items in leaves
    [[nodiscard]] Vector<ItemId> spatial_order() const;  // these, leaf by leaf: near items are near in the list

    // For the engine's own use: the nodes and leaves that queries read, and the state of a rebuild.
    [[nodiscard]] const Structure& structure() const { return *structure_; }
    [[nodiscard]] const Rebuilder& rebuilder() const { return *rebuilder_; }

  private:
    BoxTree(const measure::Criterion& criterion, Orientation orientation);
    [[nodiscard]] Result<void> check_item(ItemId item) const;
    [[nodiscard]] Result<ItemId> new_item(const Obb& box, std::uint32_t layer_mask);

    Owner<Items> items_;
    Owner<Structure> structure_;
    Owner<Rebuilder> rebuilder_;
};

}  // namespace crofton::boxtree
