// SPDX-License-Identifier: MIT
// The tree's place in the file.
#pragma once
#include <crofton/bake/container.hpp>
#include <crofton/boxtree/box_tree.hpp>

namespace crofton::bake {

// Builds the tree over the boxes and adds it.
[[nodiscard]] Result<void> add_tree(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks,
                                    Writer& writer, Executor& executor, boxtree::Orientation orientation);
[[nodiscard]] Result<boxtree::BoxTree> read_tree(const Reader& reader, StopCallback should_stop, void* stop_user);

}  // namespace crofton::bake
