// SPDX-License-Identifier: MIT
// Trees whose inner bounds lie along turned axes.
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/core/executor.hpp>
#include <oracle/aged_tree.hpp>
#include <oracle/tree_contents.hpp>
#include <oracle/turned_crowd.hpp>

#include "../../ranges.hpp"

using namespace crofton;
using boxtree::BoxTree;
using boxtree::Orientation;

namespace {

std::size_t turned_nodes(const BoxTree& tree) {
    return static_cast<std::size_t>(
        test::ranges::count_if(tree.structure().nodes(), [](const boxtree::Node& node) { return node.axes != 0; }));
}

void check_sound(const BoxTree& tree) {
    const auto valid = tree.validate();
    INFO((valid ? std::string() : valid.error().message));
    REQUIRE(valid.has_value());
    REQUIRE(oracle::holds_all(tree));
}

// Edges of all children's bounds, along their axes.
double perimeters(const BoxTree& tree) {
    double sum = 0.0;
    for (const boxtree::Node& node : tree.structure().nodes())
        for (unsigned lane = 0; lane < node.count; ++lane)
            for (unsigned k = 0; k < 3; ++k)
                sum += 2.0 * static_cast<double>(node.unit) * boxtree::half_of(node, lane, k);
    return sum;
}

// Corners of the bounds of leaves, drawn inwards a little, where the node above takes bounds along other axes.
std::vector<glm::dvec3> corners_of_leaves(const BoxTree& tree) {
    std::vector<glm::dvec3> corners;
    const boxtree::Structure& structure = tree.structure();
    for (const boxtree::Node& node : structure.nodes()) {
        if (node.parent == boxtree::kNone || structure.nodes()[node.parent].axes == node.axes) continue;
        for (unsigned lane = 0; lane < node.count; ++lane) {
            if (!(node.child[lane] & boxtree::kLeafBit)) continue;
            for (unsigned corner = 0; corner < 8; ++corner) {
                glm::dvec3 place(node.origin[0], node.origin[1], node.origin[2]);
                for (unsigned k = 0; k < 3; ++k) {
                    const double* row = structure.axes()[node.axes].rows[k];
                    const int end = corner >> k & 1 ? 1 : -1;
                    const double at = static_cast<double>(node.unit) *
                                      (boxtree::middle_of(node, lane, k) + 0.9 * end * boxtree::half_of(node, lane, k));
                    place += at * glm::dvec3(row[0], row[1], row[2]);
                }
                corners.push_back(place);
            }
        }
    }
    return corners;
}

BoxTree tree_of(const oracle::Crowd& crowd, Orientation orientation) {
    return BoxTree::build(crowd.boxes, crowd.layers, {.orientation = orientation}).value();
}

}  // namespace

TEST_SUITE("boxtree/oriented") {
    TEST_CASE("if boxes are rotated in groups, turned bounds have less perimeter and contain the boxes exactly") {
        for (const double offset : {0.0, 1e4, 1e7}) {
            const oracle::Crowd crowd = oracle::turned_crowd(3000, offset, 1);
            const BoxTree aligned = tree_of(crowd, Orientation::aligned);
            for (const Orientation orientation : {Orientation::oriented, Orientation::automatic}) {
                const BoxTree tree = tree_of(crowd, orientation);
                CHECK(turned_nodes(tree) > tree.structure().nodes().size() / 2);
                CHECK(perimeters(tree) < 0.9 * perimeters(aligned));
                check_sound(tree);
            }
            CHECK(turned_nodes(aligned) == 0);
        }
    }

    TEST_CASE("if each box is rotated differently, nothing is gained and the automatic kind turns almost nothing") {
        const oracle::Crowd crowd = oracle::random_crowd(5000, 0.0, 2);
        const BoxTree tree = tree_of(crowd, Orientation::automatic);
        CHECK(turned_nodes(tree) * 20 < tree.structure().nodes().size());
        check_sound(tree);
    }

    TEST_CASE("among several axes better than the world's the best are chosen, not the last") {
        // Needles at 45°, but for the one whose axes are tried last.
        const auto needle = [](double degrees) {
            const double angle = degrees * 0.017453292519943295;
            Obb box;
            box.axes = glm::mat3(glm::dmat3(glm::dvec3(std::cos(angle), std::sin(angle), 0.0),
                                            glm::dvec3(-std::sin(angle), std::cos(angle), 0.0), glm::dvec3(0, 0, 1)));
            box.half_extents = {10.0f, 0.01f, 0.01f};
            return box;
        };
        std::vector<Obb> boxes(300, needle(45.0));
        boxes[250] = needle(30.0);
        for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i].center.x = 1e-3 * static_cast<double>(i);
        const auto tree = BoxTree::build(boxes, {.orientation = Orientation::oriented}).value();
        const boxtree::Structure& structure = tree.structure();
        const boxtree::Axes& axes = structure.axes_of(structure.nodes()[0]);
        double along = 0.0;
        for (const auto& row : axes.rows) along = std::max(along, std::fabs(row[0] + row[1]) * std::sqrt(0.5));
        CHECK(along > 0.9999);
    }

    TEST_CASE("sizes from nothing to a galaxy, and places to match, are held") {
        for (const double scale : {1e-20, 1e-6, 1e9, 1e27}) {
            oracle::Crowd crowd = oracle::turned_crowd(600, 0.0, 3, scale);
            crowd.boxes[7].half_extents = glm::vec3(0.0f);
            check_sound(tree_of(crowd, Orientation::oriented));
        }
        oracle::Crowd far = oracle::turned_crowd(600, 1e17, 4);  // less than a step of double apart
        check_sound(tree_of(far, Orientation::oriented));
        far.boxes[5].center = glm::dvec3(1e30, -1e30, 1e30);
        far.boxes[6].half_extents = glm::vec3(1e29f);
        check_sound(tree_of(far, Orientation::oriented));
        for (const std::size_t count : {0u, 1u, 16u, 17u, 300u}) {
            const oracle::Crowd few = oracle::turned_crowd(count, 0.0, 5);
            CHECK(BoxTree::deserialise(tree_of(few, Orientation::aligned).serialise()).has_value());
            check_sound(tree_of(few, Orientation::oriented));
            check_sound(tree_of(few, Orientation::automatic));
        }
    }

    TEST_CASE("any sequence of changes and rebuilds leaves bounds that hold all") {
        oracle::NearMisses random(6);
        for (const Orientation orientation : {Orientation::oriented, Orientation::automatic}) {
            oracle::AgedTree aged(oracle::turned_crowd(1500, 0.0, 7), 40.0, orientation);
            REQUIRE(turned_nodes(aged.tree) > 0);
            for (int frame = 0; frame < 120; ++frame) {
                aged.live(random, 40);
                if (frame % 10 == 0) check_sound(aged.tree);
            }
            check_sound(aged.tree);
        }
    }

    TEST_CASE("small boxes in the corners of bounds along other axes than those of the node above are held at once") {
        for (const std::uint64_t seed : {10u, 11u}) {
            BoxTree tree = tree_of(oracle::turned_crowd(2500, 0.0, seed), Orientation::oriented);
            for (const glm::dvec3& corner : corners_of_leaves(tree)) {
                Obb box;
                box.center = corner;
                box.half_extents = glm::vec3(1e-3f);
                REQUIRE(tree.insert(box).has_value());
                check_sound(tree);
            }
        }
    }

    TEST_CASE("a rebuild in the background chooses the axes that a build chooses, in bounded steps") {
        const oracle::Crowd crowd = oracle::turned_crowd(6000, 0.0, 8);
        std::vector<Obb> boxes(crowd.boxes.size());
        BoxTree tree = *BoxTree::build(boxes, {.orientation = Orientation::oriented});
        CHECK(turned_nodes(tree) == 0);
        for (boxtree::ItemId item = 0; item < boxes.size(); ++item)
            REQUIRE(tree.move(item, crowd.boxes[item]).has_value());
        tree.refit();
        int steps = 1;
        while (!tree.rebuild_step(3000)) ++steps;
        CHECK(steps > 20);
        check_sound(tree);
        CHECK(turned_nodes(tree) > 0);
        CHECK(perimeters(tree) < 1.02 * perimeters(tree_of(crowd, Orientation::oriented)));
    }

    TEST_CASE("any number of threads makes the same bytes, and these the same tree") {
        const oracle::Crowd crowd = oracle::turned_crowd(40000, 0.0, 9, 200.0);
        const boxtree::BuildOptions options{.orientation = Orientation::automatic};
        const Vector<std::byte> bytes = BoxTree::build(crowd.boxes, crowd.layers, options)->serialise();
        for (const unsigned threads : {2u, 5u}) {
            ThreadPool pool(threads);
            CHECK(BoxTree::build(crowd.boxes, crowd.layers, options, pool)->serialise() == bytes);
        }
        auto back = BoxTree::deserialise(bytes).value();
        CHECK(turned_nodes(back) > 0);
        CHECK(back.serialise() == bytes);
        CHECK(back.structure().orientation() == Orientation::automatic);
    }
}
