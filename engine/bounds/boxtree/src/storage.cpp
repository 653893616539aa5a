// SPDX-License-Identifier: MIT
// Trees as byte strings.
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/rebuilder.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/recovery.hpp>
#include <crofton/core/stop_signal.hpp>
#include <cstring>

namespace crofton::boxtree {
namespace {

struct Header {
    char magic[8] = {'c', 'r', 'o', 'f', 't', 'r', 'e', 'e'};
    std::uint32_t version = 6;
    std::uint32_t byte_order = 0x01020304;
    std::uint32_t node_bytes = sizeof(Node), leaf_bytes = sizeof(Leaf), box_bytes = sizeof(Obb);
    std::uint32_t height = 0, orientation = 0, unused = 0;
    std::uint64_t boxes = 0, free_items = 0, axes = 0, nodes = 0, leaves = 0;
    double criterion[3] = {};
};
static_assert(sizeof(Header) == 104);

// Marks as detached the items that are in no leaf though their ids are in use.
void find_detached(Items& items, const Structure& structure) {
    Vector<std::uint64_t> known((items.size() + 63) / 64, 0);
    const auto mark = [&](ItemId item) { known[item / 64] |= std::uint64_t{1} << item % 64; };
    for (const ItemId item : items.free_ids())
        if (item < items.size()) mark(item);
    for (ItemId item = 0; item < items.size(); ++item)
        if (!structure.contains(item) && !(known[item / 64] >> item % 64 & 1)) items.set_detached(item, true);
}

template <class T>
T* data_of(Vector<T>& array) {
    return array.data();
}
template <class T>
T* data_of(GrowingVector<T>& array) {
    return array.edit_all();
}

}  // namespace

// Lists the stored members, in order. Writing and reading share this list.
struct TreeStorage {
    template <class ItemsOrConst, class StructureOrConst, class Visit>
    static void arrays(ItemsOrConst& items, StructureOrConst& structure, const Header& h, Visit&& visit) {
        visit(items.boxes_, h.boxes);
        visit(items.layer_masks_, h.boxes);
        visit(items.free_ids_, h.free_items);
        visit(structure.axes_, h.axes);
        visit(structure.nodes_, h.nodes);
        visit(structure.ranges_, h.nodes);
        visit(structure.node_radii_, h.nodes);
        visit(structure.leaves_, h.leaves);
        visit(structure.leaf_counts_, h.leaves);
        visit(structure.leaf_radii_, h.leaves);
        visit(structure.slot_items_, h.leaves * kWidth);
        visit(structure.item_slots_, h.boxes);
    }
    static void set_height(Structure& structure, unsigned height) { structure.height_ = height; }
};

Vector<std::byte> BoxTree::serialise() const {
    const Structure& structure = *structure_;
    Header header;
    header.height = structure.height();
    header.boxes = items_->size();
    header.free_items = items_->free_ids().size();
    header.orientation = static_cast<std::uint32_t>(structure.orientation());
    header.axes = structure.axes().size();
    header.nodes = structure.nodes().size();
    header.leaves = structure.leaves().size();
    header.criterion[0] = structure.criterion().volume_weight;
    header.criterion[1] = structure.criterion().area_weight;
    header.criterion[2] = structure.criterion().mean_curvature_weight;
    Vector<std::byte> bytes;
    const auto append = [&](const void* data, std::size_t size) {
        const auto* first = static_cast<const std::byte*>(data);
        bytes.insert(bytes.end(), first, first + size);
    };
    append(&header, sizeof(header));
    TreeStorage::arrays(*items_, structure, header, [&](const auto& array, std::uint64_t) {
        append(array.data(), array.size() * sizeof(array[0]));
    });
    return bytes;
}

Result<BoxTree> BoxTree::deserialise(std::span<const std::byte> bytes, Trust trust, StopCallback should_stop,
                                     void* stop_user) {
    return detail::recover([&]() -> Result<BoxTree> {
        constexpr double kCopied = 0.5;  // of the time
        detail::PartOfStop copying{should_stop, stop_user, 0.0, kCopied};
        detail::PartOfStop checking{should_stop, stop_user, kCopied, 1.0};
        detail::StopSignal stop_copy(detail::PartOfStop::ask, &copying), stop_check(detail::PartOfStop::ask, &checking);
        const auto damaged = [](const char* why) {
            return fail(ErrorCode::parse, kNoItem, {"stored box tree: ", why});
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
            header.leaves > (1u << 30) || header.axes > (1u << 30) || header.orientation > 2 || header.height == 0 ||
            header.height > 64)
            return damaged("sizes out of range");
        const measure::Criterion criterion{header.criterion[0], header.criterion[1], header.criterion[2]};
        BoxTree tree(criterion, static_cast<Orientation>(header.orientation));
        Items& items = *tree.items_;
        Structure& structure = *tree.structure_;
        TreeStorage::set_height(structure, header.height);
        std::size_t expected_size = sizeof(header);
        TreeStorage::arrays(items, structure, header,
                            [&](const auto& array, std::uint64_t count) { expected_size += count * sizeof(array[0]); });
        if (bytes.size() != expected_size) return damaged("cut short, or too long");
        std::size_t at = sizeof(header);
        TreeStorage::arrays(items, structure, header, [&](auto& array, std::uint64_t count) {
            constexpr std::uint64_t kBetweenQuestions = 1 << 14;  // elements: some MB of new memory
            array.clear();
            array.reserve(count);
            for (std::uint64_t done = 0; done < count;) {
                if (stop_copy.is_raised(static_cast<double>(at) / static_cast<double>(bytes.size()))) return;
                const std::uint64_t piece = std::min(count - done, kBetweenQuestions), size = piece * sizeof(array[0]);
                array.resize(done + piece);
                std::memcpy(static_cast<void*>(data_of(array) + done), bytes.data() + at, size);
                done += piece;
                at += size;
            }
        });
        if (stop_copy.was_raised()) return detail::cancelled("box tree");
        structure.reset_marks();
        find_detached(items, structure);
        if (auto valid = measure::validate(criterion); !valid) return valid.error();
        if (auto valid = boxtree::validate(structure, trust, &stop_check); !valid)
            return stop_check.was_raised()
                       ? valid.error()
                       : fail(ErrorCode::parse, valid.error().item, {"stored ", valid.error().message});
        return tree;
    });
}

}  // namespace crofton::boxtree
