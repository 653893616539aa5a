// SPDX-License-Identifier: MIT
// A dynamic hierarchy of oriented boxes over items, for views, collisions and rays alike.
#pragma once
#include <crofton/core/executor.hpp>
#include <crofton/core/memory.hpp>
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

// Along which axes the tree's inner bounds lie. aligned: the world's. oriented: those along which the bounds below a
// node have the least perimeters. automatic: these only where they save more visits than turning a view's planes costs.
enum class Orientation : std::uint8_t { aligned, oriented, automatic };

struct BuildOptions {
    measure::Criterion criterion = measure::minimal_perimeter();
    // What will move nearly every frame, if known. In a tree of more than 32,768 items it shares leaves with its like,
    // so that frames touch few leaves besides. rebuild_step() finds such items by itself.
    std::span<const ItemId> moving = {};
    std::span<const ItemId> detached = {};  // from the start: see BoxTree::detach
    // The tree keeps it: rebuild_step() chooses axes anew, insert() takes those that are there.
    Orientation orientation = Orientation::aligned;
};

// What deserialise() may take on trust. `contents`: a checksum has shown that serialise() wrote these bytes. Then only
// links are checked, which takes a tenth of the time.
enum class Trust : std::uint8_t { nothing, contents };

// Item i's box is boxes()[i]. Every bound contains (exactly) all boxes of the items below it. Const functions may run
// on any number of threads at once; the others need the tree for themselves.
class BoxTree {
  public:
    // Item i is visible in the layers layer_masks[i]; without masks, in all. No boxes at all is fine.
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

    // Errors leave the tree as it was: a box that fails validate(Obb), an item that is not in the tree (item = its id),
    // 2^30 items. After moves and removals bounds are right again, and tight, after refit(); insert keeps them right.
    [[nodiscard]] Result<void> move(ItemId item, const Obb& box);
    [[nodiscard]] Result<void> move(std::span<const ItemId> items, std::span<const Obb> boxes);  // all or none
    [[nodiscard]] Result<ItemId> insert(const Obb& box, std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> remove(ItemId item);  // its id is given to a later insert
    [[nodiscard]] Result<void> set_layer_mask(ItemId item, std::uint32_t layer_mask);
    void refit();

    // For what moves in every frame: cull::MovingBoxes keeps it beside the tree. A detached item is in no leaf and
    // keeps its id and layers until attach() puts it back or remove() gives the id away. Otherwise as remove and
    // insert.
    [[nodiscard]] Result<void> detach(ItemId item);
    [[nodiscard]] Result<ItemId> insert_detached(std::uint32_t layer_mask = ~std::uint32_t{0});
    [[nodiscard]] Result<void> attach(ItemId item, const Obb& box);
    [[nodiscard]] bool is_detached(ItemId item) const;

    // Does a step of a rebuild in the background; true when one has just been completed. Call it once a frame, after
    // refit(), where items move for long. `budget` bounds the work of a step. Its unit is adding an item: a whole build
    // costs some 10 an item. Changes since the last call come on top: 64 for an insertion, 2 for another change. Items
    // that moved before each of the last two refits count as always moving (BuildOptions).
    bool rebuild_step(std::size_t budget);

    // Checks every invariant: links, counts, slots, bounds. Errors name the node, leaf or item.
    [[nodiscard]] Result<void> validate() const;

    // A byte string that deserialise() turns into an equal tree, on machines of the same byte order. Errors: damage.
    [[nodiscard]] Vector<std::byte> serialise() const;
    [[nodiscard]] static Result<BoxTree> deserialise(std::span<const std::byte> bytes, Trust trust = Trust::nothing);

    // By ItemId. Ids are below boxes().size(), removed ones included.
    [[nodiscard]] std::span<const Obb> boxes() const;
    [[nodiscard]] std::span<const std::uint32_t> layer_masks() const;
    [[nodiscard]] bool contains(ItemId item) const;      // in a leaf: neither removed nor detached
    [[nodiscard]] std::size_t item_count() const;        // how many the leaves hold
    [[nodiscard]] Vector<ItemId> spatial_order() const;  // these, leaf by leaf: neighbours lie beside each other

    // For the engine alone: nodes and leaves as its queries read them; what a rebuild does.
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
