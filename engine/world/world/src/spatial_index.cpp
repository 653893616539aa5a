// SPDX-License-Identifier: MIT
#include "spatial_index.hpp"

#include <hwy/cache_control.h>
#include <algorithm>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <limits>
#include <utility>

#include "object_table.hpp"
#include "require_ok.hpp"

namespace crofton::world {
namespace {

constexpr std::uint8_t kUpdatesToMove = 2;    // in a row, until an item leaves the tree
constexpr std::uint32_t kUpdatesToEnter = 1;  // without moving, until a new item does not wait in the list any more
// Where most that go have come within this many age marks, as bullets do, new items wait as long while the list is
// short: then they never enter the tree. An old item's mark looks young once in 32 times.
constexpr std::uint8_t kYoungMarks = 8;
constexpr std::uint32_t kYoungGoes = 4, kMostShortLived = 64, kManyShortLived = 16;
constexpr std::size_t kShortList = 64;
// Into the tree one at a time, so many in an update or such a part of those that wait.
constexpr std::size_t kAttachedPerUpdate = 192, kAttachedPart = 4;
constexpr std::size_t kFewItems = 64;
// The tree is rebuilt in the background, once such a part of its items has come or gone, a smaller one where nothing
// comes or goes any more, or has moved within it: what moves stays in its leaf, whose bound grows, and wears the tree
// more.
constexpr std::size_t kMembersToRebuild = 16, kMembersToRebuildAtRest = 128, kMovesToRebuild = 64;
constexpr std::uint32_t kUpdatesAtRest = 16;  // without changes, until nothing is said to come or go any more
// Work on the new tree for each change of the old one, for an item that comes, goes or moves: the cost of an update
// follows its changes. Putting an item into the new tree is worth 80, another change 4, building it some 12 an item
// (BoxTree::rebuild_step). Measured: docs/notes/world.md.
constexpr std::size_t kBudgetPerComing = 448, kBudgetPerGoing = 96, kBudgetPerMove = 128;
// The work follows the changes slowly, so that the update in which many things change does not do all of it: up by the
// first part of the difference in each update, down by the second,
constexpr std::size_t kBudgetRise = 8, kBudgetFall = 32;
// and at least so much and a part of the items.
constexpr std::size_t kLeastBudget = 128, kBudgetPart = 2048;
// Memory for so many items more, a part and a number, is taken with a tree that is built at once.
constexpr std::size_t kRoomPart = 24, kLeastRoom = 64;
// No more than this in one update: some milliseconds.
constexpr std::size_t kMostExtraWork = std::size_t{1} << 19;

// The box with a half extent that validate(Obb) refuses. A rebuild of the tree may still read it as the box.
Obb refused(const Obb& box) {
    Obb result = box;
    result.half_extents.x = -std::max(std::abs(box.half_extents.x), std::numeric_limits<float>::min());
    return result;
}

}  // namespace

SpatialIndex::SpatialIndex(boxtree::Orientation orientation)
    : tree_(detail::value_or_give_up(boxtree::BoxTree::build({}, {.orientation = orientation}))) {}

Result<ItemId> SpatialIndex::add(std::uint32_t layers) {
    auto item = tree_.insert_detached(layers);
    if (!item) return item;
    if (*item >= items_.size()) {
        items_.append(*item + std::size_t{1} - items_.size(), Item());
    } else {
        note_changed(*item);
    }
    items_.set(*item, {});
    keep_no_box(*item);
    return item;
}

Result<void> SpatialIndex::reserve(std::size_t items) {
    if (auto reserved = tree_.reserve(items); !reserved) return reserved;
    items_.reserve_pages(items);
    reserved_ = std::max(reserved_, items);
    return {};
}

void SpatialIndex::keep_no_box(ItemId item) {
    keep_box(item, refused(tree_.boxes()[item]));
}

void SpatialIndex::put(ItemId item, Place place, const Obb& box) {
    Group& to = group(place);
    items_.edit(item).place = place;
    items_.edit(item).entry = static_cast<std::uint32_t>(to.items.size());
    to.items.push_back(item);
    to.boxes.push_back(box);
}

void SpatialIndex::add_mover(ItemId item, const Obb& box, std::uint32_t last_moved) {
    items_.edit(item).place = Place::moving;
    items_.edit(item).entry = moving_.add(item, box, last_moved);
    items_.edit(item).last_moved = last_moved;
    relisted_.push_back(item);
}

// Out of the list or its group, where the last item takes its entry.
void SpatialIndex::take(ItemId item) {
    const Item& taken = items_[item];
    if (taken.place == Place::moving) {
        if (moving_.last_moved(taken.entry) != taken.last_moved) note_changed(item);
        const ItemId last = moving_.item(moving_.size() - 1);
        items_.edit(last).entry = taken.entry;
        relisted_.push_back(item);
        relisted_.push_back(last);
        moving_.remove(taken.entry);
        return;
    }
    Group& from = group(taken.place);
    items_.edit(from.items.back()).entry = taken.entry;
    from.items[taken.entry] = from.items.back();
    from.boxes[taken.entry] = from.boxes.back();
    from.items.pop_back();
    from.boxes.pop_back();
}

void SpatialIndex::fetch_slot(ItemId item) const {
    hwy::Prefetch(&items_[item]);
    if (item < tree_.structure().item_slots().size()) hwy::Prefetch(&tree_.structure().item_slots()[item]);
    hwy::Prefetch(&tree_.boxes()[item]);
}

void SpatialIndex::fetch_leaf(ItemId item) const {
    const boxtree::Structure& structure = tree_.structure();
    if (!structure.contains(item)) return;
    const std::uint32_t leaf = structure.slot_of(item) / boxtree::kWidth;
    const char* const bytes = reinterpret_cast<const char*>(&structure.leaves()[leaf]);
    for (std::size_t byte = 0; byte < sizeof(boxtree::Leaf); byte += 64) hwy::Prefetch(bytes + byte);
    hwy::Prefetch(&structure.slot_items()[leaf * boxtree::kWidth]);
}

void SpatialIndex::detach(ItemId item) {
    require_ok(tree_.detach(item));
    ++changed_in_tree_.went;
    wants_refit_ = true;
}

void SpatialIndex::note_age_of_removed(const Item& item) {
    if (static_cast<std::uint8_t>(age_mark() - item.born) < kYoungMarks)
        short_lived_ = std::min(short_lived_ + kYoungGoes, kMostShortLived);
    else if (short_lived_ > 0)
        --short_lived_;
}

void SpatialIndex::remove(ItemId item) {
    Item& removed = items_.edit(item);
    if (removed.place != Place::nowhere) note_age_of_removed(removed);
    if (removed.place == Place::resting)
        detach(item);
    else if (removed.place != Place::nowhere)
        take(item);
    if (is_placed(item)) member_items_.push_back(item);
    removed = {};
    require_ok(tree_.remove(item));
}

const Obb& SpatialIndex::box(ItemId item) const {
    const Item& asked = items_[item];
    if (asked.place == Place::resting) return tree_.boxes()[item];
    return asked.place == Place::moving ? moving_.box(asked.entry) : group(asked.place).boxes[asked.entry];
}

void SpatialIndex::note_move(ItemId id) {
    Item& item = items_.edit(id);
    const bool in_a_row = item.last_moved + 1 == now_;
    item.streak = in_a_row ? std::min<std::uint8_t>(item.streak + 1, kUpdatesToMove) : std::uint8_t{1};
    item.last_moved = now_;
    moved_items_.push_back(id);
    note_changed(id);
}

void SpatialIndex::note_changed(ItemId item) {
    if (item / 64 >= changed_.size()) changed_.resize(items_.size() / 64 + 1);
    changed_[item / 64] |= std::uint64_t{1} << item % 64;
}

void SpatialIndex::add_movers_that_moved(std::span<std::uint64_t> bits) const {
    for (std::size_t entry = 0; entry < moving_.size(); ++entry) {
        const ItemId item = moving_.item(entry);
        if (item / 64 < bits.size() && moving_.last_moved(entry) != items_[item].last_moved)
            bits[item / 64] |= std::uint64_t{1} << item % 64;
    }
}

// Than in the list.
void SpatialIndex::set_box_elsewhere(ItemId id, const Obb& box) {
    Item& item = items_.edit(id);
    switch (item.place) {
        case Place::nowhere:
            put(id, item.shown ? Place::entering : Place::hidden, box);
            item.born = age_mark();
            if (item.shown) member_items_.push_back(id);
            return;
        case Place::hidden:
        case Place::entering:
            group(item.place).boxes[item.entry] = box;
            note_changed(id);
            return;
        case Place::moving:
            return;
        case Place::resting:
            if (have_same_bits(tree_.boxes()[id], box)) return;
            note_move(id);
            if (item.streak == kUpdatesToMove) {
                detach(id);
                add_mover(id, box, now_);
            } else {
                moved_.push_back(id);
                moved_boxes_.push_back(box);
            }
    }
}

void SpatialIndex::set_shown(ItemId id, bool shown) {
    Item& item = items_.edit(id);
    if (item.shown == shown) return;
    item.shown = shown;
    if (item.place == Place::nowhere) return;
    const Obb last = box(id);
    if (item.place == Place::resting)
        detach(id);
    else
        take(id);
    put(id, shown ? Place::entering : Place::hidden, last);
    member_items_.push_back(id);
}

void SpatialIndex::set_layers(ItemId item, std::uint32_t layers) {
    if (tree_.layer_masks()[item] == layers) return;
    require_ok(tree_.set_layer_mask(item, layers));
    wants_refit_ = true;
    member_items_.push_back(item);
}

SpatialIndex::Changes SpatialIndex::update(const Settings& settings, Executor& executor) {
    Changes changes{static_cast<std::uint32_t>(moved_items_.size() + member_items_.size()), false};
    if (!moved_.empty()) {
        require_ok(tree_.move(moved_, moved_boxes_));
        changed_in_tree_.moves += moved_.size();
        wants_refit_ = true;
    }
    moved_.clear();
    moved_boxes_.clear();
    enter(settings, changes, executor);
    bring_to_rest(settings, changes, executor);
    if (wants_refit_) tree_.refit();
    wants_refit_ = false;
    rebuild_step(settings.rebuild_budget);
    moving_.update(executor);
    items_.settle();
    if (!moved_items_.empty() || !relisted_.empty()) mover_tree_is_old_ = true;
    ++now_;
    return changes;
}

void SpatialIndex::release_scratch() {
    Group& entering = group(Place::entering);
    if (entering.items.empty()) release(entering.items, entering.boxes);
    items_.finish();
    release(moved_items_, member_items_, relisted_, moved_, rested_, moved_boxes_);
}

// The first who asks after an update makes the tree: that costs less than looking at all boxes once.
const collide::MovingTree& SpatialIndex::mover_tree() const {
    if (mover_tree_is_old_.load(std::memory_order_acquire)) {
        const std::lock_guard lock(mover_tree_mutex_);
        if (mover_tree_is_old_.load(std::memory_order_relaxed)) mover_tree_.update(moving().boxes());
        mover_tree_is_old_.store(false, std::memory_order_release);
    }
    return mover_tree_;
}

// Begins once enough has changed since the last rebuild began.
void SpatialIndex::rebuild_step(std::size_t budget) {
    const Changed fresh = changed_in_tree_ - std::exchange(changed_before_, changed_in_tree_);
    const std::size_t changes =
        kBudgetPerComing * fresh.came + kBudgetPerGoing * fresh.went + kBudgetPerMove * fresh.moves;
    if (changes > rebuild_work_)
        rebuild_work_ += std::min(kMostExtraWork, (changes - rebuild_work_ + kBudgetRise - 1) / kBudgetRise);
    else
        rebuild_work_ -= (rebuild_work_ - changes) / kBudgetFall;
    rebuild_work_ = std::min(kMostExtraWork, rebuild_work_);
    quiet_updates_ = fresh.members() > 0 ? 0 : std::min(quiet_updates_ + 1, kUpdatesAtRest);
    if (budget == 0) return;
    if (!rebuilding_) {
        const std::size_t part = quiet_updates_ < kUpdatesAtRest ? kMembersToRebuild : kMembersToRebuildAtRest;
        const std::size_t worn = changed_in_tree_.members() * part + changed_in_tree_.moves * kMovesToRebuild;
        if (worn < tree_.item_count() || worn == 0) return;
        rebuilding_ = true;
        changed_at_start_ = changed_in_tree_;
    }
    const bool is_automatic = budget == kAutomatic;
    const std::size_t least = kLeastBudget + tree_.item_count() / kBudgetPart;
    if (!tree_.rebuild_step(is_automatic ? std::max(rebuild_work_, least) : rebuild_work_ + budget)) return;
    rebuilding_ = false;
    changed_in_tree_ = changed_before_ = changed_in_tree_ - changed_at_start_;
}

// What is new waits in the list until it is seen to rest: what moves from the beginning stays there. What has just been
// loaded is built in one go.
void SpatialIndex::enter(const Settings& settings, Changes& changes, Executor& executor) {
    Group& entering = group(Place::entering);
    if (entering.items.size() > std::max(kFewItems, tree_.item_count() / 2)) {
        rested_.assign(entering.items.begin(), entering.items.end());
        build_tree(rested_, executor);
        changes.tree_built = true;
        return;
    }
    const bool patient = short_lived_ >= kManyShortLived;
    while (!entering.items.empty()) {
        const ItemId item = entering.items.back();
        const Obb box = entering.boxes.back();
        const bool waits = patient && moving_.size() < kShortList;
        const std::uint32_t wait =
            waits ? kYoungMarks * kUpdatesAMark : std::min(kUpdatesToEnter, settings.updates_to_rest);
        take(item);
        // As if it had moved so long before that it has waited when it has not moved since; or will move.
        add_mover(item, box, std::max(now_ + wait, settings.updates_to_rest) - settings.updates_to_rest);
    }
}

// From its group into the tree.
void SpatialIndex::attach(ItemId item) {
    const Obb last = box(item);
    take(item);
    items_.edit(item).place = Place::resting;
    require_ok(tree_.attach(item, last));
    ++changed_in_tree_.came;
}

void SpatialIndex::bring_to_rest(const Settings& settings, Changes& changes, Executor& executor) {
    rested_.clear();
    moving_.list_rested(now_, settings.updates_to_rest, rested_);
    if (rested_.size() > std::max(kFewItems, tree_.item_count())) {
        build_tree(rested_, executor);
        changes.tree_built = true;
        return;
    }
    rested_.resize(std::min(rested_.size(), std::max(kAttachedPerUpdate, rested_.size() / kAttachedPart)));
    for (const ItemId item : rested_) attach(item);
}

// The tree of all that rests and of these, which are taken from their groups.
void SpatialIndex::build_tree(std::span<const ItemId> fresh, Executor& executor) {
    Vector<Obb> boxes(tree_.boxes().begin(), tree_.boxes().end());
    for (const ItemId item : fresh) {
        boxes[item] = box(item);
        take(item);
        items_.edit(item).place = Place::resting;
        items_.edit(item).streak = 0;
    }
    Vector<ItemId> detached, removed;
    for (ItemId item = 0; item < items_.size(); ++item) {
        if (items_[item].place == Place::resting) continue;
        detached.push_back(item);
        if (!tree_.is_detached(item) && !tree_.contains(item)) removed.push_back(item);
        boxes[item] = items_[item].place == Place::moving ? box(item) : Obb();  // valid ones, as building needs them
    }
    auto built = boxtree::BoxTree::build(
        boxes, tree_.layer_masks(),
        {.detached = detached,
         .orientation = tree_.structure().orientation(),
         .room = std::max(boxes.size() / kRoomPart + kLeastRoom, reserved_ - std::min(reserved_, boxes.size()))},
        executor);
    detail::give_up_without_memory(built);
    CROFTON_ASSERT(built.has_value(), "boxes were checked before");
    if (!built) return;
    require_ok(built->reserve(reserved_));
    // The lowest ids are given first.
    for (std::size_t i = removed.size(); i-- > 0;) require_ok(built->remove(removed[i]));
    for (const ItemId item : detached)
        if (items_[item].place != Place::moving) built->keep_box(item, refused(built->boxes()[item]));
    tree_ = std::move(*built);
    changed_in_tree_ = changed_before_ = {};
    rebuilding_ = false;
}

}  // namespace crofton::world
