#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <oracle/random_boxes.hpp>
#include <oracle/tree_contents.hpp>
#include <set>
#include <vector>

using namespace crofton;
using boxtree::BoxTree;
using boxtree::ItemId;
using oracle::holds_all;

TEST_SUITE("boxtree/lift") {
    TEST_CASE("only what rests can be lifted or moved, only what is lifted settles, and a bad box settles nothing") {
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 1);
        const std::vector<ItemId> unknown{100}, lifted{7, 9, 7};
        CHECK(BoxTree::build(crowd.boxes, {.lifted = unknown}).error().item == 100);
        BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers, {.lifted = lifted});
        CHECK(tree.item_count() == 98);
        CHECK(tree.slot_of(7) == boxtree::kNone);
        CHECK(tree.lift(7).error().item == 7);
        CHECK(tree.lift(100).error().item == 100);
        CHECK(tree.move(7, Obb{}).error().item == 7);
        CHECK(tree.settle(8, Obb{}).error().item == 8);
        CHECK(tree.settle(5000, Obb{}).error().item == 5000);
        const Vector<std::byte> before = tree.serialise();
        Obb bad;
        bad.center.x = std::nan("");
        CHECK(tree.settle(7, bad).error().item == 7);
        CHECK(tree.serialise() == before);
        CHECK(tree.is_lifted(7));
        CHECK(tree.remove(9).has_value());
        CHECK(!tree.is_lifted(9));
        CHECK(!tree.settle(9, Obb{}).has_value());
        CHECK(*tree.insert(Obb{}) == 9);
        CHECK(*tree.insert(Obb{}) == 100);  // 7 keeps its id
        CHECK(tree.settle(7, Obb{}).has_value());
        CHECK(tree.boxes()[7].half_extents == glm::vec3(0.0f));
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE(
        "a large tree built with items lifted holds the others, and all once they have settled and it is rebuilt") {
        const oracle::Crowd crowd = oracle::random_crowd(40000, 0.0, 5);
        std::vector<ItemId> lifted;
        for (ItemId i = 3; i < 40000; i += 8) lifted.push_back(i);
        BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers, {.lifted = lifted});
        CHECK(tree.item_count() == 35000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
        bool done = false;
        for (std::size_t i = 0; i < lifted.size() || !done; ++i) {
            if (i < lifted.size()) REQUIRE(tree.settle(lifted[i], crowd.boxes[lifted[i]]).has_value());
            tree.refit();
            done = tree.maintain(1000);
        }
        CHECK(tree.item_count() == 40000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE("a tree of which all is lifted is empty, and fills again") {
        const oracle::Crowd crowd = oracle::random_crowd(1000, 0.0, 2);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        for (ItemId i = 0; i < 1000; ++i) REQUIRE(tree.lift(i).has_value());
        tree.refit();
        CHECK(tree.item_count() == 0);
        CHECK(tree.validate().has_value());
        CHECK(!tree.maintain(1000));
        for (ItemId i = 0; i < 1000; ++i) REQUIRE(tree.settle(i, crowd.boxes[i]).has_value());
        CHECK(tree.item_count() == 1000);
        CHECK(tree.validate().has_value());
        CHECK(holds_all(tree));
    }

    TEST_CASE("an item inserted as lifted has an id and layers, and is in no leaf until it settles") {
        const oracle::Crowd crowd = oracle::random_crowd(100, 0.0, 5);
        BoxTree tree = *BoxTree::build(crowd.boxes);
        REQUIRE(tree.remove(17).has_value());
        CHECK(tree.insert_lifted(4u).value() == 17);
        CHECK(tree.insert_lifted(8u).value() == 100);
        CHECK(tree.item_count() == 99);
        CHECK(tree.is_lifted(100));
        CHECK(tree.slot_of(100) == boxtree::kNone);
        CHECK((tree.lifted_layers() & ~12u) == 0);
        tree.refit();
        CHECK(tree.validate().has_value());
        REQUIRE(tree.settle(100, crowd.boxes[3]).has_value());
        CHECK(tree.validate().has_value());
        CHECK(tree.slot_of(100) != boxtree::kNone);
        CHECK(tree.layer_masks()[100] == 8u);
    }

    TEST_CASE(
        "lifting and settling amid other changes and background rebuilds leaves a valid tree, stored and read too") {
        oracle::NearMisses random(3);
        for (const std::size_t budget : {0u, 50u, 5000u}) {
            const oracle::Crowd crowd = oracle::random_crowd(1500, 0.0, 4);
            BoxTree tree = *BoxTree::build(crowd.boxes, crowd.layers);
            std::set<ItemId> lifted;
            for (int frame = 0; frame < 300; ++frame) {
                for (int change = 0; change < 20; ++change) {
                    const ItemId item = random.index(static_cast<unsigned>(tree.boxes().size()));
                    const Obb box = oracle::random_box(random, glm::dvec3(frame), 40.0);
                    const bool rests = tree.slot_of(item) != boxtree::kNone;
                    switch (random.index(7)) {
                        case 0:
                            REQUIRE(tree.insert(box, 1u << random.index(8)).has_value());
                            break;
                        case 5:
                            lifted.insert(tree.insert_lifted(1u << random.index(8)).value());
                            break;
                        case 1:
                            CHECK(tree.remove(item).has_value() == (rests || lifted.erase(item) > 0));
                            break;
                        case 2:
                            CHECK(tree.set_layer_mask(item, 1u << random.index(8)).has_value() ==
                                  (rests || lifted.contains(item)));
                            break;
                        case 3:
                            CHECK(tree.lift(item).has_value() == rests);
                            if (rests) lifted.insert(item);
                            break;
                        case 4:
                            CHECK(tree.settle(item, box).has_value() == (lifted.erase(item) > 0));
                            break;
                        default:
                            CHECK(tree.move(item, box).has_value() == rests);
                    }
                }
                tree.refit();
                if (budget > 0) (void)tree.maintain(budget);
                if (frame % 20 != 0) continue;
                const auto valid = tree.validate();
                INFO((valid ? std::string() : valid.error().message));
                REQUIRE(valid.has_value());
                REQUIRE(holds_all(tree));
                const Vector<std::byte> bytes = tree.serialise();
                const BoxTree back = *BoxTree::deserialise(bytes);
                REQUIRE(back.serialise() == bytes);
                for (ItemId i = 0; i < tree.boxes().size(); ++i) {
                    REQUIRE(tree.is_lifted(i) == lifted.contains(i));
                    REQUIRE(back.is_lifted(i) == lifted.contains(i));
                }
            }
            CHECK(!lifted.empty());
        }
    }
}
