// SPDX-License-Identifier: MIT
// Queries of a tree, and of boxes without one: the public functions.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/core/executor.hpp>
#include <crofton/cull/cull.hpp>

#include "tree/query.hpp"

namespace crofton::cull {

std::span<const Verdict> VisibleSet::verdicts() const {
    return {verdicts_.data(), verdicts_.empty() ? 0 : size()};
}

void find_visible(const boxtree::BoxTree& tree, const View& view, VisibleSet& visible, const CullOptions& options,
                  Executor& executor) {
    Query(view, visible, options).run(tree, executor);
}

void find_visible(const boxtree::BoxTree& tree, std::span<const View> views, std::span<VisibleSet> visible,
                  const CullOptions& options, Executor& executor) {
    CROFTON_ASSERT(visible.size() == views.size(), "cull needs one VisibleSet per view");
    const auto ask = [&](std::size_t begin, std::size_t end, Executor& of_each) {
        for (std::size_t v = begin; v < end; ++v) find_visible(tree, views[v], visible[v], options, of_each);
    };
    if (views.size() < executor.concurrency()) return ask(0, views.size(), executor);
    executor.parallel_for(views.size(), 1,
                          [&](std::size_t begin, std::size_t end, unsigned) { ask(begin, end, serial_executor()); });
}

void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view,
                  VisibleSet& visible, const CullOptions& options, Executor& executor) {
    CROFTON_ASSERT(layer_masks.empty() || layer_masks.size() == boxes.size(),
                   "cull needs one layer mask per box, or none");
    Query(view, visible, options).run(boxes, layer_masks, executor);
}

}  // namespace crofton::cull
