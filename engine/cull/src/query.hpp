// One query at work in a VisibleSet's buffers.
#pragma once
#include <crofton/cull/cull.hpp>
#include <crofton/cull/moving_boxes.hpp>

#include "tree_kernel.hpp"

namespace crofton::cull {

[[nodiscard]] KernelView kernel_view_of(const View& view);

class Query {
  public:
    // What moves, if there is any, is asked beside a BoxTree.
    Query(const View& view, VisibleSet& visible, const Options& options, const MovingBoxes* moving = nullptr)
        : view_(view), visible_(visible), options_(options), moving_(moving) {}

    void run(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks);
    void run(const boxtree::BoxTree& tree, Executor& executor);

  private:
    void start(std::size_t items);
    void run_all(const boxtree::BoxTree& tree, Executor& executor);
    struct Tasks {
        static constexpr std::size_t kMost = std::size_t{boxtree::kWidth} * boxtree::kWidth;
        std::uint64_t entries[kMost];
        std::size_t count = 0;

        Tasks(const TreeKernelInput& input, bool many);
    };
    void run_parallel(const boxtree::BoxTree& tree, const TreeKernelInput& input, const Tasks& tasks,
                      Executor& executor);
    [[nodiscard]] std::size_t decide(const boxtree::BoxTree& tree, TreeKernelOutput& output) const;
    void append_decided(const TreeKernelOutput& output, std::size_t kept, std::size_t& inside, std::size_t& straddling);
    void add_moving(const boxtree::BoxTree& tree, std::size_t& inside, std::size_t& straddling, Executor& executor);
    void append_moving(const boxtree::BoxTree& tree, std::span<const std::uint64_t> bits, ItemId* to,
                       std::size_t& count);
    void finish(const boxtree::BoxTree& tree, std::size_t inside, std::size_t straddling, Executor& executor);
    void finish(std::size_t inside, std::size_t straddling, std::size_t items);
    void sort(std::size_t inside, std::size_t straddling, std::size_t items);

    const View& view_;
    VisibleSet& visible_;
    const Options& options_;
    const MovingBoxes* moving_;
};

}  // namespace crofton::cull
