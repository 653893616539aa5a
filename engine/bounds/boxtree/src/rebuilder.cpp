// SPDX-License-Identifier: MIT
#include <crofton/boxtree/rebuilder.hpp>

#include <algorithm>
#include <bit>
#include <utility>

#include "bounds.hpp"
#include "builder.hpp"
#include "placement.hpp"
#include "refit.hpp"
#include "turned_bounds.hpp"

namespace crofton::boxtree {
namespace {

// Costs of a rebuild's work, in parts of a budget's unit: of about ten nanoseconds.
constexpr std::size_t kPartsOfUnit = 2;
constexpr std::size_t kItemAdded = 3;     // to a builder
constexpr std::size_t kSlotsPerPart = 8;  // cleared
constexpr std::size_t kNodeLinked = 8, kLeafFilled = 80, kNodeBounded = 160;
constexpr std::size_t kWordsPerPart = 16;
// Where at least one item in so many has been inserted since the rebuild before, nodes leave room for more leaves: a
// full leaf that gets an item is split, and where its node is full, that is split too, whose bounds views pay for.
constexpr std::size_t kManyPlaced = 32;
// Clusters then keep the steps short.
constexpr BuildGrain kWithRoom{4096, 14};
constexpr std::size_t kMostBudget = ~std::size_t{0} / 128;  // so that no multiple of it, added to an index, overflows
// The costs of bringing an item up to date. Placing it may also split leaves and nodes.
constexpr std::size_t kItemMoved = 48, kItemPlaced = 160, kSplit = 160;

std::size_t steps(std::size_t budget, std::size_t cost) {
    return std::max<std::size_t>(budget / cost, 1);
}

bool moves_often(const void* context, ItemId item) {
    const Structure& current = *static_cast<const Structure*>(context);
    return current.contains(item) && current.marks().moves_often(current.slot_of(item));
}

Aabb scene_of(const Structure& current) {
    const Node& root = current.nodes()[0];
    const Aabb bounds = bounds_of(root, current.axes_of(root));
    return root.axes == 0 ? bounds : bounds_along(current.axes()[0], bounds, current.axes_of(root));
}

}  // namespace

struct Rebuilder::Work {
    // The stages, in order. The last, `apply_changes`, brings into `next` what has changed during the others.
    enum class Stage : std::uint8_t { add, divide, clear_slots, link, fill, bound, apply_changes, done };

    Work(const Structure& current, Items& all, const BuildGrain& grain)
        : items(all),
          builder(scene_of(current), all.count_in_leaves(), current.criterion(), current.orientation(), grain),
          next(Owner<Structure>::make(all, current.criterion(), current.orientation())),
          changed((all.size() + 63) / 64, 0),
          placed(changed.size(), 0) {}
    void enter(Stage next_stage, std::size_t from = 0) {
        stage = next_stage;
        at = from;
    }

    Items& items;
    Builder builder;
    Owner<Structure> next;
    Stage stage = Stage::add;
    std::size_t at = 0;  // item, slot, leaf, node or word of `changed`
    // One bit an item: which items have changed since the rebuild began, and which of these were placed again.
    Vector<std::uint64_t> changed, placed;
    std::size_t changed_count = 0;
    std::size_t new_work = 0;  // what the changes since the last step are worth
};

Rebuilder::Rebuilder() = default;
Rebuilder::~Rebuilder() = default;

void Rebuilder::note_change(ItemId item, bool placed) {
    placed_ += placed;
    if (!work_) return;
    if (work_->changed.size() <= item / 64) {
        work_->changed.resize(item / 64 + 1, 0);
        work_->placed.resize(item / 64 + 1, 0);
    }
    std::uint64_t& word = work_->changed[item / 64];
    const std::uint64_t bit = std::uint64_t{1} << (item % 64);
    work_->changed_count += (word & bit) == 0;
    work_->new_work += placed ? kItemPlaced : kItemMoved;
    word |= bit;
    if (placed) work_->placed[item / 64] |= bit;
}

void Rebuilder::note_changes(std::span<const ItemId> items) {
    if (!work_) return;
    for (const ItemId item : items) note_change(item);
}

Owner<Structure> Rebuilder::step(const Structure& current, Items& items, std::size_t budget) {
    last_step_ = {};
    budget = kPartsOfUnit * std::min(budget, kMostBudget);
    if (!work_) {
        if (items.count_in_leaves() == 0) return {};
        const bool many_placed = std::exchange(placed_, 0) * kManyPlaced >= items.count_in_leaves();
        const bool leaves_room = many_placed && current.orientation() == Orientation::aligned;
        work_ = Owner<Work>::make(current, items, leaves_room ? kWithRoom : BuildGrain{});
    }
    if (work_->stage == Work::Stage::apply_changes) budget += work_->new_work;
    work_->new_work = 0;
    while (budget > 0 && work_->stage != Work::Stage::done) budget -= std::min(budget, run_stage(current, budget));
    if (work_->stage != Work::Stage::done) return {};
    Owner<Structure> result = std::move(work_->next);
    work_ = {};
    return result;
}

// Does about `budget` items' worth of the current stage; returns how much it was.
std::size_t Rebuilder::run_stage(const Structure& current, std::size_t budget) {
    switch (work_->stage) {
        case Work::Stage::add:
            return add_items(current, budget);
        case Work::Stage::divide:
            return divide(current, budget);
        case Work::Stage::clear_slots:
            return clear_slots(budget);
        case Work::Stage::link:
            return link_nodes(budget);
        case Work::Stage::fill:
            return fill_leaves(current, budget);
        case Work::Stage::bound:
            return bound_nodes(budget);
        default:
            return apply_changes(current, budget);
    }
}

std::size_t Rebuilder::add_items(const Structure& current, std::size_t budget) {
    const std::size_t all = work_->items.size(), end = std::min(all, work_->at + steps(budget, kItemAdded));
    const std::size_t added = end - work_->at;
    for (; work_->at < end; ++work_->at, ++last_step_.items_added) {
        const auto item = static_cast<ItemId>(work_->at);
        if (current.contains(item)) work_->builder.add(item, work_->items.boxes()[item]);
    }
    if (end == all) work_->enter(Work::Stage::divide);
    return added * kItemAdded;
}

std::size_t Rebuilder::divide(const Structure& current, std::size_t budget) {
    ++last_step_.divisions;
    const std::size_t visits_before = work_->builder.visits();
    const bool done = work_->builder.step(budget, work_->items.boxes(), {moves_often, &current});
    last_step_.visits = work_->builder.visits() - visits_before;
    if (!done) return budget;
    work_->builder.release_scratch();
    work_->next->begin_steps(work_->builder.result());
    work_->enter(Work::Stage::clear_slots);
    return budget;
}

std::size_t Rebuilder::clear_slots(std::size_t budget) {
    const std::size_t all = work_->items.size(), end = std::min(all, work_->at + budget * kSlotsPerPart);
    const std::size_t spent = (end - work_->at) / kSlotsPerPart + 1;
    last_step_.slots_cleared += end - work_->at;
    work_->next->add_items(static_cast<ItemId>(end));
    work_->at = end;
    if (end == all) work_->enter(Work::Stage::link);
    return spent;
}

std::size_t Rebuilder::link_nodes(std::size_t budget) {
    const Topology& topology = work_->builder.result();
    const std::size_t all = topology.nodes.size(), end = std::min(all, work_->at + steps(budget, kNodeLinked));
    const std::size_t linked = end - work_->at;
    work_->next->add_nodes(static_cast<NodeId>(end), topology);
    last_step_.nodes_linked += linked;
    work_->at = end;
    if (end == all) work_->enter(Work::Stage::fill);
    return linked * kNodeLinked;
}

std::size_t Rebuilder::fill_leaves(const Structure& current, std::size_t budget) {
    const Topology& topology = work_->builder.result();
    const std::size_t all = topology.leaves.size(), end = std::min(all, work_->at + steps(budget, kLeafFilled));
    const std::size_t filled = end - work_->at;
    work_->next->add_leaves(static_cast<LeafId>(end), topology, current);
    last_step_.leaves_filled += filled;
    work_->at = end;
    if (end < all) return filled * kLeafFilled;
    work_->next->reset_marks();
    work_->enter(Work::Stage::bound, topology.nodes.size());
    return filled * kLeafFilled;
}

std::size_t Rebuilder::bound_nodes(std::size_t budget) {
    const std::size_t count = std::min(work_->at, steps(budget, kNodeBounded));
    work_->next->bound_nodes(static_cast<NodeId>(work_->at - count), static_cast<NodeId>(work_->at));
    last_step_.nodes_bounded += count;
    work_->at -= count;
    if (work_->at == 0) work_->enter(Work::Stage::apply_changes);
    return count * kNodeBounded;
}

// Brings what has changed since the rebuild began into the new structure.
std::size_t Rebuilder::apply_changes(const Structure& current, std::size_t budget) {
    Structure& next = *work_->next;
    next.add_items(static_cast<ItemId>(work_->items.size()));
    std::size_t spent = 1;
    while (work_->changed_count > 0 && spent < budget) {
        std::uint64_t &changed = work_->changed[work_->at], &placed_word = work_->placed[work_->at];
        for (; changed != 0 && spent < budget; changed &= changed - 1) {
            const std::uint64_t bit = changed & (~changed + 1);
            const auto item = static_cast<ItemId>(64 * work_->at + static_cast<unsigned>(std::countr_zero(changed)));
            const bool present = current.contains(item), placed = (placed_word & bit) != 0;
            placed_word &= ~bit;
            spent += present && (placed || !next.contains(item)) ? kItemPlaced : kItemMoved;
            const std::size_t before = next.nodes().size() + next.leaves().size();
            sync_item(item, present, placed);
            spent += kSplit * (next.nodes().size() + next.leaves().size() - before);
            ++last_step_.items_synced;
            --work_->changed_count;
        }
        if (changed != 0) break;
        spent += work_->at % kWordsPerPart == 0;
        work_->at = (work_->at + 1) % work_->changed.size();
    }
    Refit(next).run();
    next.reset_marks();
    if (work_->changed_count == 0) work_->stage = Work::Stage::done;
    return spent;
}

// Makes the new structure agree with the item's box and layers, and with whether it is there.
void Rebuilder::sync_item(ItemId item, bool present, bool placed) {
    Structure& next = *work_->next;
    if (next.contains(item) && (!present || placed)) Placement(next).vacate(item);
    if (!present) return;
    if (!next.contains(item)) return Placement(next).place(item);
    const std::uint32_t slot = next.slot_of(item);
    if (next.leaves()[slot / kWidth].layers[slot % kWidth] != work_->items.layer_masks()[item])
        next.update_layers(item);
    next.update_box(item);
}

}  // namespace crofton::boxtree
