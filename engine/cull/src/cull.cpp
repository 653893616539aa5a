// SPDX-License-Identifier: MIT
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/error.hpp>
#include <crofton/cull/cull.hpp>

#include "tree/query.hpp"

namespace crofton::cull {

void find_visible(const boxtree::BoxTree& tree, const View& view, VisibleSet& visible, const CullOptions& options,
                  Executor& executor) {
    Query(view, visible, options).run(tree, executor);
}

void find_visible(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, const View& view,
                  VisibleSet& visible, const CullOptions& options, Executor&) {
    CROFTON_ASSERT(layer_masks.empty() || layer_masks.size() == boxes.size(),
                   "cull needs one layer mask per box, or none");
    Query(view, visible, options).run(boxes, layer_masks);
}

}  // namespace crofton::cull
