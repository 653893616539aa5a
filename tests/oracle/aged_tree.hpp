// SPDX-License-Identifier: MIT
// A tree that has lived: inserted into, removed from, moved, detached, attached and rebuilt in any order, with a plain
// list of what it must hold beside it. What queries meet in a game is such a tree, not a fresh one.
#pragma once
#include <doctest/doctest.h>
#include <crofton/boxtree/box_tree.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

namespace crofton::oracle {

struct AgedTree {
    enum class Place : std::uint8_t { gone, in_tree, detached };

    boxtree::BoxTree tree;
    std::vector<Obb> boxes;  // by item
    std::vector<std::uint32_t> layers;
    std::vector<Place> places;
    double spread;

    explicit AgedTree(const Crowd& crowd, double spread_of_new = 40.0,
                      boxtree::Orientation orientation = boxtree::Orientation::aligned)
        : tree(*boxtree::BoxTree::build(crowd.boxes, crowd.layers, {.orientation = orientation})),
          boxes(crowd.boxes),
          layers(crowd.layers),
          places(crowd.boxes.size(), Place::in_tree),
          spread(spread_of_new) {}

    enum class Sizes : std::uint8_t { usual, any } sizes = Sizes::usual;  // of new boxes

    [[nodiscard]] bool holds(std::size_t item) const { return places[item] == Place::in_tree; }

    // 0 for items that are in no leaf.
    [[nodiscard]] std::vector<std::uint32_t> layers_in_tree() const {
        std::vector<std::uint32_t> result = layers;
        for (std::size_t i = 0; i < result.size(); ++i)
            if (!holds(i)) result[i] = 0;
        return result;
    }

    // One in ten is a point, enormous, tiny or far away where the sizes may be any.
    Obb new_box(NearMisses& random, const glm::dvec3& middle) const {
        Obb box = random_box(random, middle, spread);
        if (sizes == Sizes::usual) return box;
        const unsigned kind = random.index(40);
        const float factors[] = {0.0f, 1e20f, 1e-38f};
        if (kind < 3) box.half_extents *= factors[kind];
        if (kind == 3) box.center *= 1e18;
        return box;
    }

    void insert(NearMisses& random, const glm::dvec3& middle) {
        const Obb box = new_box(random, middle);
        const std::uint32_t mask = 1u << random.index(4) | 1u << random.index(4);
        const auto item = tree.insert(box, mask);
        REQUIRE(item.has_value());
        boxes.resize(std::max<std::size_t>(boxes.size(), *item + 1));
        layers.resize(boxes.size());
        places.resize(boxes.size(), Place::gone);
        CHECK(places[*item] == Place::gone);
        boxes[*item] = box;
        layers[*item] = mask;
        places[*item] = Place::in_tree;
    }

    // `changes` of all kinds; bounds are tight again after them.
    void live(NearMisses& random, std::size_t changes, const glm::dvec3& middle = glm::dvec3(0.0)) {
        for (std::size_t change = 0; change < changes; ++change) {
            const unsigned kind = random.index(8);
            if (boxes.empty() || kind < 2) {
                insert(random, middle);
                continue;
            }
            const boxtree::ItemId item = random.index(static_cast<unsigned>(boxes.size()));
            if (places[item] == Place::gone) continue;
            const Obb box = new_box(random, middle);
            if (kind == 2) {
                REQUIRE(tree.remove(item).has_value());
                places[item] = Place::gone;
            } else if (kind == 3) {
                layers[item] = 1u << random.index(4);
                REQUIRE(tree.set_layer_mask(item, layers[item]).has_value());
            } else if (places[item] == Place::detached) {
                REQUIRE(tree.attach(item, box).has_value());
                boxes[item] = box;
                places[item] = Place::in_tree;
            } else if (kind == 4) {
                REQUIRE(tree.detach(item).has_value());
                places[item] = Place::detached;
            } else {
                REQUIRE(tree.move(item, box).has_value());
                boxes[item] = box;
            }
        }
        tree.refit();
        if (random.index(3) == 0) (void)tree.rebuild_step(changes);
    }
};

// Trees of every age: fresh, grown from nothing by insertion alone, mixed, and nearly emptied.
template <class Visit>
void for_each_age(std::uint64_t seed, std::size_t count, Visit visit) {
    NearMisses random(seed);
    {
        AgedTree grown(Crowd{});
        for (std::size_t i = 0; i < count; ++i) grown.insert(random, glm::dvec3(0.0));
        visit(grown);
    }
    AgedTree mixed(random_crowd(count, 0.0, seed));
    for (int age = 0; age < 4; ++age) {
        visit(mixed);
        for (int frame = 0; frame < 10; ++frame) mixed.live(random, count / 10);
    }
    for (boxtree::ItemId item = 0; item < mixed.boxes.size(); ++item)
        if (item % 16 != 3 && mixed.places[item] != AgedTree::Place::gone) {
            REQUIRE(mixed.tree.remove(item).has_value());
            mixed.places[item] = AgedTree::Place::gone;
        }
    visit(mixed);  // before its bounds are tight
    mixed.tree.refit();
    visit(mixed);
}

}  // namespace crofton::oracle
