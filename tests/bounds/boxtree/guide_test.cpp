// SPDX-License-Identifier: MIT
// The example of docs/boxtree.md, compiled and run.
#include <doctest/doctest.h>

#include <crofton/boxtree/box_tree.hpp>
#include <cstdio>
#include <limits>
#include <optional>
#include <vector>

namespace {

using crofton::Obb;
using crofton::boxtree::ItemId;

constexpr std::uint32_t kVehicles = 4;

int report(const crofton::Error& error) {
    std::printf("%s\n", error.message.c_str());
    return static_cast<int>(error.item) + 1;
}

Obb box_at(double x) {
    return {.center = {x, 0.0, 0.0}, .half_extents = glm::vec3(0.5f)};
}

int change_tree(const std::vector<Obb>& boxes, const std::vector<ItemId>& moved_items,
                const std::vector<Obb>& moved_boxes, ItemId gone, std::optional<crofton::boxtree::BoxTree>& result) {
    const Obb new_box = box_at(-7.0);
    // clang-format off
    using namespace crofton;

    Result<boxtree::BoxTree> tree = boxtree::BoxTree::build(boxes);  // item i is boxes[i]
    if (!tree) return report(tree.error());                          // which box is bad, and why

    // Each frame: pass the changes, then refit once.
    if (const auto moved = tree->move(moved_items, moved_boxes); !moved) return report(moved.error());
    const Result<boxtree::ItemId> added = tree->insert(new_box, kVehicles);
    if (!added) return report(added.error());
    if (const auto removed = tree->remove(gone); !removed) return report(removed.error());
    tree->refit();
    // clang-format on
    CHECK(tree->boxes()[*added].center.x == -7.0);
    CHECK(tree->layer_masks()[*added] == kVehicles);
    result = std::move(*tree);
    return 0;
}

}  // namespace

TEST_SUITE("boxtree/guide") {
    TEST_CASE("the example of the guide changes a tree, which stays valid") {
        std::vector<Obb> boxes;
        for (int i = 0; i < 500; ++i) boxes.push_back(box_at(2.0 * i));
        std::optional<crofton::boxtree::BoxTree> tree;
        REQUIRE(change_tree(boxes, {3, 400}, {box_at(-3.0), box_at(2000.0)}, 77, tree) == 0);
        CHECK(tree->item_count() == 500);
        CHECK(tree->validate());
        CHECK(tree->boxes()[400].center.x == 2000.0);
    }

    TEST_CASE("the example of the guide names the bad box and the item that is not there") {
        std::vector<Obb> boxes(20, box_at(0.0));
        std::optional<crofton::boxtree::BoxTree> tree;
        CHECK(change_tree(boxes, {}, {}, 99, tree) == 100);
        boxes[7].half_extents.x = std::numeric_limits<float>::quiet_NaN();
        CHECK(change_tree(boxes, {}, {}, 0, tree) == 8);
    }
}
