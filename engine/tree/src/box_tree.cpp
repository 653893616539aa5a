#include <crofton/core/assert.hpp>
#include <crofton/tree/box_tree.hpp>
#include <numeric>

#include "bounds.hpp"
#include "builder.hpp"

namespace crofton::tree {
namespace {

constexpr std::size_t kMaxItems = std::size_t{1} << 30;

glm::dvec3 origin_of(const Aabb& bounds) {
    return bounds.is_empty() ? glm::dvec3(0.0) : bounds.center();
}

void place(double (&origin)[3], const Aabb& bounds) {
    const glm::dvec3 center = origin_of(bounds);
    for (int j = 0; j < 3; ++j) origin[j] = center[j];
}

}  // namespace

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, const BuildOptions& options, Executor& executor) {
    return build(boxes, {}, options, executor);
}

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                               const BuildOptions& options, Executor& executor) {
    if (boxes.size() > kMaxItems) return fail(ErrorCode::out_of_range, kMaxItems, "box tree: more than 2^30 boxes");
    if (!layer_masks.empty() && layer_masks.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "box tree: as many layer masks as boxes are needed, or none");
    if (auto valid = measure::validate(options.criterion); !valid) return tl::unexpected(valid.error());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (auto valid = crofton::validate(boxes[i], i); !valid) return tl::unexpected(valid.error());
    BoxTree tree;
    tree.criterion_ = options.criterion;
    tree.boxes_.assign(boxes.begin(), boxes.end());
    tree.layer_masks_.assign(layer_masks.begin(), layer_masks.end());
    tree.layer_masks_.resize(boxes.size(), ~std::uint32_t{0});
    tree.rebuild(executor);
    return tree;
}

void BoxTree::rebuild(Executor&) {
    Vector<ItemId> items(boxes_.size());
    std::iota(items.begin(), items.end(), ItemId{0});
    const Topology topology = build_topology(boxes_, items, criterion_);
    item_count_ = items.size();
    height_ = topology.height;
    item_slots_.assign(boxes_.size(), kNone);
    nodes_.resize(topology.nodes.size());
    ranges_.resize(topology.nodes.size());
    leaves_.resize(topology.leaves.size());
    leaf_counts_.resize(topology.leaves.size());
    slot_items_.assign(topology.leaves.size() * kWidth, kNone);
    for (LeafId l = 0; l < leaves_.size(); ++l) {
        const Topology::LeafRecord& record = topology.leaves[l];
        Leaf& leaf = leaves_[l];
        clear(leaf);
        leaf.count = record.count;
        leaf_counts_[l] = static_cast<std::uint8_t>(record.count);
        leaf.parent = record.parent;
        leaf.lane_in_parent = record.lane_in_parent;
        Aabb bounds;
        for (std::uint32_t i = 0; i < record.count; ++i)
            bounds.include(boxes_[topology.order[record.first + i]].center);
        place(leaf.origin, bounds);
        for (std::uint32_t i = 0; i < record.count; ++i) {
            const ItemId item = topology.order[record.first + i];
            write_lane(leaf, i, boxes_[item], layer_masks_[item]);
            slot_items_[l * kWidth + i] = item;
            item_slots_[item] = l * kWidth + i;
        }
    }
    for (NodeId n = static_cast<NodeId>(nodes_.size()); n-- > 0;) {
        const Topology::NodeRecord& record = topology.nodes[n];
        Node& node = nodes_[n];
        clear(node);
        ranges_[n] = record.leaves;
        node.count = record.count;
        node.parent = record.parent;
        node.lane_in_parent = record.lane_in_parent;
        std::array<Aabb, kWidth> bounds;
        Aabb whole;
        for (std::uint32_t lane = 0; lane < record.count; ++lane) {
            bounds[lane] = own_bounds(record.child[lane]);
            whole.include(bounds[lane]);
        }
        place(node.origin, whole);
        node.only_leaves = 1;
        for (std::uint32_t lane = 0; lane < record.count; ++lane) {
            if (!(record.child[lane] & kLeafBit)) node.only_leaves = 0;
            node.child[lane] = record.child[lane];
            write_lane(node, lane, bounds[lane]);
            update_layers(n, lane);
        }
    }
}

Aabb BoxTree::own_bounds(std::uint32_t child) const {
    return child & kLeafBit ? bounds_of(leaves_[child & ~kLeafBit]) : bounds_of(nodes_[child]);
}

void BoxTree::update_layers(NodeId n, unsigned lane) {
    Node& node = nodes_[n];
    const std::uint32_t child = node.child[lane];
    std::uint32_t any = 0, all = ~std::uint32_t{0};
    const auto add = [&](const std::uint32_t* some, const std::uint32_t* every, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) any |= some[i], all &= every[i];
    };
    if (child & kLeafBit) {
        const Leaf& leaf = leaves_[child & ~kLeafBit];
        add(leaf.layers, leaf.layers, leaf.count);
    } else {
        add(nodes_[child].layers_any, nodes_[child].layers_all, nodes_[child].count);
    }
    node.layers_any[lane] = any;
    node.layers_all[lane] = all;
}

Aabb BoxTree::child_bounds(NodeId node, unsigned lane) const {
    CROFTON_ASSERT(node < nodes_.size() && lane < nodes_[node].count, "no such child");
    return bounds_of_lane(nodes_[node], lane);
}

}  // namespace crofton::tree
