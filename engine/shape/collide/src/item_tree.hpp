// SPDX-License-Identifier: MIT
// A tree over bounds whose items are inserted, moved and removed one at a time.
#pragma once
#include <crofton/core/growing_vector.hpp>
#include <crofton/core/memory.hpp>
#include <span>

#include "bound_blocks.hpp"

namespace crofton::collide {

// An R-tree (Guttman 1984) of blocks of sixteen, all leaves at the same depth. A change costs a path from a leaf to the
// root, however many items there are: full blocks are split in two, and what is left of nearly empty ones is put in
// again. Items whose moves make their leaf much larger than it was are put in again, too.
class ItemTree {
  public:
    // What happens when a leaf is full: it is split, or its node gets one more leaf, which all its full leaves share
    // and which is as wide as the node. Sharing makes insertions cheaper and queries dearer.
    enum class FullLeaves : std::uint8_t { share_one_more, split };
    explicit ItemTree(FullLeaves full = FullLeaves::share_one_more) : full_leaves_(full) { clear(); }

    void clear();
    // Items are below `count`. New ones are not in the tree. Requires that those that fall away are not.
    void reserve(std::size_t count) { places_.reserve_pages(count); }
    void resize(std::size_t count);
    [[nodiscard]] std::size_t item_count() const { return places_.size(); }
    [[nodiscard]] std::size_t size() const { return size_; }  // items in the tree
    [[nodiscard]] bool contains(std::uint32_t item) const { return places_[item] != kNowhere; }
    [[nodiscard]] BoundTree view() const;

    // These items alone, sixteen a leaf in their order, in nodes with room for another leaf. Then put the leaves'
    // bounds, and call bound_all(), and remember_extents().
    void arrange(std::span<const std::uint32_t> order);
    [[nodiscard]] std::size_t leaf_count() const { return levels_[0].counts.size(); }  // free ones too
    [[nodiscard]] std::span<const std::uint32_t> items_of(std::size_t leaf) const {
        return levels_[0].children.view().subspan(leaf * kBoxBlock, levels_[0].counts[leaf]);
    }
    // Before all leaves get bounds: then several threads may write into different ones.
    void begin_bounds() { levels_[0].bounds.edit_all(); }
    [[nodiscard]] BoundBlock& leaf(std::size_t leaf) { return levels_[0].bounds.edit(leaf); }
    // Empties the bounds of the leaf's lanes without items.
    void clear_unused(std::size_t leaf) { clear_unused(0, leaf); }
    // Bounds of all blocks anew, from the leaves'.
    void bound_all();
    void remember_extents();
    // Return the extent of a leaf's bounds when the leaf was made, and the mean of all leaves, as of bound_all().
    [[nodiscard]] float leaf_extent(std::size_t leaf) const { return levels_[0].extents[leaf]; }
    [[nodiscard]] float mean_leaf_extent() const {
        return leaf_count() > 0 ? static_cast<float>(remembered_ / static_cast<double>(leaf_count())) : 0.0f;
    }
    // Whether the leaves have grown much since they were made, or are nearly empty: then an order made anew pays.
    [[nodiscard]] bool is_worn() const;

    void insert(std::uint32_t item, const LaneBounds& bounds);
    void remove(std::uint32_t item);
    // New bounds of some of the items, then settle() of these.
    void move(std::uint32_t item, const LaneBounds& bounds);
    void settle(std::span<const std::uint32_t> moved);
    // Asks the memory for what move() needs.
    void fetch_place(std::uint32_t item) const;
    void fetch_leaf(std::uint32_t item) const;

  private:
    static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};
    struct Level {
        GrowingVector<BoundBlock> bounds;
        GrowingVector<std::uint32_t> children;  // as in BoundTree
        Vector<std::uint32_t> parents;          // likewise
        Vector<std::uint8_t> counts, is_marked;
        Vector<float> extents;               // of a block's bounds, but for what moves have added since it was made
        Vector<std::uint32_t> free, marked;  // the second: bounds have changed
        void clear();
        void reserve(std::size_t blocks);
        void settle();
    };
    // A child and its bounds, which belong into a block of the level.
    struct Entry {
        std::size_t level;
        std::uint32_t child;
        LaneBounds bounds;
    };

    [[nodiscard]] std::uint32_t place_of(std::size_t level, std::uint32_t child) const {
        return level == 0 ? places_[child] : levels_[level - 1].parents[child];
    }
    void set_place(std::size_t level, std::uint32_t child, std::uint32_t place) {
        if (level == 0) return places_.set(child, place);
        levels_[level - 1].parents[child] = place;
    }
    [[nodiscard]] LaneBounds bounds_of(std::size_t level, std::uint32_t block) const;
    [[nodiscard]] bool is_loose(std::size_t level, std::uint32_t block) const;
    std::uint32_t make_block(std::size_t level);
    void fill(std::size_t level, std::uint32_t block, std::span<const Entry> entries);
    void put(const Entry& entry);
    void clear_unused(std::size_t level, std::size_t block);
    void add_leaf(std::uint32_t parent, const Entry& entry);
    void add(std::size_t level, std::uint32_t block, const Entry& entry);
    void split(std::size_t level, std::uint32_t block, const Entry& entry);
    void grow(std::size_t level, std::uint32_t block, const LaneBounds& bounds);
    void shrink(std::size_t level, std::uint32_t block);
    void take(std::size_t level, std::uint32_t place);
    void give_up(std::size_t level, std::uint32_t block);
    void put_orphans();
    void mark(std::size_t level, std::uint32_t block);
    void bound_marked();
    void put_again(std::size_t level, std::span<const std::uint32_t> moved);

    FullLeaves full_leaves_;
    Level levels_[kMaxLevels];
    std::size_t level_count_ = 2, size_ = 0;
    std::uint32_t root_ = 0;
    GrowingVector<std::uint32_t> places_;  // by item: 16 times its leaf, and the lane there
    Vector<Entry> orphans_, escaped_;
    Vector<std::uint32_t> loose_;
    double extent_ = 0.0, remembered_ = 0.0;  // of the leaves, as of bound_all()
};

}  // namespace crofton::collide
