// SPDX-License-Identifier: MIT
// The boxes of a World's objects: a tree of those at rest and a list of those that move. Detects which is which.
#pragma once
#include <algorithm>
#include <atomic>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/collide/moving_tree.hpp>
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/same_bits.hpp>
#include <crofton/world/world.hpp>
#include <mutex>

#include "moving_list.hpp"

namespace crofton::world {

// Ids are the tree's. What is asked of the tree and of the list is as of the last update(). Boxes are valid.
class SpatialIndex {
  public:
    struct Settings {
        std::size_t rebuild_budget = 0;
        std::uint32_t updates_to_rest = 0;
    };
    struct Changes {
        std::uint32_t boxes = 0;
        bool tree_built = false;
    };

    explicit SpatialIndex(boxtree::Orientation orientation);

    // A new item, shown, without a box: it is nowhere until it gets one.
    [[nodiscard]] Result<ItemId> add(std::uint32_t layers);
    // Takes memory for so many items in all, and again whenever the tree is built. Error: more than a tree holds.
    [[nodiscard]] Result<void> reserve(std::size_t items);
    void remove(ItemId item);
    // Asks the memory for what removing or hiding the n-th and later of many items needs.
    template <class ItemOf>
    void fetch_ahead(std::size_t n, std::size_t count, ItemOf item_of) const {
        constexpr std::size_t kFar = 24, kNear = 12;
        if (n + kFar < count) fetch_slot(item_of(n + kFar));
        if (n + kNear < count) fetch_leaf(item_of(n + kNear));
    }
    void set_box(ItemId item, const Obb& box) {
        if (items_[item].place != Place::moving)
            set_box_elsewhere(item, box);
        else if (moving_.set_box(items_[item].entry, box, now_))
            moved_items_.push_back(item);
    }
    // What stands in it has moved, also where its box is the same to the bit.
    void set_box_of_moved(ItemId item, const Obb& box) {
        const bool stays = has_box(item) && have_same_bits(this->box(item), box);
        if (!stays) return set_box(item, box);
        if (is_placed(item)) moved_items_.push_back(item);
        note_changed(item);
    }
    void set_shown(ItemId item, bool shown);
    void set_layers(ItemId item, std::uint32_t layers);

    // Between updates: a box for commit(), if the item moves. False, and nothing done, if it does not.
    bool stage_box(ItemId item, const Obb& box) {
        if (items_[item].place != Place::moving) return false;
        moving_.stage(items_[item].entry, box, now_);
        return true;
    }
    // Likewise many, by their entries in the list, up to the first box that is not certainly valid; boxes are `stride`
    // bytes apart. Returns how many.
    std::size_t stage_movers(std::span<const std::uint32_t> entries, const Obb* first, std::size_t stride) {
        return moving_.stage(entries, first, stride, now_);
    }
    // kNoIndex: the item is not in the list.
    [[nodiscard]] std::uint32_t mover_entry(ItemId item) const {
        return items_[item].place == Place::moving ? items_[item].entry : kNoIndex;
    }
    // Takes over the staged boxes. Before any other change of an update.
    void commit() {
        moved_items_.clear();
        member_items_.clear();
        relisted_.clear();
        moving_.commit(now_, moved_items_);
    }

    Changes update(const Settings& settings, Executor& executor);
    // That the last update() found in the tree or the list and moved. One may be named twice.
    [[nodiscard]] std::span<const ItemId> moved_items() const { return moved_items_; }
    // That have come, gone, been hidden or shown, or got other layers since the last commit().
    [[nodiscard]] std::span<const ItemId> member_items() const { return member_items_; }
    // That have come into the list, left it or got another entry since the last commit(). One may be named twice.
    [[nodiscard]] std::span<const ItemId> relisted_items() const { return relisted_; }

    // Gives back what loading many items has taken and updates of few do not need. The lists of this update are empty
    // then.
    void release_scratch();

    // A bit for each item that has ever had another box than at first, or whose id another item had before.
    [[nodiscard]] std::span<const std::uint64_t> changed() const { return changed_; }
    // Sets the bits of items in the list that have moved since they entered it: changed() has them once they leave it.
    void add_movers_that_moved(std::span<std::uint64_t> bits) const;

    [[nodiscard]] std::size_t size() const { return items_.size(); }  // ids are below it
    [[nodiscard]] bool is_placed(ItemId item) const {                 // in the tree or the list
        return items_[item].place >= Place::entering;
    }
    [[nodiscard]] bool has_box(ItemId item) const { return items_[item].place != Place::nowhere; }
    [[nodiscard]] const Obb& box(ItemId item) const;  // of an item that has one
    [[nodiscard]] std::uint32_t layers(ItemId item) const { return tree_.structure().items().layer_masks()[item]; }
    [[nodiscard]] const boxtree::BoxTree& tree() const { return tree_; }
    // Boxes by item, side by side: of items in the tree their own, of others what keep_box() was given last. Until
    // then, and after keep_no_box(), a box that validate(Obb) refuses.
    [[nodiscard]] std::span<const Obb> kept_boxes() const { return tree_.boxes(); }
    void keep_box(ItemId item, const Obb& box) {
        if (items_[item].place != Place::resting) tree_.keep_box(item, box);
    }
    void keep_no_box(ItemId item);
    [[nodiscard]] const cull::MovingBoxes& moving() const { return moving_.boxes(); }

    // Calls visit(entry) for entries of moving(), near ones roughly first: all whose boxes a box may meet whose center
    // moves along a ray, or that may be within a distance of `bounds`, and maybe others. It returns how far others are
    // of interest; a negative number ends the visit. Any thread may ask.
    void visit_movers_along(const Ray& ray, const glm::dvec3& half_size, collide::MovingTree::Visitor visit) const {
        if (!visit_few_movers(visit)) mover_tree().visit_along(ray, half_size, visit);
    }
    void visit_movers_near(const Aabb& bounds, double distance, collide::MovingTree::Visitor visit) const {
        if (!visit_few_movers(visit)) mover_tree().visit_near(bounds, distance, visit);
    }

  private:
    enum class Place : std::uint8_t { nowhere, hidden, entering, resting, moving };
    struct Item {
        std::uint32_t entry = 0;       // in the list or the group of its place
        std::uint32_t last_moved = 0;  // while it rests; in the list: as of when it came
        std::uint8_t streak = 0;       // updates in a row in which it moved, up to kUpdatesToMove
        std::uint8_t born = 0;         // age_mark() of the update in which it came
        Place place = Place::nowhere;
        bool shown = true;
    };
    struct Group {
        Vector<ItemId> items;
        Vector<Obb> boxes;
    };
    // How many items came, went and moved.
    struct Changed {
        std::size_t came = 0, went = 0, moves = 0;
        [[nodiscard]] std::size_t members() const { return came + went; }
        [[nodiscard]] Changed operator-(const Changed& other) const {
            return {came - other.came, went - other.went, moves - other.moves};
        }
    };
    static constexpr std::uint32_t kUpdatesAMark = 8;
    [[nodiscard]] Group& group(Place place) { return groups_[static_cast<std::size_t>(place)]; }
    [[nodiscard]] const Group& group(Place place) const { return groups_[static_cast<std::size_t>(place)]; }
    // Into a group; into the list with add_mover().
    void put(ItemId item, Place place, const Obb& box);
    void add_mover(ItemId item, const Obb& box, std::uint32_t last_moved);
    void take(ItemId item);
    void fetch_slot(ItemId item) const;
    void fetch_leaf(ItemId item) const;
    void set_box_elsewhere(ItemId item, const Obb& box);
    void detach(ItemId item);
    void note_move(ItemId item);
    void note_changed(ItemId item);
    void note_age_of_removed(const Item& item);
    [[nodiscard]] std::uint8_t age_mark() const { return static_cast<std::uint8_t>(now_ / kUpdatesAMark); }
    void rebuild_step(std::size_t budget);
    void attach(ItemId item);
    void enter(const Settings& settings, Changes& changes, Executor& executor);
    void bring_to_rest(const Settings& settings, Changes& changes, Executor& executor);
    void build_tree(std::span<const ItemId> entering, Executor& executor);

    // All of them one by one. False, and nothing done, if they are many.
    bool visit_few_movers(collide::MovingTree::Visitor visit) const {
        constexpr std::size_t kFew = 64;
        const std::size_t size = moving().size();
        if (size > kFew) return false;
        for (std::size_t n = 0; n < size; ++n)
            if (!(visit(static_cast<std::uint32_t>(n)) >= 0.0)) break;
        return true;
    }
    [[nodiscard]] const collide::MovingTree& mover_tree() const;

    GrowingVector<Item> items_;
    Group groups_[3];  // by Place: nowhere (empty), hidden, entering
    boxtree::BoxTree tree_;
    MovingList moving_;
    Vector<ItemId> moved_items_, member_items_, relisted_;  // in this update
    Vector<ItemId> moved_, rested_;                         // the first: of those the tree's, with
    Vector<Obb> moved_boxes_;
    Vector<std::uint64_t> changed_;
    std::uint32_t now_ = 1;  // counts updates
    // In the tree, since the last rebuild began; of them those before the last update, and those when the one under way
    // began.
    Changed changed_in_tree_, changed_before_, changed_at_start_;
    std::size_t reserved_ = 0;         // items
    std::size_t rebuild_work_ = 0;     // that the changes of the last updates make necessary
    std::uint32_t short_lived_ = 0;    // rises where items go that are young, falls where others do
    std::uint32_t quiet_updates_ = 0;  // since an item came into the tree or went, up to kUpdatesAtRest
    bool rebuilding_ = false, wants_refit_ = false;
    // Over the list's boxes; made when someone asks.
    mutable std::mutex mover_tree_mutex_;
    mutable std::atomic<bool> mover_tree_is_old_ = true;
    mutable collide::MovingTree mover_tree_;
};

}  // namespace crofton::world
