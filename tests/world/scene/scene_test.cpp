// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>
#include <crofton/core/executor.hpp>
#include <crofton/scene/scene.hpp>
#include <cstring>
#include <error_of.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace crofton;
using namespace crofton::scene;

namespace {

TriangleMesh tetrahedron() {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    return mesh;
}

Transform moved(double x, double y = 0.0, double z = 0.0) {
    return {glm::dmat3(1.0), {x, y, z}};
}

// Nodes and instances in a random forest, the same for the same seed.
Scene random_scene(std::uint32_t seed, int nodes) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    Scene scene;
    const MeshId mesh = scene.add_mesh(tetrahedron()).value();
    for (int i = 0; i < nodes; ++i) {
        const NodeId parent =
            i == 0 || random() % 5 == 0 ? kNone : static_cast<NodeId>(random() % static_cast<unsigned>(i));
        const glm::dquat turn = glm::normalize(glm::dquat(1.0, number(random), number(random), number(random)));
        const NodeId node =
            scene
                .add_node(parent,
                          from_trs({number(random), number(random), number(random)}, turn, {1.0, 1.1, 0.9}).value())
                .value();
        (void)scene.add_instance(node, mesh).value();
    }
    return scene;
}

bool same_boxes(const Scene& a, const Scene& b) {
    return a.world_boxes().size() == b.world_boxes().size() &&
           std::memcmp(a.world_boxes().data(), b.world_boxes().data(), a.world_boxes().size_bytes()) == 0;
}

}  // namespace

TEST_SUITE("scene/scene") {
    TEST_CASE("an object that is stretched by a hair along one axis has moved, though its box stays") {
        TriangleMesh cube;
        for (int i = 0; i < 8; ++i)
            cube.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
        cube.indices = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5};
        Scene scene;
        const NodeId node = scene.add_node(kNone, {}).value();
        (void)scene.add_instance(node, scene.add_mesh(cube).value()).value();
        scene.update();
        for (int k = 0; k < 3; ++k) {
            CAPTURE(k);
            const Obb before = scene.world_boxes()[0];
            Transform stretched = scene.world(node);
            stretched.linear[k] *= 1.0 + 0x1p-40;
            REQUIRE(scene.set_local(node, stretched));
            scene.update();
            CHECK(std::memcmp(&scene.world_boxes()[0], &before, sizeof before) == 0);
            CHECK(scene.moved_instances().size() == 1);
            scene.update();
            CHECK(scene.moved_instances().empty());
        }
    }

    TEST_CASE("invalid meshes, nodes and instances are refused by name and leave the scene as it was") {
        Scene scene;
        CHECK(error_of(scene.add_mesh({}, "void")).code == ErrorCode::empty);
        CHECK(error_of(scene.add_mesh({}, "void")).message.find("void") != std::string::npos);
        TriangleMesh bad = tetrahedron();
        bad.positions[2].y = std::numeric_limits<float>::quiet_NaN();
        CHECK(error_of(scene.add_mesh(bad)).item == 2);
        bad = tetrahedron();
        bad.indices[7] = 4;
        CHECK(error_of(scene.add_mesh(bad)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.add_node(0, {})).code == ErrorCode::out_of_range);
        Transform huge;
        huge.linear = glm::dmat3(1e16);
        CHECK(error_of(scene.add_node(kNone, huge)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.add_instance(0, 0)).code == ErrorCode::out_of_range);
        CHECK(scene.node_count() + scene.mesh_count() + scene.instance_count() == 0);
        const NodeId node = scene.add_node(kNone, moved(1.0)).value();
        CHECK(error_of(scene.add_instance(node, 0)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.set_local(node, huge)).item == node);
        CHECK(scene.local(node).translation.x == 1.0);
        CHECK(error_of(scene.set_local(5, {})).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.set_layer_mask(5, 1)).code == ErrorCode::out_of_range);
        CHECK(error_of(scene.remove_instance(0)).code == ErrorCode::out_of_range);
    }

    TEST_CASE(
        "an instance that leaves the range of coordinates is hidden and reported, its neighbours are not touched") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        NodeId chain = kNone;
        for (int i = 0; i < 5; ++i)
            chain = scene.add_node(chain, from_trs({}, glm::dquat(1, 0, 0, 0), {1e14, 1e14, 1e14}).value()).value();
        const InstanceId lost = scene.add_instance(chain, mesh).value();
        const InstanceId fine = scene.add_instance(scene.add_node(kNone, moved(1.0)).value(), mesh).value();
        std::vector<std::string> warnings;
        set_log_handler(
            [](void* to, LogLevel, std::string_view message) {
                static_cast<std::vector<std::string>*>(to)->emplace_back(message);
            },
            &warnings);
        CHECK(scene.update().instances_invalid == 1);
        REQUIRE(warnings.size() == 1);
        CHECK(warnings[0].find("1 instances are out of the range") != std::string::npos);
        CHECK(scene.layer_masks()[lost] == 0);
        CHECK(scene.layer_masks()[fine] == ~0u);
        CHECK(validate(scene.world_boxes()[lost]).has_value());
        REQUIRE(scene.set_local(0, from_trs({}, glm::dquat(1, 0, 0, 0), {1e-14, 1e-14, 1e-14}).value()).has_value());
        REQUIRE(scene.set_local(1, from_trs({}, glm::dquat(1, 0, 0, 0), {1e-14, 1e-14, 1e-14}).value()).has_value());
        CHECK(scene.update().instances_invalid == 0);
        CHECK(scene.layer_masks()[lost] == ~0u);
        CHECK(warnings.size() == 1);  // none about nothing
        set_log_handler(nullptr, nullptr);
    }

    TEST_CASE("a chain of scales that overflows to infinity hides the instance, one that vanishes hides it too") {
        for (const double scale : {1e15, 1e-15}) {
            Scene scene;
            const MeshId mesh = scene.add_mesh(tetrahedron()).value();
            NodeId chain = kNone;
            for (int i = 0; i < 30; ++i) chain = scene.add_node(chain, {glm::dmat3(scale), {5.0, 0.0, 0.0}}).value();
            const InstanceId instance = scene.add_instance(chain, mesh).value();
            CHECK(scene.update().instances_invalid == (scale > 1.0 ? 1 : 0));
            CHECK(scene.layer_masks()[instance] == 0);
            CHECK(validate(scene.world_boxes()[instance]).has_value());
        }
    }

    TEST_CASE("a zero scale hides what hangs below, and any other scale shows it again") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId root = scene.add_node(kNone, {glm::dmat3(0.0), {3.0, 4.0, 5.0}}).value();
        const InstanceId child = scene.add_instance(scene.add_node(root, moved(1.0)).value(), mesh).value();
        CHECK(scene.update().instances_invalid == 0);
        CHECK(scene.layer_masks()[child] == 0);
        CHECK(scene.world_boxes()[child].center == glm::dvec3(3.0, 4.0, 5.0));
        CHECK(glm::length(scene.world_boxes()[child].half_extents) < 1e-13f);
        REQUIRE(scene.set_local(root, {glm::dmat3(glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0)), {}})
                    .has_value());
        scene.update();
        CHECK(scene.layer_masks()[child] == ~0u);
        CHECK(contains(scene.world_boxes()[child], {1.0, 1.0, 0.0}));
    }

    TEST_CASE("a chain of a million nodes is updated without recursion") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        NodeId node = kNone;
        for (int i = 0; i < 1'000'000; ++i) node = scene.add_node(node, moved(1.0)).value();
        const InstanceId last = scene.add_instance(node, mesh).value();
        CHECK(scene.update().nodes_updated == 1'000'000);
        CHECK(contains(scene.world_boxes()[last], {1e6, 0.0, 0.0}));
    }

    TEST_CASE("only what changed is updated, descendants included and each once") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId root = scene.add_node(kNone, {}).value();
        const NodeId arm = scene.add_node(root, moved(1.0)).value();
        const NodeId hand = scene.add_node(arm, moved(1.0)).value();
        const NodeId other = scene.add_node(root, moved(0.0, 5.0)).value();
        const InstanceId on_hand = scene.add_instance(hand, mesh).value();
        const InstanceId on_other = scene.add_instance(other, mesh).value();
        CHECK(scene.update().nodes_updated == 4);
        CHECK(scene.moved_instances().size() == 2);
        const UpdateStatistics idle = scene.update();
        CHECK(idle.nodes_updated + idle.instances_updated == 0);
        CHECK(scene.moved_instances().empty());
        const Obb before = scene.world_boxes()[on_other];
        REQUIRE(scene.set_local(hand, moved(2.0)).has_value());
        REQUIRE(scene.set_local(arm, moved(3.0)).has_value());
        const UpdateStatistics two = scene.update();
        CHECK(two.nodes_updated == 2);
        CHECK(two.instances_updated == 1);
        REQUIRE(scene.moved_instances().size() == 1);
        CHECK(scene.moved_instances()[0] == on_hand);
        CHECK(scene.world(hand).translation.x == 5.0);
        CHECK(std::memcmp(&before, &scene.world_boxes()[on_other], sizeof before) == 0);
    }

    TEST_CASE("a transform set to what it was moves nothing") {
        Scene scene = random_scene(3, 50);
        scene.update();
        CHECK(scene.moved_instances().size() == 50);
        REQUIRE(scene.set_local(0, Transform(scene.local(0))).has_value());
        CHECK(scene.update().nodes_updated > 0);
        CHECK(scene.moved_instances().empty());
    }

    TEST_CASE("a layer mask is the node's and all its ancestors'") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId root = scene.add_node(kNone, {}, 0b0110).value();
        const NodeId child = scene.add_node(root, {}, 0b0011).value();
        const InstanceId instance = scene.add_instance(child, mesh).value();
        scene.update();
        CHECK(scene.layer_masks()[instance] == 0b0010);
        REQUIRE(scene.set_layer_mask(root, 0b1001).has_value());
        scene.update();
        CHECK(scene.layer_masks()[instance] == 0b0001);
        CHECK(scene.moved_instances().empty());
    }

    TEST_CASE("a removed instance is masked at once, the others keep their ids, and its own is given out again") {
        Scene scene;
        const MeshId mesh = scene.add_mesh(tetrahedron()).value();
        const NodeId node = scene.add_node(kNone, {}).value();
        const InstanceId a = scene.add_instance(node, mesh).value();
        const InstanceId b = scene.add_instance(node, mesh).value();
        scene.update();
        REQUIRE(scene.remove_instance(a).has_value());
        CHECK(scene.layer_masks()[a] == 0);
        CHECK(scene.is_removed(a));
        REQUIRE(scene.set_local(node, moved(4.0)).has_value());
        CHECK(scene.update().instances_updated == 1);
        CHECK(scene.layer_masks()[a] == 0);
        CHECK(scene.layer_masks()[b] == ~0u);
        CHECK(error_of(scene.remove_instance(a)).code == ErrorCode::invalid_argument);
        CHECK(scene.add_instance(node, mesh).value() == a);
    }

    TEST_CASE("updates in steps, in one go and on four threads give the same bits") {
        Scene steps = random_scene(11, 3000), once = random_scene(11, 3000), threads = random_scene(11, 3000);
        ThreadPool pool(4);
        std::mt19937 random(5);
        steps.update();
        threads.update(pool);
        for (int k = 0; k < 200; ++k) {
            const NodeId node = static_cast<NodeId>(random() % 3000);
            const Transform local = moved(0.01 * k, 1.0);
            REQUIRE(steps.set_local(node, local).has_value());
            REQUIRE(once.set_local(node, local).has_value());
            REQUIRE(threads.set_local(node, local).has_value());
            steps.update();
        }
        once.update();
        threads.update(pool);
        CHECK(same_boxes(steps, once));
        CHECK(same_boxes(threads, once));
    }

    TEST_CASE("world boxes contain the transformed vertices through a deep random forest") {
        Scene scene = random_scene(21, 2000);
        scene.update();
        for (InstanceId i = 0; i < scene.instance_count(); ++i) {
            const Obb& box = scene.world_boxes()[i];
            Obb grown = box;  // the image below is itself rounded to double
            grown.half_extents += glm::vec3(1e-12f * static_cast<float>(1.0 + glm::length(box.center)));
            for (const glm::vec3& p : scene.mesh(scene.mesh_of(i)).positions)
                CHECK(contains(grown, scene.world(scene.node_of(i)) * glm::dvec3(p)));
        }
    }

    TEST_CASE("a polygon becomes a mesh that remembers it") {
        PlanarPolygon p;
        p.polygon.points = {{0, 0}, {4, 0}, {0, 4}};
        p.polygon.ring_ends = {3};
        constexpr std::array<std::array<std::uint32_t, 3>, 1> triangles = {{{0, 1, 2}}};
        Scene scene;
        const MeshId flat = scene.add_polygon(p, triangles, "gable").value();
        const MeshId solid = scene.add_mesh(tetrahedron()).value();
        REQUIRE(scene.polygon(flat) != nullptr);
        CHECK(scene.polygon(flat)->polygon.points.size() == 3);
        CHECK(scene.polygon(solid) == nullptr);
        CHECK(scene.mesh_name(flat) == "gable");
        p.polygon.ring_ends = {2};
        CHECK_FALSE(scene.add_polygon(p, triangles).has_value());
        CHECK(scene.mesh_count() == 2);
    }
}
