// SPDX-License-Identifier: MIT
// Puts items into the leaves of a structure, and takes them out.
#pragma once
#include <crofton/boxtree/structure.hpp>

namespace crofton::boxtree {

class Placement {
  public:
    explicit Placement(Structure& structure)
        : structure_(structure), nodes_(structure.nodes_), leaves_(structure.leaves_) {
        ++structure.slots_version_.changes;
    }

    // Puts an item that is in no leaf into the leaf whose criterion grows least. Bounds are right at once.
    void place(ItemId item);
    // Takes the item out of its leaf. Bounds shrink at the next refit.
    void vacate(ItemId item);

  private:
    struct Place {
        NodeId node;
        unsigned lane;
    };

    void put(ItemId item);
    [[nodiscard]] unsigned best_lane(const Node& node, const Aabb& box) const;
    [[nodiscard]] LeafId best_leaf(const Obb& box) const;
    LeafId add_leaf();
    [[nodiscard]] LeafId one_leaf_more(NodeId parent);
    [[nodiscard]] LeafId empty_leaf_of(NodeId parent) const;
    [[nodiscard]] LeafId free_leaf();
    void fetch_items(const ItemId* items) const;
    void split_leaf(LeafId l, ItemId more);
    void make_leaf(LeafId l, std::span<const ItemId> items, NodeId parent, std::uint32_t lane_in_parent);
    void add_child(NodeId parent, std::uint32_t child);
    void remove_child(NodeId parent, unsigned lane);
    void link(NodeId parent, unsigned lane, std::uint32_t child);
    NodeId split_node(NodeId n);
    void make_node(NodeId n, std::span<const std::uint32_t> children, NodeId parent, unsigned lane_in_parent,
                   std::uint32_t axes);
    void make_part(NodeId n, const Node& whole, const NodeRadii& radii, std::span<const unsigned> lanes, NodeId parent,
                   unsigned lane_in_parent);
    void refresh_above(std::uint32_t first);
    void refresh_above_both(std::uint32_t first, std::uint32_t second);
    [[nodiscard]] bool write_path_lane(Place above, std::uint32_t first, std::uint32_t child);
    [[nodiscard]] Place place_of(std::uint32_t child) const;
    void invalidate_item_count(NodeId n);

    Structure& structure_;
    GrowingVector<Node>& nodes_;
    GrowingVector<Leaf>& leaves_;
};

}  // namespace crofton::boxtree
