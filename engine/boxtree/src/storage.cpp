// SPDX-License-Identifier: MIT
// Trees as byte strings.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/recovery.hpp>
#include <cstring>

namespace crofton::boxtree {
namespace {

struct Header {
    char magic[8] = {'c', 'r', 'o', 'f', 't', 'r', 'e', 'e'};
    std::uint32_t version = 4;
    std::uint32_t byte_order = 0x01020304;
    std::uint32_t node_bytes = sizeof(Node), leaf_bytes = sizeof(Leaf), box_bytes = sizeof(Obb);
    std::uint32_t height = 0;
    std::uint64_t boxes = 0, free_items = 0, nodes = 0, leaves = 0;
    double criterion[3] = {};
};
static_assert(sizeof(Header) == 88);

}  // namespace

// The one list of what is stored, in order, for writing and reading.
struct TreeStorage {
    template <class Tree, class Visit>
    static void arrays(Tree& tree, const Header& h, Visit&& visit) {
        visit(tree.boxes_, h.boxes);
        visit(tree.layer_masks_, h.boxes);
        visit(tree.free_items_, h.free_items);
        visit(tree.structure_.nodes, h.nodes);
        visit(tree.structure_.ranges, h.nodes);
        visit(tree.structure_.leaves, h.leaves);
        visit(tree.structure_.leaf_counts, h.leaves);
        visit(tree.structure_.slot_items, h.leaves * kWidth);
        visit(tree.structure_.item_slots, h.boxes);
    }
};

Vector<std::byte> BoxTree::serialise() const {
    Header header;
    header.height = structure_.height;
    header.boxes = boxes_.size();
    header.free_items = free_items_.size();
    header.nodes = structure_.nodes.size();
    header.leaves = structure_.leaves.size();
    header.criterion[0] = criterion_.volume_weight;
    header.criterion[1] = criterion_.area_weight;
    header.criterion[2] = criterion_.mean_curvature_weight;
    Vector<std::byte> bytes;
    const auto append = [&](const void* data, std::size_t size) {
        const auto* first = static_cast<const std::byte*>(data);
        bytes.insert(bytes.end(), first, first + size);
    };
    append(&header, sizeof(header));
    TreeStorage::arrays(*this, header, [&](const auto& array, std::uint64_t) {
        append(array.data(), array.size() * sizeof(array[0]));
    });
    return bytes;
}

Result<BoxTree> BoxTree::deserialise(std::span<const std::byte> bytes, Trust trust) {
    return detail::recover([&]() -> Result<BoxTree> {
        const auto damaged = [](const char* why) {
            return fail(ErrorCode::parse, kNoItem, std::string("stored box tree: ") + why);
        };
        Header header;
        const Header expected;
        if (bytes.size() < sizeof(header)) return damaged("too short");
        std::memcpy(&header, bytes.data(), sizeof(header));
        if (std::memcmp(header.magic, expected.magic, sizeof(header.magic)) != 0) return damaged("not a box tree");
        if (header.version != expected.version || header.byte_order != expected.byte_order ||
            header.node_bytes != expected.node_bytes || header.leaf_bytes != expected.leaf_bytes ||
            header.box_bytes != expected.box_bytes)
            return damaged("written by another version or on another kind of machine");
        if (header.boxes > (1u << 30) || header.free_items > header.boxes || header.nodes > (1u << 30) ||
            header.leaves > (1u << 30) || header.height == 0 || header.height > 64)
            return damaged("sizes out of range");
        BoxTree tree;
        tree.criterion_ = {header.criterion[0], header.criterion[1], header.criterion[2]};
        tree.structure_.height = header.height;
        std::size_t expected_size = sizeof(header);
        TreeStorage::arrays(tree, header,
                            [&](const auto& array, std::uint64_t count) { expected_size += count * sizeof(array[0]); });
        if (bytes.size() != expected_size) return damaged("cut short, or too long");
        std::size_t at = sizeof(header);
        TreeStorage::arrays(tree, header, [&](auto& array, std::uint64_t count) {
            array.resize(count);
            if (count > 0) std::memcpy(static_cast<void*>(array.data()), bytes.data() + at, count * sizeof(array[0]));
            at += count * sizeof(array[0]);
        });
        clear_marks(tree.structure_);
        tree.find_detached();
        if (auto valid = measure::validate(tree.criterion_); !valid) return tl::unexpected(valid.error());
        if (auto valid = tree.validate(trust); !valid)
            return fail(ErrorCode::parse, valid.error().item, "stored " + valid.error().message);
        return tree;
    });
}

}  // namespace crofton::boxtree
