// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/mesh/box_hierarchy.hpp>
#include <random>
#include <span>
#include <vector>

using namespace crofton;
using namespace crofton::mesh;

namespace {

bool holds(const FloatBox& outer, const FloatBox& inner) {
    for (int i = 0; i < 3; ++i)
        if (outer.low[i] > inner.low[i] || outer.high[i] < inner.high[i]) return false;
    return true;
}

FloatBox box_of(const BoxNode& node, std::uint32_t lane) {
    FloatBox box;
    for (int i = 0; i < 3; ++i) {
        box.low[i] = node.bounds[i][lane];
        box.high[i] = node.bounds[i + 3][lane];
    }
    return box;
}

// Nodes on the longest path; checks that every box holds what lies below it, and that each item is in one leaf.
int check(const BoxHierarchy& tree, std::span<const FloatBox> boxes, std::uint32_t leaf_size) {
    std::vector<int> depth(tree.nodes.size(), 0), seen(boxes.size(), 0);
    depth[0] = 1;
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        const BoxNode& node = tree.nodes[n];
        REQUIRE(node.count >= 1);
        REQUIRE(node.count <= kBoxNodeWidth);
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            const std::uint32_t child = node.child[lane];
            if (child & kMeshLeaf) {
                const BoxHierarchy::Leaf& leaf = tree.leaves.at(child & ~kMeshLeaf);
                CHECK(leaf.end - leaf.begin <= leaf_size);
                for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
                    CHECK(holds(box_of(node, lane), boxes[tree.order.at(i)]));
                    ++seen[tree.order[i]];
                }
                continue;
            }
            REQUIRE(child > n);
            REQUIRE(depth.at(child) == 0);
            depth[child] = depth[n] + 1;
            const BoxNode& below = tree.nodes[child];
            for (std::uint32_t l = 0; l < below.count; ++l) CHECK(holds(box_of(node, lane), box_of(below, l)));
        }
    }
    CHECK(std::count(seen.begin(), seen.end(), 1) == static_cast<std::ptrdiff_t>(boxes.size()));
    return *std::max_element(depth.begin(), depth.end());
}

BoxHierarchy build(std::span<const FloatBox> boxes, std::uint32_t leaf_size, std::uint32_t granule = 1) {
    return build_box_hierarchy(
        boxes.size(), [&](std::size_t i) { return boxes[i]; }, leaf_size, granule);
}

FloatBox around(const glm::vec3& p) {
    FloatBox box;
    box.include(p);
    return box;
}

}  // namespace

TEST_SUITE("mesh/box_hierarchy") {
    TEST_CASE("every item is in one leaf, and every box holds what lies below it") {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
        for (const std::size_t count : {1u, 2u, 8u, 9u, 100u, 5000u})
            for (const std::uint32_t leaf_size : {1u, 8u}) {
                std::vector<FloatBox> boxes;
                for (std::size_t i = 0; i < count; ++i) {
                    boxes.push_back(around({unit(random), unit(random), unit(random)}));
                    boxes.back().include({unit(random), unit(random), unit(random)});
                }
                for (const std::uint32_t granule : {1u, leaf_size})
                    CHECK(check(build(boxes, leaf_size, granule), boxes, leaf_size) <= 8);
            }
    }

    TEST_CASE("leaves of a surface are full, and nodes nearly so") {
        std::mt19937_64 random(7);
        std::uniform_real_distribution<float> unit(0.0f, 1.0f);
        std::vector<FloatBox> boxes;
        for (int i = 0; i < 20000; ++i) {
            const float x = 100.0f * unit(random), y = 100.0f * unit(random);
            boxes.push_back(around({x, y, 0.01f * x * y}));
            boxes.back().include({x + unit(random), y + unit(random), 0.01f * x * y + unit(random)});
        }
        const BoxHierarchy tree = build(boxes, 8, 8);
        CHECK(check(tree, boxes, 8) <= 8);
        CHECK(tree.leaves.size() < 20000 / 8 * 1.05);
        CHECK(tree.nodes.size() < tree.leaves.size() / 4);  // each node less the root takes a lane: 5 lanes and more
    }

    TEST_CASE("two crowds of unequal number are parted between them, in whatever order they come") {
        std::mt19937 random(6);
        std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
        std::vector<FloatBox> boxes;
        for (int i = 0; i < 16; ++i) {
            const glm::vec3 place(i < 5 ? 0.0f : 1000.0f, 0.0f, 0.0f);
            boxes.push_back(around(place + glm::vec3(unit(random), unit(random), unit(random))));
        }
        for (int trial = 0; trial < 10; ++trial) {
            std::shuffle(boxes.begin(), boxes.end(), random);
            const BoxHierarchy tree = build(boxes, 11);
            REQUIRE(tree.nodes.size() == 1);
            REQUIRE(tree.nodes[0].count == 2);
            for (std::uint32_t lane = 0; lane < 2; ++lane) {
                const FloatBox box = box_of(tree.nodes[0], lane);
                CHECK(box.high.x - box.low.x <= 2.0f);
            }
        }
    }

    TEST_CASE("boxes in one place, and a geometric series of places, make no deep tree") {
        const std::vector<FloatBox> same(100000, around(glm::vec3(1.0f)));
        CHECK(check(build(same, 1), same, 1) <= 20);
        CHECK(build(same, 8, 8).leaves.size() == same.size() / 8);
        std::vector<FloatBox> closest;  // so close that the width has no finite reciprocal
        for (int i = 0; i < 100; ++i) closest.push_back(around(glm::vec3(static_cast<float>(i % 3) * 1.5e-45f)));
        CHECK(check(build(closest, 1), closest, 1) <= 10);
        CHECK(check(build(closest, 8, 8), closest, 8) <= 10);
        std::vector<FloatBox> series;
        for (float x = 1e-37f; x < 1e37f; x *= 1.001f) series.push_back(around(glm::vec3(x, 0.0f, -x)));
        CHECK(series.size() > 100000);
        CHECK(check(build(series, 1), series, 1) <= BoxHierarchy::kMaxDepth);
        CHECK(check(build(series, 8, 8), series, 8) <= BoxHierarchy::kMaxDepth);
    }
}
