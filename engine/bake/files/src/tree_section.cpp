// SPDX-License-Identifier: MIT
#include "tree_section.hpp"
#include <crofton/boxtree/box_tree.hpp>

namespace crofton::bake {

Result<void> add_tree(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Writer& writer,
                      Executor& executor, boxtree::Orientation orientation) {
    const auto tree = boxtree::BoxTree::build(boxes, layer_masks, {.orientation = orientation}, executor);
    if (!tree) return tree.error();
    const Vector<std::byte> bytes = tree->serialise();
    writer.add("tree", std::span<const std::byte>(bytes));
    return {};
}

Result<boxtree::BoxTree> read_tree(const Reader& reader, StopCallback should_stop, void* stop_user) {
    const auto bytes = reader.section<std::byte>("tree");
    if (!bytes) return bytes.error();
    return boxtree::BoxTree::deserialise(*bytes, boxtree::Trust::contents, should_stop, stop_user);
}

}  // namespace crofton::bake
