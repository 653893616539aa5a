// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <algorithm>
#include <crofton/core/executor.hpp>
#include <crofton/scene/scene.hpp>
#include <cstring>
#include <error_of.hpp>
#include <limits>
#include <random>
#include <set>

#include "counting_memory.hpp"
#include "fuzz/scene_model.hpp"

using namespace crofton;
using namespace crofton::scene;

namespace {

TriangleMesh tetrahedron(float size = 1.0f) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    return mesh;
}

Transform moved(double x, double y = 0.0, double z = 0.0) {
    return {glm::dmat3(1.0), {x, y, z}};
}

template <class T>
std::vector<T> list(std::span<const T> values) {
    return {values.begin(), values.end()};
}
using Ids = std::vector<std::uint32_t>;

}  // namespace

TEST_SUITE("scene/edit") {
    TEST_CASE("removed and unknown ids are refused by name and leave the scene as it was") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId node = scene.add_node(kNone, {}).value();
        const InstanceId instance = scene.add_instance(node, mesh).value();
        CHECK(error_of(scene.remove_node(7)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.remove_node(7)).item == 7);
        CHECK(error_of(scene.set_parent(node, 7)).item == 7);
        CHECK(error_of(scene.remove_mesh(7)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.replace_mesh(7, tetrahedron())).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.set_vertices(7, {})).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.set_instance_mesh(instance, 7)).item == 7);
        CHECK(error_of(scene.set_instance_layers(7, 1)).code == ErrorCode::out_of_range);
        const auto used = scene.remove_mesh(mesh);
        REQUIRE_FALSE(used.has_value());
        CHECK(error_of(used).code == ErrorCode::invalid_argument);
        CHECK(error_of(used).item == mesh);
        CHECK(error_of(used).message.find("instance 0") != std::string::npos);
        REQUIRE(scene.remove_node(node).has_value());
        CHECK(error_of(scene.remove_node(node)).code == ErrorCode::invalid_argument);
        CHECK(error_of(scene.add_node(node, {})).item == node);
        CHECK(error_of(scene.add_instance(node, mesh)).item == node);
        CHECK(error_of(scene.set_local(node, {})).code == ErrorCode::invalid_argument);
        CHECK(error_of(scene.remove_instance(instance)).code == ErrorCode::invalid_argument);
        REQUIRE(scene.remove_mesh(mesh).has_value());
        CHECK(error_of(scene.remove_mesh(mesh)).code == ErrorCode::invalid_argument);
    }

    TEST_CASE("a node cannot be its own ancestor") {
        Scene scene;
        NodeId chain[4];
        for (int i = 0; i < 4; ++i) chain[i] = scene.add_node(i == 0 ? kNone : chain[i - 1], moved(1.0)).value();
        for (const NodeId below : chain) {
            const auto refused = scene.set_parent(chain[0], below);
            REQUIRE_FALSE(refused.has_value());
            CHECK(error_of(refused).code == ErrorCode::invalid_argument);
            CHECK(error_of(refused).item == chain[0]);
        }
        REQUIRE(scene.set_parent(chain[2], kNone).has_value());
        REQUIRE(scene.set_parent(chain[0], chain[3]).has_value());
        CHECK_FALSE(scene.set_parent(chain[2], chain[1]).has_value());
        scene.update();
        CHECK(scene.world(chain[1]).translation.x == 4.0);
    }

    TEST_CASE("removing a node removes all below it, and removed_instances lists what was there at the last update") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId root = scene.add_node(kNone, {}).value();
        const NodeId arm = scene.add_node(root, moved(1.0)).value();
        const NodeId hand = scene.add_node(arm, moved(1.0)).value();
        const InstanceId on_hand = scene.add_instance(hand, mesh).value();
        const InstanceId on_arm = scene.add_instance(arm, mesh).value();
        const InstanceId on_root = scene.add_instance(root, mesh).value();
        scene.update();
        CHECK(scene.removed_instances().empty());
        (void)scene.add_instance(hand, mesh).value();  // never seen by an update
        REQUIRE(scene.remove_node(arm).has_value());
        CHECK(scene.is_node_removed(hand));
        CHECK(scene.is_removed(on_hand));
        CHECK(scene.layer_masks()[on_arm] == 0);
        scene.update();
        CHECK(list(scene.removed_instances()) == Ids{on_hand, on_arm});
        CHECK_FALSE(scene.is_removed(on_root));
        CHECK(scene.moved_instances().empty());
        scene.update();
        CHECK(scene.removed_instances().empty());
    }

    TEST_CASE("an id given out again is listed for what it was and for what it is") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId node = scene.add_node(kNone, {}).value();
        const InstanceId first = scene.add_instance(node, mesh).value();
        scene.update();
        REQUIRE(scene.remove_instance(first).has_value());
        CHECK(scene.add_instance(node, mesh).value() == first);
        CHECK(scene.layer_masks()[first] == 0);
        scene.update();
        CHECK(list(scene.removed_instances()) == Ids{first});
        CHECK(list(scene.moved_instances()) == Ids{first});
        CHECK(list(scene.relayered_instances()) == Ids{first});
    }

    TEST_CASE("many transforms are set all or none") {
        Scene scene;
        const NodeId a = scene.add_node(kNone, {}).value(), b = scene.add_node(kNone, {}).value();
        Transform bad;
        bad.translation.x = std::numeric_limits<double>::quiet_NaN();
        const NodeId both[] = {b, a}, unknown[] = {a, 9};
        const Transform good[] = {moved(1.0), moved(2.0)}, half[] = {moved(3.0), bad};
        CHECK(error_of(scene.set_local(both, half)).item == 1);
        CHECK(error_of(scene.set_local(both, half)).code == ErrorCode::non_finite);
        CHECK(error_of(scene.set_local(unknown, good)).item == 1);
        CHECK(error_of(scene.set_local(both, std::span(good, 1))).code == ErrorCode::invalid_argument);
        CHECK(scene.local(b).translation.x == 0.0);
        REQUIRE(scene.set_local(both, good).has_value());
        CHECK(scene.update().nodes_updated == 2);
        CHECK(scene.world(a).translation.x == 2.0);
        CHECK(scene.world(b).translation.x == 1.0);
    }

    TEST_CASE("a mesh's new vertices keep its box's axes and move its instances, and bad ones change nothing") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron(), "blob").value();
        const InstanceId instance = scene.add_instance(scene.add_node(kNone, moved(10.0)).value(), mesh).value();
        scene.update();
        const Obb before = scene.mesh_box(mesh);
        const std::uint64_t revision = scene.mesh_revision(mesh);
        TriangleMesh larger = tetrahedron(3.0f);
        CHECK(error_of(scene.set_vertices(mesh, std::span(larger.positions).first(3))).code ==
              ErrorCode::invalid_argument);
        larger.positions[2].x = std::numeric_limits<float>::infinity();
        CHECK(error_of(scene.set_vertices(mesh, larger.positions)).item == 2);
        CHECK(scene.mesh_revision(mesh) == revision);
        CHECK(scene.mesh(mesh).positions[1].x == 1.0f);
        larger = tetrahedron(3.0f);
        REQUIRE(scene.set_vertices(mesh, larger.positions).has_value());
        CHECK(scene.mesh_box(mesh).axes == before.axes);
        CHECK(scene.mesh_revision(mesh) != revision);
        for (const glm::vec3& p : larger.positions) CHECK(contains(scene.mesh_box(mesh), glm::dvec3(p)));
        scene.update();
        CHECK(list(scene.moved_instances()) == Ids{instance});
        for (const glm::vec3& p : larger.positions)
            CHECK(contains(scene.world_boxes()[instance], glm::dvec3(p) + glm::dvec3(10.0, 0.0, 0.0)));
        CHECK(scene.mesh_name(mesh) == "blob");
        CHECK(error_of(scene.replace_mesh(mesh, {})).code == ErrorCode::empty);
        TriangleMesh triangle;
        triangle.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
        triangle.indices = {0, 1, 2};
        REQUIRE(scene.replace_mesh(mesh, triangle).has_value());
        CHECK(scene.mesh(mesh).triangle_count() == 1);
        CHECK(scene.mesh_name(mesh) == "blob");
        scene.update();
        CHECK(list(scene.moved_instances()) == Ids{instance});
        CHECK(contains(scene.world_boxes()[instance], {19.0, 0.0, 0.0}));
        // Its box has the same bits.
        REQUIRE(scene.replace_mesh(mesh, triangle).has_value());
        scene.update();
        CHECK(list(scene.moved_instances()) == Ids{instance});
        scene.update();
        CHECK(scene.moved_instances().empty());
    }

    TEST_CASE("an instance's layers are its own and its node's") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const InstanceId instance = scene.add_instance(scene.add_node(kNone, {}, 0b011).value(), mesh).value();
        scene.update();
        REQUIRE(scene.set_instance_layers(instance, 0b110).has_value());
        CHECK(scene.layer_masks()[instance] == 0b011);
        scene.update();
        CHECK(scene.layer_masks()[instance] == 0b010);
        CHECK(scene.moved_instances().empty());
        CHECK(list(scene.relayered_instances()) == Ids{instance});
    }

    TEST_CASE("ten million additions and removals take no more memory than the largest number there at once") {
        testing::CountingMemory memory;
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId root = scene.add_node(kNone, {}).value();
        std::vector<NodeId> live;
        std::mt19937 random(3);
        std::size_t high = 0;
        constexpr int kCycles = 10'000'000, kLive = 100;
        for (int i = 0; i < kCycles; ++i) {
            if (live.size() == kLive) {
                const std::size_t at = random() % kLive;
                REQUIRE(scene.remove_node(live[at]).has_value());
                live[at] = live.back();
                live.pop_back();
            }
            live.push_back(scene.add_node(i % 2 == 0 ? root : kNone, {}).value());
            (void)scene.add_instance(live.back(), mesh).value();
            if (i % 1'000'000 == 500'000) scene.update();
            if (i == 3'000'000) high = memory.bytes_in_use();
        }
        CHECK(memory.bytes_in_use() == high);
        CHECK(scene.node_count() == kLive + 1);
        CHECK(scene.instance_count() == kLive);
    }

    TEST_CASE("a removed node or mesh has no name, and the name's memory is given back") {
        testing::CountingMemory memory;
        Scene scene;
        const auto add_and_remove = [&](const std::string& name) {
            const NodeId node = scene.add_node(kNone, {}, ~0u, name).value();
            CHECK(scene.node_name(node) == name);
            REQUIRE(scene.remove_node(node).has_value());
            CHECK(scene.node_name(node).empty());
            const MeshId mesh = scene.add_mesh(tetrahedron(), name).value();
            CHECK(scene.mesh_name(mesh) == name);
            REQUIRE(scene.remove_mesh(mesh).has_value());
            CHECK(scene.mesh_name(mesh).empty());
        };
        add_and_remove("short");
        const std::size_t before = memory.bytes_in_use();
        add_and_remove(std::string(10000, 'n'));
        CHECK(memory.bytes_in_use() == before);
    }

    TEST_CASE("chains of a million nodes are moved under others and removed without recursion") {
        Scene scene;
        constexpr int kLength = 1'000'000;
        const NodeId top = scene.add_node(kNone, moved(1.0)).value();
        NodeId node = top;
        for (int i = 1; i < kLength; ++i) node = scene.add_node(node, moved(1.0)).value();
        const NodeId late = scene.add_node(kNone, moved(5.0)).value();
        CHECK_FALSE(scene.set_parent(top, node).has_value());
        REQUIRE(scene.set_parent(top, late).has_value());
        scene.update();
        CHECK(scene.world(node).translation.x == 5.0 + kLength);
        ThreadPool pool(2);
        REQUIRE(scene.set_local(late, moved(6.0)).has_value());
        CHECK(scene.update(pool).nodes_updated == kLength + 1);
        CHECK(scene.world(node).translation.x == 6.0 + kLength);
        REQUIRE(scene.remove_node(late).has_value());
        CHECK(scene.is_node_removed(node));
    }

    TEST_CASE("random edits, on one thread and on three, give what a plain model computes from the roots") {
        ThreadPool pool(3);
        std::mt19937 random(1);
        for (int life = 0; life < 60; ++life) {
            CAPTURE(life);
            std::vector<std::uint8_t> bytes(20'000);
            for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
            fuzz::Shapes in(bytes.data(), bytes.size());
            fuzz::LivingScene living(in);
            while (in.more()) {
                for (unsigned edits = in.below(30); edits > 0; --edits) living.change(in);
                living.settle(life % 2 == 0 ? serial_executor() : pool);
            }
        }
    }

    TEST_CASE("updates allocate nothing once warm") {
        testing::CountingMemory memory;
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        std::vector<NodeId> nodes;
        for (int i = 0; i < 1000; ++i) {
            nodes.push_back(scene.add_node(i % 4 == 0 ? kNone : nodes.back(), moved(i)).value());
            (void)scene.add_instance(nodes.back(), mesh).value();
        }
        const auto frame = [&](double x) {
            for (const NodeId node : nodes) REQUIRE(scene.set_local(node, moved(x)).has_value());
            scene.update();
        };
        frame(1.0);
        frame(2.0);
        const std::size_t warm = memory.allocations();
        for (int i = 0; i < 10; ++i) frame(i);
        CHECK(memory.allocations() == warm);
    }
}
