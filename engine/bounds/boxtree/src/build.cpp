// SPDX-License-Identifier: MIT
// Builds a tree from boxes.
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/items.hpp>
#include <crofton/boxtree/rebuilder.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>

#include "builder.hpp"

namespace crofton::boxtree {
namespace {

constexpr std::size_t kSubtreeBatch = 32;
constexpr double kPrepareShare = 0.3;                     // of the time of a build
constexpr std::size_t kItemsBetweenQuestions = 1u << 14;  // to the caller's StopCallback
// Of a tree that will grow, each node above leaves has room for one more.
constexpr BuildGrain kRoomInNodes{.node_leaves = kWidth - 1};

// Makes a subtree's nodes from its leaves.
void finish_nodes(Structure& structure, NodeId begin, NodeId end, const Topology& topology) {
    structure.link_nodes(begin, end, topology);
    structure.bound_nodes(begin, end);
}

// Makes each subtree's leaves and nodes right after dividing it, while its boxes are in the cache. False: stopped.
bool build_subtrees(Structure& structure, Builder& builder, std::size_t room, detail::StopSignal& stop,
                    Executor& executor) {
    builder.make_room_for_leaves();
    const Topology& topology = builder.result();
    const std::span<const Subtree> subtrees = builder.subtrees();
    const std::span<const Obb> boxes = structure.items().boxes();
    structure.make_room(topology, room);
    Vector<SubtreeBuilder> workers(executor.concurrency());
    for (std::size_t first = 0; first < subtrees.size(); first += kSubtreeBatch) {
        const std::size_t count = std::min(kSubtreeBatch, subtrees.size() - first);
        const Subtree& last = subtrees[first + count - 1];
        const double share =
            kPrepareShare + (1.0 - kPrepareShare) * static_cast<double>(first) / static_cast<double>(subtrees.size());
        const auto wants_stop = [&] { return stop.is_raised(share); };
        structure.make_room_for_leaves(last.first_leaf + last.leaves);
        detail::recoverable_for(executor, count, 1, [&](std::size_t begin, std::size_t end, unsigned worker) {
            for (std::size_t s = first + begin; s < first + end; ++s) {
                if (!builder.build(s, workers[worker], boxes, kItemsBetweenQuestions, wants_stop)) return;
                const Subtree& subtree = subtrees[s];
                const LeafId leaves_end = subtree.first_leaf + subtree.leaves;
                for (LeafId l = subtree.first_leaf; l < leaves_end; ++l) {
                    if (l % (kItemsBetweenQuestions / kWidth) == 0 && wants_stop()) return;
                    structure.fill_leaf(l, leaves_end, topology);
                }
                finish_nodes(structure, subtree.first_node, subtree.first_node + subtree.nodes, topology);
            }
        });
        if (stop.was_raised()) return false;
    }
    finish_nodes(structure, 0, subtrees.front().first_node, topology);
    return true;
}

// Notes the items and finds their order, serially, unless stopped.
void prepare(Builder& builder, const Items& items, const Movers& movers, detail::StopSignal& stop) {
    for (ItemId item = 0; item < items.size(); ++item) {
        if (item % kItemsBetweenQuestions == 0 && stop.is_raised(0.0)) return;
        if (!items.is_detached(item)) builder.add(item, items.boxes()[item]);
    }
    while (!builder.prepare(kItemsBetweenQuestions, items.boxes(), movers))
        if (stop.is_raised(0.5 * kPrepareShare)) return;
}

}  // namespace

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, const BuildOptions& options, Executor& executor) {
    return build(boxes, {}, options, executor);
}

Result<BoxTree> BoxTree::build(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                               const BuildOptions& options, Executor& executor) {
    return detail::recover([&]() -> Result<BoxTree> {
        if (boxes.size() > kMaxItems || options.room > kMaxItems - boxes.size())
            return fail(ErrorCode::out_of_range, kMaxItems, "box tree: more than 2^30 boxes");
        if (!layer_masks.empty() && layer_masks.size() != boxes.size())
            return fail(ErrorCode::invalid_argument, kNoItem,
                        "box tree: as many layer masks as boxes are needed, or none");
        if (auto valid = measure::validate(options.criterion); !valid) return valid.error();
        Vector<std::uint64_t> moving((boxes.size() + 63) / 64, 0);
        for (const ItemId item : options.moving) {
            if (item >= boxes.size())
                return fail(ErrorCode::out_of_range, item, "box tree: no box for an item that moves");
            moving[item / 64] |= std::uint64_t{1} << item % 64;
        }
        const auto moves = [](const void* bits, ItemId item) {
            return (static_cast<const std::uint64_t*>(bits)[item / 64] >> item % 64 & 1) != 0;
        };
        detail::StopSignal stop(options.should_stop, options.stop_user);
        BoxTree tree(options.criterion, options.orientation);
        Items& items = *tree.items_;
        Aabb centers;
        if (auto taken = items.assign(boxes, layer_masks, centers, options.room); !taken) return taken.error();
        for (const ItemId item : options.detached) {
            if (item >= boxes.size())
                return fail(ErrorCode::out_of_range, item, "box tree: no box for an item to detach");
            if (!items.is_detached(item)) items.set_detached(item, true);
        }
        Builder builder(centers, items.count_in_leaves(), options.criterion, options.orientation,
                        options.room > 0 ? kRoomInNodes : BuildGrain{});
        const Movers movers{moves, moving.data()};
        if (executor.concurrency() > 1 && items.count_in_leaves() == boxes.size())
            builder.prepare_all(items.boxes(), movers, stop, executor);
        else
            prepare(builder, items, movers, stop);
        if (stop.was_raised() || !build_subtrees(*tree.structure_, builder, options.room, stop, executor))
            return detail::cancelled("box tree");
        return tree;
    });
}

}  // namespace crofton::boxtree
