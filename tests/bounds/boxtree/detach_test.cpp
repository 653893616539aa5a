// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <error_of.hpp>
#include <oracle/random_boxes.hpp>
#include <oracle/tree_contents.hpp>
#include <set>
#include <vector>

using namespace crofton;
using boxtree::BoxTree;
using boxtree::ItemId;
using oracle::holds_all;

namespace {

// A box that validate(Obb) refuses.
Obb refused(const Obb& box) {
    Obb result = box;
    result.half_extents.x = -box.half_extents.x;
    return result;
}

}  // namespace

TEST_SUITE("boxtree/detach") {
    TEST_CASE(
        "only what rests can be detached or moved, only what is detached can be attached, and a bad box changes "
        "nothing") {
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 1);
        const std::vector<ItemId> unknown{100}, detached{7, 9, 7};
        CHECK(error_of(BoxTree::build(crowd.boxes, {.detached = unknown})).item == 100);
        BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers, {.detached = detached});
        CHECK(tree.item_count() == 98);
        CHECK(tree.structure().slot_of(7) == boxtree::kNone);
        CHECK(error_of(tree.detach(7)).item == 7);
        CHECK(error_of(tree.detach(100)).item == 100);
        CHECK(error_of(tree.move(7, Obb{})).item == 7);
        CHECK(error_of(tree.attach(8, Obb{})).item == 8);
        CHECK(error_of(tree.attach(5000, Obb{})).item == 5000);
        const Vector<std::byte> before = tree.serialise();
        Obb bad;
        bad.center.x = std::nan("");
        CHECK(error_of(tree.attach(7, bad)).item == 7);
        CHECK(tree.serialise() == before);
        CHECK(tree.is_detached(7));
        CHECK(tree.remove(9).has_value());
        CHECK(!tree.is_detached(9));
        CHECK(!tree.attach(9, Obb{}).has_value());
        CHECK(*tree.insert(Obb{}) == 9);
        CHECK(*tree.insert(Obb{}) == 100);  // 7 keeps its id
        CHECK(tree.attach(7, Obb{}).has_value());
        CHECK(tree.boxes()[7].half_extents == glm::vec3(0.0f));
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE("a box kept for an item in no leaf is returned by boxes(), may be refused, and changes nothing") {
        const oracle::Crowd crowd = oracle::random_crowd(300, 0.0, 2);
        BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers);
        REQUIRE(tree.detach(7).has_value());
        REQUIRE(tree.remove(9).has_value());
        const Obb& kept = crowd.boxes[50];
        tree.keep_box(7, kept);
        tree.keep_box(9, refused(kept));
        CHECK(tree.boxes()[7].center == kept.center);
        CHECK(tree.boxes()[9].half_extents.x < 0.0f);
        CHECK(tree.item_count() == 298);
        CHECK(tree.is_detached(7));
        tree.refit();
        while (!tree.rebuild_step(1000)) {
        }
        CHECK(tree.boxes()[7].center == kept.center);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
        CHECK(BoxTree::deserialise(tree.serialise()).has_value());
        CHECK(tree.attach(7, crowd.boxes[7]).has_value());
        CHECK(*tree.insert(crowd.boxes[9]) == 9);
        CHECK(tree.boxes()[9].center == crowd.boxes[9].center);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE(
        "a large tree built with items detached holds the others, and all once they are attached and it is rebuilt") {
        const oracle::Crowd crowd = oracle::random_crowd(40000, 0.0, 5);
        std::vector<ItemId> detached;
        for (ItemId i = 3; i < 40000; i += 8) detached.push_back(i);
        BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers, {.detached = detached});
        CHECK(tree.item_count() == 35000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
        bool done = false;
        for (std::size_t i = 0; i < detached.size() || !done; ++i) {
            if (i < detached.size()) REQUIRE(tree.attach(detached[i], crowd.boxes[detached[i]]).has_value());
            tree.refit();
            done = tree.rebuild_step(1000);
        }
        CHECK(tree.item_count() == 40000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE("a tree whose items are all detached is empty, and fills again") {
        const oracle::Crowd crowd = oracle::random_crowd(1000, 0.0, 2);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        for (ItemId i = 0; i < 1000; ++i) REQUIRE(tree.detach(i).has_value());
        tree.refit();
        CHECK(tree.item_count() == 0);
        CHECK(tree.validate().has_value());
        CHECK(!tree.rebuild_step(1000));
        for (ItemId i = 0; i < 1000; ++i) REQUIRE(tree.attach(i, crowd.boxes[i]).has_value());
        CHECK(tree.item_count() == 1000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE("an item inserted as detached has an id and layers, and is in no leaf until it is attached") {
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 5);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        REQUIRE(tree.remove(17).has_value());
        CHECK(tree.insert_detached(4u).value() == 17);
        CHECK(tree.insert_detached(8u).value() == 100);
        CHECK(tree.item_count() == 99);
        CHECK(tree.is_detached(100));
        CHECK(tree.structure().slot_of(100) == boxtree::kNone);
        CHECK((tree.structure().items().detached_layers() & ~12u) == 0);
        tree.refit();
        CHECK(tree.validate().has_value());
        REQUIRE(tree.attach(100, crowd.boxes[3]).has_value());
        CHECK(tree.validate().has_value());
        CHECK(tree.structure().slot_of(100) != boxtree::kNone);
        CHECK(tree.layer_masks()[100] == 8u);
    }

    TEST_CASE(
        "detaching and attaching amid other changes and background rebuilds leaves a valid tree, stored and read too") {
        oracle::NearMisses random(3);
        for (const std::size_t budget : {0u, 50u, 5000u}) {
            const oracle::Crowd crowd = oracle::random_crowd(1500, 0.0, 4);
            BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers);
            std::set<ItemId> detached;
            for (int frame = 0; frame < 300; ++frame) {
                for (int change = 0; change < 20; ++change) {
                    const ItemId item = random.index(static_cast<unsigned>(tree.boxes().size()));
                    const Obb box = oracle::random_box(random, glm::dvec3(frame), 40.0);
                    const bool rests = tree.structure().slot_of(item) != boxtree::kNone;
                    switch (random.index(7)) {
                        case 0:
                            REQUIRE(tree.insert(box, 1u << random.index(8)).has_value());
                            break;
                        case 5:
                            detached.insert(tree.insert_detached(1u << random.index(8)).value());
                            tree.keep_box(*detached.rbegin(), refused(box));
                            break;
                        case 1:
                            CHECK(tree.remove(item).has_value() == (rests || detached.erase(item) > 0));
                            tree.keep_box(item, refused(box));
                            break;
                        case 2:
                            CHECK(tree.set_layer_mask(item, 1u << random.index(8)).has_value() ==
                                  (rests || detached.contains(item)));
                            break;
                        case 3:
                            CHECK(tree.detach(item).has_value() == rests);
                            if (rests) detached.insert(item);
                            if (rests) tree.keep_box(item, random.index(2) ? box : refused(box));
                            break;
                        case 4:
                            CHECK(tree.attach(item, box).has_value() == (detached.erase(item) > 0));
                            break;
                        default:
                            CHECK(tree.move(item, box).has_value() == rests);
                    }
                }
                tree.refit();
                if (budget > 0) (void)tree.rebuild_step(budget);
                if (frame % 20 != 0) continue;
                const auto valid = tree.validate();
                INFO((valid ? std::string() : valid.error().message));
                REQUIRE(valid.has_value());
                REQUIRE(holds_all(tree));
                const Vector<std::byte> bytes = tree.serialise();
                const BoxTree back = *BoxTree::deserialise(bytes);
                REQUIRE(back.serialise() == bytes);
                for (ItemId i = 0; i < tree.boxes().size(); ++i) {
                    REQUIRE(tree.is_detached(i) == detached.contains(i));
                    REQUIRE(back.is_detached(i) == detached.contains(i));
                }
            }
            CHECK(!detached.empty());
        }
    }

    TEST_CASE("boxes of items that were reserved for stay where they are, and the tree holds the same") {
        oracle::NearMisses random(53);
        BoxTree tree = *BoxTree::build({}), plain = *BoxTree::build({});
        CHECK(error_of(tree.reserve((std::size_t{1} << 30) + 1)).code == ErrorCode::out_of_range);
        REQUIRE(tree.reserve(5000).has_value());
        REQUIRE(tree.reserve(10).has_value());
        const Obb* const boxes = tree.boxes().data();
        for (int i = 0; i < 5000; ++i) {
            const Obb box = oracle::random_box(random, {}, 50.0);
            REQUIRE(tree.insert(box).has_value());
            REQUIRE(plain.insert(box).has_value());
            (void)tree.rebuild_step(500);
            (void)plain.rebuild_step(500);
        }
        CHECK(tree.boxes().data() == boxes);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
        CHECK(tree.serialise() == plain.serialise());
    }
}
