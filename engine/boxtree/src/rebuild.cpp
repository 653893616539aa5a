// SPDX-License-Identifier: MIT
// Whole rebuilds in the background, a bounded step at a time.
#include "rebuild.hpp"

#include <algorithm>
#include <bit>
#include <crofton/boxtree/box_tree.hpp>

#include "bounds.hpp"

namespace crofton::boxtree {
namespace {

// What things cost, in items' worth: adding one to a builder is worth 1.
constexpr std::size_t kSlotsPerItem = 16;  // cleared
constexpr std::size_t kNodeLinked = 8, kLeafFilled = 32, kNodeBounded = 32;
constexpr std::size_t kWordsPerItem = 16;

std::size_t steps(std::size_t budget, std::size_t cost) {
    return std::max<std::size_t>(budget / cost, 1);
}

}  // namespace

bool BoxTree::rebuild_step(std::size_t budget) {
    last_step_ = {};
    if (!rebuild_) {
        if (item_count() == 0) return false;
        rebuild_ = std::make_unique<Rebuild>();
        rebuild_->builder.emplace(bounds_of(structure_.nodes[0]), item_count(), criterion_);
        rebuild_->changed.assign((boxes_.size() + 63) / 64, 0);
        rebuild_->placed.assign(rebuild_->changed.size(), 0);
    }
    Rebuild& work = *rebuild_;
    if (work.stage == Rebuild::Stage::apply_changes) budget += work.new_work;
    work.new_work = 0;
    while (budget > 0 && work.stage != Rebuild::Stage::done) budget -= std::min(budget, run_stage(work, budget));
    if (work.stage != Rebuild::Stage::done) return false;
    structure_ = std::move(work.structure);
    rebuild_.reset();
    return true;
}

// A step of about `budget` items' worth; returns what it was.
std::size_t BoxTree::run_stage(Rebuild& work, std::size_t budget) {
    using Stage = Rebuild::Stage;
    Structure& structure = work.structure;
    const Topology& topology = work.builder->result();
    const auto enter_stage = [&](Stage stage, std::size_t next = 0) {
        work.stage = stage;
        work.next = next;
    };
    switch (work.stage) {
        case Stage::add: {
            const std::size_t spent = add_items(work, budget);
            if (work.next == boxes_.size()) enter_stage(Stage::divide);
            return spent;
        }
        case Stage::divide: {
            const auto moves = [](const void* context, ItemId item) {
                const Structure& now = static_cast<const BoxTree*>(context)->structure_;
                const std::uint32_t slot = now.item_slots[item];
                if (slot == kNone) return false;
                const std::uint32_t lanes =
                    now.moved_last_refit[slot / kWidth] & now.moved_two_refits_ago[slot / kWidth];
                return (lanes >> slot % kWidth & 1) != 0;
            };
            ++last_step_.divisions;
            if (!work.builder->step(budget, boxes_, {moves, this})) return budget;
            work.builder->release_scratch();
            structure.height = topology.height;
            structure.item_slots.reserve(boxes_.size());
            enter_stage(Stage::clear_slots);
            return budget;
        }
        case Stage::clear_slots: {
            const std::size_t end = std::min(boxes_.size(), work.next + budget * kSlotsPerItem);
            last_step_.slots_cleared += end - work.next;
            structure.item_slots.resize(end, kNone);
            const std::size_t spent = (end - work.next) / kSlotsPerItem + 1;
            work.next = end;
            if (end < boxes_.size()) return spent;
            structure.nodes.reserve(topology.nodes.size());
            structure.ranges.reserve(topology.nodes.size());
            enter_stage(Stage::link);
            return spent;
        }
        case Stage::link: {
            const std::size_t end = std::min(topology.nodes.size(), work.next + steps(budget, kNodeLinked));
            const std::size_t spent = (end - work.next) * kNodeLinked;
            structure.nodes.resize(end);
            structure.ranges.resize(end);
            for (; work.next < end; ++work.next, ++last_step_.nodes_linked)
                init_node(structure, static_cast<NodeId>(work.next), topology);
            if (end < topology.nodes.size()) return spent;
            structure.leaves.reserve(topology.leaves.size());
            structure.leaf_counts.reserve(topology.leaves.size());
            structure.slot_items.reserve(topology.leaves.size() * kWidth);
            enter_stage(Stage::fill);
            return spent;
        }
        case Stage::fill: {
            const std::size_t spent = fill_leaves(work, budget);
            if (work.next < topology.leaves.size()) return spent;
            clear_marks(structure);
            enter_stage(Stage::bound, structure.nodes.size());
            return spent;
        }
        case Stage::bound: {
            // Parents come before children.
            const std::size_t count = std::min(work.next, steps(budget, kNodeBounded));
            for (std::size_t i = 0; i < count; ++i, ++last_step_.nodes_bounded)
                finish_node(structure, static_cast<NodeId>(--work.next));
            if (work.next == 0) enter_stage(Stage::apply_changes);
            return count * kNodeBounded;
        }
        default:
            return apply_changes(work, budget);
    }
}

std::size_t BoxTree::add_items(Rebuild& work, std::size_t budget) {
    const std::size_t end = std::min(boxes_.size(), work.next + budget), spent = end - work.next;
    for (; work.next < end; ++work.next, ++last_step_.items_added)
        if (structure_.item_slots[work.next] != kNone)
            work.builder->add(static_cast<ItemId>(work.next), boxes_[work.next]);
    return spent;
}

std::size_t BoxTree::fill_leaves(Rebuild& work, std::size_t budget) {
    const Topology& topology = work.builder->result();
    const std::size_t end = std::min(topology.leaves.size(), work.next + steps(budget, kLeafFilled));
    const std::size_t spent = (end - work.next) * kLeafFilled;
    work.structure.leaves.resize(end);
    work.structure.leaf_counts.resize(end, 0);
    work.structure.slot_items.resize(end * kWidth, kNone);
    const auto all = static_cast<LeafId>(topology.leaves.size());
    for (; work.next < end; ++work.next, ++last_step_.leaves_filled)
        fill_leaf(work.structure, static_cast<LeafId>(work.next), all, topology);
    return spent;
}

// What has changed since the rebuild began, into the new structure: it takes the old one's place meanwhile, so that
// what changes a tree changes it.
std::size_t BoxTree::apply_changes(Rebuild& work, std::size_t budget) {
    std::swap(structure_, work.structure);
    const Structure& old = work.structure;
    structure_.item_slots.resize(boxes_.size(), kNone);
    std::size_t spent = 1;
    for (; work.changed_count > 0 && spent < budget; ++work.next) {
        if (work.next >= work.changed.size()) work.next = 0;
        std::uint64_t& word = work.changed[work.next];
        const std::uint64_t placed_word = std::exchange(work.placed[work.next], 0);
        spent += work.next % kWordsPerItem == 0;
        for (std::uint64_t rest = std::exchange(word, 0); rest; rest &= rest - 1) {
            const auto item = static_cast<ItemId>(64 * work.next + static_cast<unsigned>(std::countr_zero(rest)));
            const bool present = old.item_slots[item] != kNone, placed = (placed_word & rest & (~rest + 1)) != 0;
            spent += present && (placed || structure_.item_slots[item] == kNone) ? kItemPlaced : kItemMoved;
            sync_item(item, present, placed);
            ++last_step_.items_synced;
            --work.changed_count;
        }
    }
    refit();
    clear_marks(structure_);
    std::swap(structure_, work.structure);
    if (work.changed_count == 0) work.stage = Rebuild::Stage::done;
    return spent;
}

// The structure agrees with the item's box, layers and presence.
void BoxTree::sync_item(ItemId item, bool present, bool placed) {
    const std::uint32_t slot = structure_.item_slots[item];
    if (slot != kNone && (!present || placed)) vacate(item);
    if (!present) return;
    if (slot == kNone || placed) return place(item);
    if (structure_.leaves[slot / kWidth].layers[slot % kWidth] != layer_masks_[item]) {
        write_layers(structure_.leaves[slot / kWidth], slot % kWidth, layer_masks_[item]);
        layers_changed_ = true;
    }
    mark(slot);
    if (has_few_changes(slot / kWidth)) write_item(structure_, item);
}

}  // namespace crofton::boxtree
