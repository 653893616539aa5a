// SPDX-License-Identifier: MIT
// Stored trees with one fault each, refused for that fault. The layout is written down here a second time.
#include <doctest/doctest.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/radius_range.hpp>
#include <crofton/boxtree/structure.hpp>
#include <cstring>
#include <error_of.hpp>
#include <oracle/random_boxes.hpp>
#include <string_view>
#include <thread>

#include "../../counting_memory.hpp"
#include "../../ranges.hpp"

using namespace crofton;
using boxtree::BoxTree;
using boxtree::ItemId;
using boxtree::Leaf;
using boxtree::LeafRange;
using boxtree::Node;
using boxtree::NodeRadii;
using boxtree::RadiusRange;

namespace {

struct StoredHeader {
    char magic[8];
    std::uint32_t version, byte_order, node_bytes, leaf_bytes, box_bytes, height, orientation, unused;
    std::uint64_t boxes, free_items, axes, nodes, leaves;
    double criterion[3];
};
static_assert(sizeof(StoredHeader) == 104);

// The parts of a stored tree, to be changed and put together again.
struct Stored {
    StoredHeader header;
    std::vector<Obb> boxes;
    std::vector<std::uint32_t> layer_masks;
    std::vector<ItemId> free_items;
    std::vector<boxtree::Axes> axes;
    std::vector<Node> nodes;
    std::vector<LeafRange> ranges;
    std::vector<NodeRadii> node_radii;
    std::vector<Leaf> leaves;
    std::vector<std::uint8_t> leaf_counts;
    std::vector<RadiusRange> leaf_radii;
    std::vector<ItemId> slot_items;
    std::vector<std::uint32_t> item_slots;

    explicit Stored(const Vector<std::byte>& bytes) {
        std::size_t at = 0;
        const auto take = [&](void* to, std::size_t size) {
            std::memcpy(to, bytes.data() + at, size);
            at += size;
        };
        take(&header, sizeof header);
        const auto take_all = [&](auto& array, std::size_t count) {
            array.resize(count);
            take(static_cast<void*>(array.data()), count * sizeof(array[0]));
        };
        take_all(boxes, header.boxes);
        take_all(layer_masks, header.boxes);
        take_all(free_items, header.free_items);
        take_all(axes, header.axes);
        take_all(nodes, header.nodes);
        take_all(ranges, header.nodes);
        take_all(node_radii, header.nodes);
        take_all(leaves, header.leaves);
        take_all(leaf_counts, header.leaves);
        take_all(leaf_radii, header.leaves);
        take_all(slot_items, header.leaves * boxtree::kWidth);
        take_all(item_slots, header.boxes);
        REQUIRE(at == bytes.size());
    }

    [[nodiscard]] std::vector<std::byte> bytes() {
        header.boxes = boxes.size();
        header.free_items = free_items.size();
        header.axes = axes.size();
        header.nodes = nodes.size();
        header.leaves = leaves.size();
        std::vector<std::byte> result;
        const auto put = [&](const void* from, std::size_t size) {
            const auto* first = static_cast<const std::byte*>(from);
            result.insert(result.end(), first, first + size);
        };
        put(&header, sizeof header);
        const auto put_all = [&](const auto& array) { put(array.data(), array.size() * sizeof(array[0])); };
        put_all(boxes);
        put_all(layer_masks);
        put_all(free_items);
        put_all(axes);
        put_all(nodes);
        put_all(ranges);
        put_all(node_radii);
        put_all(leaves);
        put_all(leaf_counts);
        put_all(leaf_radii);
        put_all(slot_items);
        put_all(item_slots);
        return result;
    }
};

// Three levels; item 5 is removed.
Stored good_tree() {
    const oracle::Crowd crowd = oracle::random_crowd(700, 0.0, 41);
    BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers);
    REQUIRE(tree.remove(5).has_value());
    tree.refit();
    REQUIRE(tree.structure().height() >= 2);
    return Stored(tree.serialise());
}

void check_refused(Stored& stored, std::string_view why) {
    const auto tree = BoxTree::deserialise(stored.bytes());
    REQUIRE(!tree.has_value());
    INFO(tree.error().message);
    CHECK(error_of(tree).message.find(why) != std::string::npos);
}

template <class Change>
void check_refused_after(Change change, std::string_view why) {
    Stored stored = good_tree();
    change(stored);
    check_refused(stored, why);
}

}  // namespace

TEST_SUITE("boxtree/stored") {
    TEST_CASE("axes that are none, and nodes that name none, are refused") {
        check_refused_after([](Stored& s) { s.axes.clear(); }, "the first axes are not the world's");
        check_refused_after([](Stored& s) { std::swap(s.axes[0].rows[0], s.axes[0].rows[1]); }, "not the world's");
        check_refused_after([](Stored& s) { s.nodes[0].axes = 1; }, "a node's axes do not exist");
        const auto skewed = [](double by, double rounding) {
            return [=](Stored& s) {
                s.axes.push_back({{{0.6, 0.8, by}, {-0.8, 0.6, 0.0}, {0.0, 0.0, 1.0}}, rounding});
            };
        };
        check_refused_after(skewed(1e-9, 0x1p-44), "axes are not orthonormal");
        check_refused_after(skewed(0.0, 0.0), "axes are not orthonormal");
        check_refused_after(skewed(std::nan(""), 0x1p-44), "axes are not orthonormal");
        Stored sound = good_tree();
        skewed(0.0, 0x1p-44)(sound);
        CHECK(BoxTree::deserialise(sound.bytes()).has_value());
    }

    TEST_CASE("a tree that is stored and read again is the same tree") {
        Stored stored = good_tree();
        const auto back = BoxTree::deserialise(stored.bytes());
        REQUIRE(back.has_value());
        const auto bytes = back->serialise();
        CHECK(test::ranges::equal(bytes, stored.bytes()));
    }

    TEST_CASE("reading a stored tree stops at whichever question is answered yes, and leaves no memory") {
        const Vector<std::byte> bytes = BoxTree::build(oracle::random_crowd(60000, 0.0, 91).boxes).value().serialise();
        struct Asked {
            int count = 0, stop_at = 0;
            double share = 0.0;
        };
        const auto read = [&](Asked& asked) {
            return BoxTree::deserialise(
                bytes, boxtree::Trust::contents,
                [](void* user, double share) {
                    Asked& its = *static_cast<Asked*>(user);
                    std::this_thread::sleep_for(std::chrono::milliseconds(6));  // it is asked again after 5
                    CHECK(share >= its.share);
                    its.share = share;
                    return ++its.count == its.stop_at;
                },
                &asked);
        };
        Asked all;
        CHECK(test::ranges::equal(read(all).value().serialise(), bytes));
        CHECK(all.count > 20);
        CHECK(all.share <= 1.0);
        for (int stop_at = 1; stop_at <= all.count; stop_at += 1 + all.count / 12) {
            testing::CountingMemory memory;
            {
                Asked asked{.stop_at = stop_at};
                CHECK(error_of(read(asked)).code == ErrorCode::cancelled);
                CHECK(asked.count == stop_at);
            }
            CHECK(memory.bytes_in_use() == 0);
        }
    }

    TEST_CASE("bytes too many or too few, other versions, byte orders and element sizes are refused") {
        Stored stored = good_tree();
        std::vector<std::byte> bytes = stored.bytes();
        for (const std::size_t size : {bytes.size() - 1, bytes.size() + 1, bytes.size() + 64, std::size_t{103}}) {
            std::vector<std::byte> other = bytes;
            other.resize(size);
            const auto tree = BoxTree::deserialise(other);
            REQUIRE(!tree.has_value());
            CHECK(error_of(tree).code == ErrorCode::parse);
        }
        const char* const why = "another version";
        check_refused_after([](Stored& s) { ++s.header.version; }, why);
        check_refused_after([](Stored& s) { s.header.byte_order = 0x04030201; }, why);
        check_refused_after([](Stored& s) { s.header.node_bytes += 64; }, why);
        check_refused_after([](Stored& s) { s.header.leaf_bytes -= 64; }, why);
        check_refused_after([](Stored& s) { s.header.box_bytes += 8; }, why);
        check_refused_after([](Stored& s) { s.header.magic[7] = 'E'; }, "not a box tree");
        check_refused_after([](Stored& s) { s.header.height = 0; }, "sizes out of range");
        check_refused_after([](Stored& s) { s.header.orientation = 3; }, "sizes out of range");
        check_refused_after([](Stored& s) { s.header.height = 65; }, "sizes out of range");
        check_refused_after([](Stored& s) { s.header.criterion[1] = -1.0; }, "criterion");
    }

    TEST_CASE("links that lead nowhere, twice to one place, round or too deep are refused") {
        check_refused_after([](Stored& s) { s.nodes[0].child[0] = 10000; }, "does not exist");
        check_refused_after([](Stored& s) { s.nodes[0].child[1] = s.nodes[0].child[0]; }, "know its parent");
        check_refused_after([](Stored& s) { s.nodes[s.nodes[0].child[0]].lane_in_parent = 9; }, "know its parent");
        check_refused_after([](Stored& s) { s.nodes[0].child[0] = 0; }, "know its parent");
        check_refused_after([](Stored& s) { s.nodes[0].parent = 1; }, "in a cycle");
        check_refused_after([](Stored& s) { s.header.height = 1; }, "too deep");
        check_refused_after([](Stored& s) { s.nodes[0].count = 17; }, "more than 16");
        check_refused_after([](Stored& s) { s.leaves[0].count = 17; }, "more than 16");
        const auto add_leaf = [](Stored& s) {
            s.leaves.push_back(s.leaves[0]);
            s.leaves.back().count = 0;
            s.leaf_counts.push_back(0);
            s.leaf_radii.push_back(boxtree::kNoRadii);
            s.slot_items.resize(s.slot_items.size() + boxtree::kWidth, boxtree::kNone);
        };
        check_refused_after(add_leaf, "below no node");
        const auto add_root = [](Stored& s) {
            Node root = s.nodes[0];
            root.count = 0;
            root.only_leaves = 1;
            root.layers_every = ~std::uint32_t{0};
            s.nodes.push_back(root);
            s.ranges.push_back({});
            s.node_radii.push_back({});
        };
        check_refused_after(add_root, "not below the root");
    }

    TEST_CASE("nodes that are wrong about what lies below them are refused") {
        const auto is_wrong = [](auto change, std::string_view why) {
            check_refused_after([&](Stored& s) { change(s.nodes[s.nodes[0].child[0]], s); }, why);
        };
        for (int side = 0; side < 2; ++side)
            for (int axis = 0; axis < 3; ++axis)
                is_wrong(
                    [&](Node& node, Stored&) {
                        // The middle of lane 0 moves away from one side by half of its length.
                        auto& middle = axis == 2 ? node.middle_half_z[0] : node.middle_xy[0];
                        const int shift = axis == 1 ? 16 : 0;
                        const auto half_row = axis == 2 ? node.middle_half_z[0] : node.half_xy[0];
                        const int half = static_cast<std::int16_t>(half_row >> (axis == 0 ? 0 : 16));
                        const int moved = static_cast<std::int16_t>(middle >> shift) + (side ? half : -half) / 2;
                        middle &= ~(std::uint32_t{0xffff} << shift);
                        middle |= (static_cast<std::uint32_t>(moved) & 0xffffu) << shift;
                    },
                    "does not contain");
        is_wrong([](Node& node, Stored&) { node.layers_any[0] = 0; }, "layers");
        is_wrong([](Node& node, Stored&) { node.layers_all[0] ^= 1u << 30; }, "layers");
        is_wrong([](Node& node, Stored&) { node.layers_every ^= 1u << 30; }, "frame");
        is_wrong([](Node& node, Stored&) { node.rounding *= 0.5f; }, "frame");
        is_wrong([](Node& node, Stored&) { node.only_leaves ^= 1; }, "children's kind");
        check_refused_after([](Stored& s) { s.nodes[0].only_leaves = 1; }, "children's kind");
        // The largest radius a step of its 16 bits smaller, the least one larger.
        for (const RadiusRange step : {RadiusRange{0u - 0x10000u}, RadiusRange{1}}) {
            check_refused_after([=](Stored& s) { s.node_radii[0].below[0] += step; }, "range of radii does not");
            check_refused_after([=](Stored& s) { s.node_radii.back().below[0] += step; }, "range of radii does not");
            check_refused_after([=](Stored& s) { s.leaf_radii[0] += step; }, "leaf's range of radii");
        }
        check_refused_after([](Stored& s) { s.ranges[0].count = 10000; }, "leaves do not exist");
        check_refused_after([](Stored& s) { s.ranges[0].first = 1; }, "leaves do not exist");
        // Item 5's leaf has a gap, so the root's leaves have none that they could promise.
        check_refused_after([](Stored& s) { s.ranges[0].items = 699; }, "about its items");
        check_refused_after([](Stored& s) { s.ranges[0].items = 700; }, "about its items");
    }

    TEST_CASE("nodes in a row of single children are refused") {
        check_refused_after(
            [](Stored& s) {
                const auto between = static_cast<boxtree::NodeId>(s.nodes.size());
                const std::uint32_t below = s.nodes[0].child[0];
                Node node = s.nodes[0];
                node.count = 1;
                node.parent = node.lane_in_parent = 0;
                node.layers_every = node.layers_all[0];
                for (unsigned lane = 1; lane < boxtree::kWidth; ++lane) {
                    node.half_xy[lane] = boxtree::pair_of(-32767, -32767);
                    node.middle_half_z[lane] = boxtree::pair_of(0, -32767);
                }
                s.nodes.push_back(node);
                s.ranges.push_back(s.ranges[below]);
                s.node_radii.push_back(s.node_radii[0]);
                s.nodes[0].child[0] = s.nodes[below].parent = between;
                s.nodes[below].lane_in_parent = 0;
                ++s.header.height;
            },
            "fewer than two children");
    }

    TEST_CASE("nodes that promise other leaves than those below them are refused") {
        // Leaves that exist and hold as many items: a query that accepts the whole node would list these.
        const auto is_refused = [](auto change) {
            for (const bool of_root : {true, false})
                check_refused_after([&](Stored& s) { change(s.ranges[of_root ? 0 : s.nodes[0].child[0]]); },
                                    "promises other leaves");
        };
        is_refused([](LeafRange& range) { range = {range.first, range.count - 1, 0}; });
        is_refused([](LeafRange& range) { range = {range.first + 1, range.count - 1, 0}; });
        is_refused([](LeafRange& range) { range = {range.first, 1, 0}; });
        check_refused_after([](Stored& s) { std::swap(s.ranges[s.nodes[0].child[0]], s.ranges[s.nodes[0].child[1]]); },
                            "promises other leaves");
        // If one child has no promise, its parents can have none.
        check_refused_after([](Stored& s) { s.ranges[s.nodes[0].child[0]] = {}; }, "promises other leaves");
    }

    TEST_CASE("leaves that lose items, name others or show other boxes are refused") {
        check_refused_after(
            [](Stored& s) {
                for (LeafRange& range : s.ranges) range.items = 0;
                --s.leaf_counts[0];
            },
            "count is wrong");
        check_refused_after([](Stored& s) { s.slot_items[0] = boxtree::kNone; }, "do not match its count");
        check_refused_after([](Stored& s) { std::swap(s.slot_items[0], s.slot_items[1]); }, "slot says");
        check_refused_after([](Stored& s) { s.slot_items[0] = 100000; }, "slot says");
        check_refused_after([](Stored& s) { s.slot_items[0] = 700; }, "slot says");  // the first that there is not
        check_refused_after([](Stored& s) { s.boxes[s.slot_items[0]].center.x += 0.5; }, "match its box");
        check_refused_after([](Stored& s) { s.layer_masks[s.slot_items[0]] ^= 1u << 30; }, "match its box");
        check_refused_after([](Stored& s) { s.boxes[s.slot_items[0]].half_extents.x = -1.0f; }, "");
    }

    TEST_CASE("free lists that name what is in use, what does not exist, or one id twice are refused by name") {
        const auto refused_item = [](ItemId id) {
            Stored stored = good_tree();
            REQUIRE(stored.free_items == std::vector<ItemId>{5});
            stored.free_items[0] = id;
            const auto tree = BoxTree::deserialise(stored.bytes());
            REQUIRE(!tree.has_value());
            CHECK(error_of(tree).message.find("free id") != std::string::npos);
            return tree.error().item;
        };
        CHECK(refused_item(7) == 7);
        CHECK(refused_item(700) == 700);
        CHECK(refused_item(boxtree::kNone) == boxtree::kNone);
        check_refused_after([](Stored& s) { s.free_items = {5, 5}; }, "hold all items");
        check_refused_after(
            [](Stored& s) {
                s.boxes.push_back(s.boxes[0]);
                s.layer_masks.push_back(0);
                s.item_slots.push_back(s.item_slots[0]);
            },
            "hold all items");
    }
}
