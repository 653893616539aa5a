// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <crofton/sampling/sampling.hpp>
#include <crofton/study/binary_tree.hpp>
#include <error_of.hpp>
#include <oracle/random_boxes.hpp>
#include <vector>

#include "../../ranges.hpp"

using namespace crofton;
using namespace crofton::study;
using sampling::Random;

namespace {

std::vector<Obb> random_boxes(std::uint64_t seed, int n) {
    Random random(seed);
    std::vector<Obb> boxes;
    for (int i = 0; i < n; ++i) {
        Obb box;
        box.center = 50.0 * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
        box.axes = glm::mat3(sampling::rotation(random.point<3>()));
        box.half_extents =
            glm::vec3(glm::dvec3(random.uniform(0.01, 2.0), random.uniform(0.01, 0.3), random.uniform(0.01, 0.3)));
        boxes.push_back(box);
    }
    return boxes;
}

std::size_t depth_of(const BinaryTree& tree, const BinaryTree::Node* node) {
    std::size_t depth = 0;
    for (; node->parent != kNone; node = &tree.node(node->parent)) ++depth;
    return depth;
}

// Every node contains all boxes below it, links agree, every item is there once.
void check_structure(const BinaryTree& tree, const std::vector<Obb>& boxes, const std::vector<bool>& present) {
    std::vector<int> seen(boxes.size(), 0);
    std::size_t nodes = tree.visit([](const Obb&) { return Visit::descend; }, [&](ItemId i) { ++seen[i]; });
    std::size_t count = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        REQUIRE(seen[i] == (present[i] ? 1 : 0));
        CHECK(tree.holds(static_cast<ItemId>(i)) == present[i]);
        count += present[i];
    }
    CHECK(tree.item_count() == count);
    CHECK(nodes == (count == 0 ? 0 : 2 * count - 1));
    for (const bool half :
         {false, true}) {  // a query that everything meets finds all, with one test or with all of them
        std::size_t found = 0;
        tree.visit([&](const Obb&) { return half ? Visit::descend : Visit::take; }, [&](ItemId) { ++found; });
        CHECK(found == count);
    }
}

void check_containment(const BinaryTree& tree, const std::vector<Obb>& boxes, const std::vector<bool>& present) {
    for (ItemId i = 0; i < boxes.size(); ++i) {
        if (!present[i]) continue;
        for (std::uint32_t n = tree.leaf(i); n != kNone; n = tree.node(n).parent)
            for (const glm::dvec3& c : corners(boxes[i])) {
                // Rounded corners: a hair outside is rounding.
                const glm::dvec3 inward = c + 1e-9 * (boxes[i].center - c);
                REQUIRE(contains(tree.node(n).bound, inward));
            }
    }
}

// How far the box leaves the bound, whose centre is so near that the difference of centres is exact.
long double sticks_out(const Obb& box, const Obb& bound) {
    using Vector3 = glm::vec<3, long double>;
    const Vector3 apart(box.center - bound.center);
    long double most = 0.0L;
    for (int k = 0; k < 3; ++k) {
        const Vector3 normal = glm::cross(Vector3(bound.axes[(k + 1) % 3]), Vector3(bound.axes[(k + 2) % 3]));
        long double reach = std::abs(glm::dot(normal, apart));
        for (int j = 0; j < 3; ++j)
            reach += static_cast<long double>(box.half_extents[j]) * std::abs(glm::dot(normal, Vector3(box.axes[j])));
        const long double determinant = std::abs(glm::dot(normal, Vector3(bound.axes[k])));
        most = std::max(most, reach / determinant - static_cast<long double>(bound.half_extents[k]));
    }
    return most;
}

}  // namespace

TEST_SUITE("study/binary_tree") {
    TEST_CASE("bad boxes, bad criteria and sampling without samples are refused by name") {
        std::vector<Obb> boxes = random_boxes(1, 3);
        boxes[1].center.x = std::nan("");
        CHECK(error_of(BinaryTree::build(boxes)).item == 1);
        CHECK_FALSE(BinaryTree::build({}, {.criterion = {0.0, 0.0, 0.0}}).has_value());
        CHECK_FALSE(BinaryTree::build({}, {.split_criterion = {-1.0, 0.0, 1.0}}).has_value());
        CHECK(error_of(BinaryTree::build({}, {.split = Split::sampled})).code == ErrorCode::invalid_argument);
        BinaryTree tree = *BinaryTree::build({});
        CHECK_FALSE(tree.insert(boxes[1]).has_value());
        CHECK_FALSE(tree.remove(0));
        CHECK(tree.item_count() == 0);
    }

    TEST_CASE("an empty tree is visited by nobody, a single box once") {
        const BinaryTree none = *BinaryTree::build({});
        CHECK(none.visit([](const Obb&) { return Visit::descend; }, [](ItemId) {}) == 0);
        CHECK(none.cost() == 0.0);
        const std::vector<Obb> one = random_boxes(2, 1);
        const BinaryTree tree = *BinaryTree::build(one);
        int found = 0;
        CHECK(tree.visit([](const Obb&) { return Visit::descend; }, [&](ItemId) { ++found; }) == 1);
        CHECK(found == 1);
    }

    TEST_CASE("a thousand identical boxes make a tree, by every strategy") {
        const std::vector<Obb> same(1000, random_boxes(3, 1)[0]);
        const auto queries = *study::QuerySample::planes({glm::dvec3(25.0), 50.0}, 256, 1);
        for (const Split split : {Split::median, Split::nested, Split::sampled}) {
            const auto tree = BinaryTree::build(same, {.split = split, .queries = &queries});
            REQUIRE(tree.has_value());
            check_structure(*tree, same, std::vector<bool>(same.size(), true));
        }
        BinaryTree grown = *BinaryTree::build({});
        for (const Obb& box : same) REQUIRE(grown.insert(box).has_value());
        check_structure(grown, same, std::vector<bool>(same.size(), true));
    }

    TEST_CASE("every strategy contains every box in all bounds above it") {
        const std::vector<Obb> boxes = random_boxes(4, 500);
        Camera camera;
        camera.far_distance = 40.0;
        const auto queries = *study::QuerySample::frusta(camera, {glm::dvec3(25.0), 45.0}, 512, 1);
        for (const Split split : {Split::median, Split::nested, Split::sampled})
            for (const bool oriented : {false, true}) {
                const auto tree = BinaryTree::build(boxes, {.split = split, .oriented = oriented, .queries = &queries});
                REQUIRE(tree.has_value());
                const std::vector<bool> all(boxes.size(), true);
                check_structure(*tree, boxes, all);
                check_containment(*tree, boxes, all);
            }
    }

    TEST_CASE("far from the origin oriented bounds hold their boxes, whose corners are rounded by more than a float") {
        Random random(9);
        const auto vector = [&](double size) {
            return size * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
        };
        for (int trial = 0; trial < 400; ++trial) {
            std::vector<Obb> boxes = random_boxes(static_cast<std::uint64_t>(trial), 4);
            const glm::dvec3 far = glm::dvec3(1e10) + vector(1e9);
            for (Obb& box : boxes) {
                box.center = far + vector(1e-2);
                box.half_extents *= 1e-3f;
            }
            const auto tree = BinaryTree::build(boxes, {.oriented = true});
            REQUIRE(tree.has_value());
            for (ItemId i = 0; i < boxes.size(); ++i)
                for (std::uint32_t n = tree->node(tree->leaf(i)).parent; n != kNone; n = tree->node(n).parent)
                    CHECK(sticks_out(boxes[i], tree->node(n).bound) <= 1e-12L);
        }
    }

    TEST_CASE("inserting and removing in any order keeps the tree sound, and ids are used again") {
        for (const bool oriented : {false, true}) {
            const std::vector<Obb> boxes = random_boxes(5, 400);
            BinaryTree tree = *BinaryTree::build(std::span(boxes).first(200), {.oriented = oriented});
            std::vector<Obb> held(boxes.begin(), boxes.begin() + 200);
            std::vector<bool> present(200, true);
            Random random(6);
            for (int step = 0; step < 600; ++step) {
                const auto victim = static_cast<ItemId>(random.uniform() * static_cast<double>(held.size()));
                if (random.uniform() < 0.5) {
                    CHECK(tree.remove(victim) == present[victim]);
                    present[victim] = false;
                } else {
                    const Obb& box = boxes[static_cast<std::size_t>(random.uniform() * 400.0)];
                    const ItemId id = *tree.insert(box);
                    if (id == held.size()) held.push_back(box), present.push_back(true);
                    CHECK((!present[id] || id + 1 == held.size()));
                    held[id] = box;
                    present[id] = true;
                }
            }
            check_structure(tree, held, present);
            check_containment(tree, held, present);
            for (ItemId i = 0; i < held.size(); ++i) tree.remove(i);
            CHECK(tree.item_count() == 0);
            CHECK(tree.root() == nullptr);
        }
    }

    TEST_CASE("insertion finds the cheapest place of all") {
        // Against trying every node as the sibling.
        const std::vector<Obb> boxes = random_boxes(7, 120);
        BinaryTree tree = *BinaryTree::build({}, {.criterion = measure::minimal_area()});
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (i > 0 && i % 10 == 0) {
                const Aabb box = aabb_of(boxes[i]);
                const auto area = [](Aabb a, const Aabb& b) {
                    a.include(b);
                    const glm::dvec3 s = a.max - a.min;
                    return 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x);
                };
                double least = 1e300;
                for (ItemId leaf = 0; leaf < i; ++leaf) {
                    double inherited = 0.0;
                    std::vector<std::uint32_t> path;
                    for (std::uint32_t n = tree.leaf(leaf); n != kNone; n = tree.node(n).parent) path.push_back(n);
                    std::reverse(path.begin(), path.end());
                    for (const std::uint32_t n : path) {
                        least = std::min(least, inherited + area(tree.node(n).box, box));
                        inherited += area(tree.node(n).box, box) - area(tree.node(n).box, tree.node(n).box);
                    }
                }
                const double before = tree.cost();
                REQUIRE(tree.insert(boxes[i]).has_value());
                CHECK(tree.cost() - before == doctest::Approx(least).epsilon(1e-9));
            } else {
                REQUIRE(tree.insert(boxes[i]).has_value());
            }
        }
    }

    TEST_CASE("sorted insertions make a deep tree that is still walked") {
        BinaryTree tree = *BinaryTree::build({});
        Obb box;
        double size = 1.0;
        for (int i = 0; i < 90; ++i, size *= 1.5) {  // a geometric series of sizes
            box.half_extents = glm::vec3(static_cast<float>(size));
            REQUIRE(tree.insert(box).has_value());
        }
        std::size_t deepest = 0;
        for (ItemId i = 0; i < 90; ++i) deepest = std::max(deepest, depth_of(tree, &tree.node(tree.leaf(i))));
        CHECK(deepest >= 6);
        CHECK(tree.visit([](const Obb&) { return Visit::descend; }, [](ItemId) {}) == 179);
    }
    TEST_CASE("oriented or not, culling gives classify's answers while items come and go") {
        for (const bool oriented : {false, true})
            for (const double offset : {0.0, 1e6}) {
                std::vector<Obb> boxes = oracle::random_crowd(600, offset, 11).boxes;
                auto tree = *BinaryTree::build(boxes, {.oriented = oriented});
                oracle::NearMisses random(13, offset);
                Vector<ItemId> visible;
                for (int trial = 0; trial < 60; ++trial) {
                    const ItemId item = random.index(static_cast<unsigned>(boxes.size()));
                    const Obb box = oracle::random_box(random, offset * glm::dvec3(1.0, -0.7, 0.3), 40.0);
                    if (trial % 3 == 0) {
                        tree.remove(item);
                    } else {
                        const ItemId id = *tree.insert(box);
                        boxes.resize(std::max<std::size_t>(boxes.size(), id + 1));
                        boxes[id] = box;
                    }
                    Camera camera = random.camera();
                    camera.far_distance = camera.near_distance + random.number(1.0, 60.0);
                    const cull::View view{*frustum_of(camera)};
                    std::vector<ItemId> expected;
                    for (ItemId i = 0; i < boxes.size(); ++i)
                        if (tree.holds(i) && cull::classify(view.frustum, boxes[i]) != cull::Verdict::outside)
                            expected.push_back(i);
                    find_visible(tree, view, visible);
                    CHECK(test::ranges::equal(visible, expected));
                }
            }
        Vector<ItemId> visible;
        CHECK(find_visible(*BinaryTree::build(std::span<const Obb>{}), {*frustum_of(Camera{})}, visible) == 0);
        CHECK(visible.empty());
    }
}
