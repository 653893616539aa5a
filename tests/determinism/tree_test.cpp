// SPDX-License-Identifier: MIT
// Trees and what is stored of them, in the same bits everywhere.
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/boxtree/structure.hpp>
#include <crofton/mesh/mesh_parts.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <oracle/tree_contents.hpp>

#include "crowd.hpp"
#include "digest.hpp"
#include "everywhere.hpp"

using namespace crofton;
using namespace crofton::test;

namespace {

std::uint64_t digest_of(const boxtree::BoxTree& tree) {
    Digest digest;
    for (const std::byte byte : tree.serialise()) digest.add(static_cast<std::uint8_t>(byte));
    return digest.value();
}

// A build, then frames in which items move, come and go while a rebuild goes on.
boxtree::BoxTree lived_in_tree(Executor& executor) {
    std::vector<Obb> boxes = crowd(5000, 0.0, 21);
    auto tree = *boxtree::BoxTree::build(boxes, {}, executor);
    Random random(22);
    for (int frame = 0; frame < 12; ++frame) {
        for (int i = 0; i < 300; ++i) {
            const boxtree::ItemId item = index(random, 5000);
            const Obb box = random_box(random, glm::dvec3(0.0), 45.0, 4.0);
            if (tree.structure().slot_of(item) == boxtree::kNone) continue;
            if (i % 10 == 0)
                (void)tree.remove(item);
            else
                (void)tree.move(item, box);
            if (i % 15 == 0) (void)tree.insert(box);
        }
        tree.refit();
        tree.rebuild_step(2000);
    }
    return tree;
}

std::uint64_t mesh_tree() {
    const auto tree = *mesh::MeshTree::build(torus(60, 30, 0.2));
    Digest digest;
    for (const mesh::MeshNode& node : tree.parts().nodes)
        for (std::uint32_t lane = 0; lane < node.count; ++lane) {
            for (std::size_t i = 0; i < 3; ++i) {
                digest.add(node.center[i][lane]).add(node.half[i][lane]);
                for (std::size_t k = 0; k < 3; ++k) digest.add(node.axes[k][i][lane]);
            }
            digest.add(node.child[lane]);
        }
    for (const mesh::MeshLeaf& leaf : tree.parts().leaves) digest.add(leaf.triangle);
    return digest.value();
}

}  // namespace

TEST_SUITE("determinism/tree") {
    TEST_CASE("a tree as built, and after frames of motion, is the same bytes everywhere") {
        check_everywhere(0x59f8268b40e9e15b,
                         [](Executor& e) { return digest_of(*boxtree::BoxTree::build(crowd(5000, 1e6, 20), {}, e)); });
        check_everywhere(0x9527b118e17c7954, [](Executor& e) { return digest_of(lived_in_tree(e)); });
    }

    TEST_CASE("mesh trees are the same bits everywhere") {
        check_everywhere(0xd91afffd43f4f2ea, [](Executor&) { return mesh_tree(); });
    }

    TEST_CASE("the published tree contains every item within all bounds above it") {
        CHECK(oracle::holds_all(*boxtree::BoxTree::build(crowd(5000, 1e6, 20))));
        CHECK(oracle::holds_all(lived_in_tree(serial_executor())));
    }
}
