// SPDX-License-Identifier: MIT
// One query at work in a VisibleSet's buffers.
#pragma once
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/cull/bound_set.hpp>
#include <crofton/cull/cull.hpp>

#include "limits/limits.hpp"
#include "list/list_kernel.hpp"
#include "tree/tree_kernel.hpp"

namespace crofton::cull {

// A view's planes, without what only trees and spheres need. Returns whether the kernels of lists can take them. They
// find invalid bounds by planes, so they need one, with an offset of at most 1e32.
[[nodiscard]] bool set_planes(const View& view, KernelView& result);
void set_lengths(KernelView& view);  // for spheres

// For a tree: its planes in small integers as well.
[[nodiscard]] KernelView kernel_view_of(const View& view);

// The answer if the kernel decided nothing.
void leave_all_undecided(std::size_t count, ListKernelOutput& output);

class Query {
  public:
    // Tests movers, if there are any, besides a BoxTree.
    Query(const View& view, VisibleSet& visible, const CullOptions& options, const MovingBoxes* moving = nullptr)
        : view_(view), visible_(visible), options_(options), moving_(moving) {}

    void run(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Executor& executor);
    void run(const boxtree::BoxTree& tree, Executor& executor);

  private:
    void start(std::size_t items);
    void run_all(const boxtree::BoxTree& tree, Executor& executor);
    // By the draw limits alone.
    [[nodiscard]] bool is_wanted(const Obb& box, ItemId item, std::uint32_t layers) {
        return options_.limits == nullptr ||
               is_within_limits(*options_.limits, box, item,
                                layer_limit_.of(*options_.limits, layers & view_.layer_mask));
    }
    [[nodiscard]] std::uint64_t wanted_bits(std::uint64_t visible, std::span<const Obb> boxes,
                                            std::span<const std::uint32_t> layer_masks, std::size_t first);
    [[nodiscard]] bool has_candidate_slots(const boxtree::Structure& structure);
    void make_candidate_slots(const boxtree::Structure& structure);
    static bool mark_below(std::span<const boxtree::Node> nodes, boxtree::NodeId n,
                           std::span<const std::uint16_t> leaves, std::span<std::uint16_t> marks);
    struct Tasks {
        static constexpr std::size_t kMost = std::size_t{boxtree::kWidth} * boxtree::kWidth;
        std::uint64_t entries[kMost];
        std::size_t count = 0;

        Tasks(const TreeKernelInput& input, bool many);
    };
    void run_parallel(const boxtree::BoxTree& tree, const TreeKernelInput& input, const Tasks& tasks,
                      Executor& executor);
    [[nodiscard]] std::size_t decide(const boxtree::BoxTree& tree, TreeKernelOutput& output);
    void append_decided(const TreeKernelOutput& output, std::size_t kept, std::size_t& inside, std::size_t& straddling);
    void add_moving(const boxtree::BoxTree& tree, std::size_t& inside, std::size_t& straddling, Executor& executor);
    void append_moving(const boxtree::BoxTree& tree, std::span<const std::uint64_t> bits, ItemId* to,
                       std::size_t& count);
    void finish(const boxtree::BoxTree& tree, std::size_t inside, std::size_t straddling, Executor& executor);
    void finish(std::size_t inside, std::size_t straddling, std::size_t items);
    [[nodiscard]] std::uint64_t layer_bits(std::span<const std::uint32_t> layer_masks) const;
    // The visible items of a list, a chunk at a time: bits of all boxes, and of those that straddle.
    struct ListChunks {
        std::span<const Obb> boxes;
        std::span<const std::uint32_t> layer_masks;
        const KernelView* view;  // nullptr: vectors cannot take it
        std::uint64_t *seen, *marked;
    };
    [[nodiscard]] Statistics ask(const ListChunks& list, std::size_t begin, std::size_t end);
    void decide(std::span<const Obb> boxes, ListKernelOutput& output, Statistics& statistics) const;
    void finish(const std::uint64_t* seen, const std::uint64_t* marked, std::size_t words, std::size_t items);
    std::size_t list_marked(const std::uint64_t* seen, const std::uint64_t* marked, std::size_t words);
    [[nodiscard]] std::size_t sort(std::size_t inside, std::size_t straddling, std::size_t items);
    [[nodiscard]] std::size_t sort_few(std::size_t inside, std::size_t straddling);

    const View& view_;
    VisibleSet& visible_;
    const CullOptions& options_;
    const MovingBoxes* moving_;
    LayerLimit layer_limit_;
    bool by_slots_ = false;  // what the options' set leaves out, the kernel has left out
};

}  // namespace crofton::cull
