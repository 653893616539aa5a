// SPDX-License-Identifier: MIT
#include "refit.hpp"

#include <algorithm>
#include <crofton/core/error.hpp>

#include "bounds.hpp"
#include "leaf_extents.hpp"
#include "leaf_writer.hpp"
#include "turned_bounds.hpp"

namespace crofton::boxtree {
namespace {

constexpr std::size_t kBatch = 256;  // leaves; so few are still in the cache when their bounds are computed

}  // namespace

void Refit::run() {
    work_.nodes.clear();
    work_.node_bits.resize((nodes_.size() + 63) / 64, 0);
    refit_leaves();
    // Upwards. A node may be done too early, before a child that is dirty, too: the child then puts it into the next
    // round, where it is done again.
    while (!work_.nodes.empty()) {
        work_.parents.clear();
        for (const NodeId n : work_.nodes) work_.node_bits[n / 64] &= ~(std::uint64_t{1} << (n % 64));
        for (std::size_t i = 0; i < work_.nodes.size(); ++i) refit_node(work_.nodes[i]);
        work_.nodes.swap(work_.parents);
    }
    structure_.contents_changed_ = false;
    structure_.settle();
    if (!work_.leaves.empty()) structure_.marks_.finish_refit();
}

// Writes the bounds of leaves that have changed into their parents' lanes.
void Refit::refit_leaves() {
    structure_.marks_.list_dirty_leaves(work_.leaves);
    LeafExtent extents[kBatch];
    for (std::size_t first = 0; first < work_.leaves.size(); first += kBatch) {
        const auto leaves =
            std::span<const LeafId>(work_.leaves).subspan(first, std::min(kBatch, work_.leaves.size() - first));
        write_dirty_leaves(leaves);
        leaf_extents(leaves_.data(), leaves, extents);
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const Leaf& leaf = leaves_[leaves[i]];
            Aabb bounds = bounds_of(leaf, extents[i]);
            if (structure_.contents_changed_) structure_.write_leaf_radii(leaves[i]);
            const glm::dvec3 size = bounds.is_empty() ? glm::dvec3(0.0) : bounds.max - bounds.min;
            // Far from the leaf's origin positions lose digits: choose a new frame.
            if (double{leaf.l1_radius} > 8.0 * (size.x + size.y + size.z)) {
                structure_.rewrite_leaf(leaves[i]);
                bounds = bounds_of(leaf);
            }
            if (const Node& parent = nodes_[leaf.parent]; parent.axes != 0)
                bounds = bounds_along(structure_.axes_of(parent), leaf);
            set_child(leaf.parent, leaf.lane_in_parent, bounds, work_.nodes);
        }
    }
}

// Writes the boxes of leaves of which so many have changed that moves have only marked them.
void Refit::write_dirty_leaves(std::span<const LeafId> leaves) {
    LeafId many[kBatch];
    std::size_t many_count = 0;
    CROFTON_ASSERT(leaves.size() <= kBatch, "too many leaves at once");
    for (const LeafId l : leaves)
        if (!structure_.marks_.has_few_changes(l)) many[many_count++] = l;
    for (std::span<const LeafId> rest(many, many_count); !rest.empty(); rest = rest.subspan(1)) {
        rest = rest.subspan(structure_.write_leaves(rest));
        if (rest.empty()) break;
        structure_.rewrite_leaf(rest.front());
    }
}

// Writes the bound of a node, whose lanes are up to date, into its parent's lane.
void Refit::refit_node(NodeId n) {
    const Node& node = nodes_[n];
    Aabb bounds = bounds_of(node, structure_.axes_of(node));
    const glm::dvec3 size = bounds.is_empty() ? glm::dvec3(0.0) : bounds.max - bounds.min;
    if (double{node.l1_radius} > 8.0 * (size.x + size.y + size.z)) {
        structure_.refresh_node(n);
        bounds = bounds_of(node, structure_.axes_of(node));
    }
    if (node.parent == kNone) return;
    const std::uint32_t above = nodes_[node.parent].axes;
    if (above != node.axes) bounds = structure_.bounds_below(n, above);
    set_child(node.parent, node.lane_in_parent, bounds, work_.parents);
}

// Writes a child's bound into its lane of the node, with layers and radii if any have changed, and marks the node for
// refitting. Where the node's frame does not take the bound, all lanes are written in a new frame.
void Refit::set_child(NodeId n, unsigned lane, const Aabb& bounds, Vector<NodeId>& dirty) {
    if (!write_lane(nodes_.edit(n), lane, bounds, structure_.axes_of(nodes_[n]))) structure_.refresh_node(n);
    if (structure_.contents_changed_) structure_.refresh_contents(n, lane);
    std::uint64_t& word = work_.node_bits[n / 64];
    const std::uint64_t bit = std::uint64_t{1} << (n % 64);
    if (word & bit) return;
    word |= bit;
    dirty.push_back(n);
}

}  // namespace crofton::boxtree
