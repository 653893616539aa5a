#include "tree_section.hpp"

namespace crofton::bake {

Result<void> add_tree(std::span<const Obb> boxes, std::span<const std::uint32_t> layer_masks, Writer& writer,
                      Executor& executor) {
    const auto tree = tree::BoxTree::build(boxes, layer_masks, {}, executor);
    if (!tree) return tl::unexpected(tree.error());
    const Vector<std::byte> bytes = tree->serialise();
    writer.add("tree", std::span<const std::byte>(bytes));
    return {};
}

Result<tree::BoxTree> read_tree(const Reader& reader) {
    const auto bytes = reader.section<std::byte>("tree");
    if (!bytes) return tl::unexpected(bytes.error());
    return tree::BoxTree::deserialise(*bytes, tree::Trust::contents);
}

}  // namespace crofton::bake
