#include "tree_section.hpp"

namespace crofton::bake {

Result<void> add_tree(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Writer& writer,
                      Executor& executor) {
    const auto tree = tree::BoxTree::build(boxes, layer_masks, {}, executor);
    if (!tree) return tl::unexpected(tree.error());
    writer.add("boxes", boxes);
    writer.add("layers", layer_masks);
    return {};
}

Result<tree::BoxTree> read_tree(const Reader& reader, Executor& executor) {
    const auto boxes = reader.section<Obb>("boxes");
    if (!boxes) return tl::unexpected(boxes.error());
    const auto layers = reader.section<std::uint32_t>("layers");
    if (!layers) return tl::unexpected(layers.error());
    return tree::BoxTree::build(*boxes, *layers, {}, executor);
}

}  // namespace crofton::bake
