// SPDX-License-Identifier: MIT
// A scene and a plain model of it, under the same random edits.
#pragma once
#include <doctest/doctest.h>
#include <crofton/scene/scene.hpp>
#include <cstring>
#include <error_of.hpp>
#include <map>
#include <random>
#include <vector>

#include "oracle/plain_scene.hpp"

namespace crofton::scene::edit_test {

inline TriangleMesh tetrahedron(float size = 1.0f) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    return mesh;
}

inline Transform moved(double x, double y = 0.0, double z = 0.0) {
    return {glm::dmat3(1.0), {x, y, z}};
}

template <class T>
std::vector<T> list(std::span<const T> values) {
    return {values.begin(), values.end()};
}
using Ids = std::vector<std::uint32_t>;

template <class T>
T pick(const std::vector<T>& from, std::mt19937& random) {
    return from[random() % from.size()];
}

template <class Map>
std::vector<std::uint32_t> keys(const Map& map) {
    std::vector<std::uint32_t> result;
    for (const auto& entry : map) result.push_back(entry.first);
    return result;
}

// A scene and its oracle under the same edits.
struct Pair {
    Scene scene;
    testing::PlainScene plain;
    std::mt19937 random;

    explicit Pair(std::uint32_t seed) : random(seed) {
        for (int m = 0; m < 3; ++m) add_mesh();
    }

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

    Transform transform() {
        const glm::dquat turn =
            glm::normalize(glm::dquat(1.0, number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)));
        glm::dvec3 scale(number(0.5, 1.5));
        switch (random() % 12) {
            case 0:
                scale = {number(0.5, 2.0), number(0.5, 2.0), number(0.5, 2.0)};
                break;
            case 1:
                scale.x = -scale.x;
                break;
            case 2:
                scale = glm::dvec3(0.0);
                break;
            case 3:
                scale[static_cast<int>(random() % 3)] = 0.0;
                break;
            case 4:
                scale = glm::dvec3(1e14);
                break;
            case 5:
                scale = glm::dvec3(1e-14);
                break;
            default:
                break;
        }
        return from_trs({number(-9.0, 9.0), number(-9.0, 9.0), number(-9.0, 9.0)}, turn, scale).value();
    }

    void add_mesh() {
        const MeshId mesh = scene.add_mesh(tetrahedron(static_cast<float>(number(0.5, 2.0)))).value();
        plain.mesh_boxes[mesh] = scene.mesh_box(mesh);
    }

    void add_node() {
        const auto ids = keys(plain.nodes);
        const NodeId parent = ids.empty() || random() % 4 == 0 ? kNone : pick(ids, random);
        const Transform local = transform();
        const std::uint32_t mask = random() % 3 == 0 ? static_cast<std::uint32_t>(random()) : ~0u;
        const NodeId node = scene.add_node(parent, local, mask).value();
        REQUIRE(!plain.nodes.contains(node));
        plain.nodes[node] = {parent, local, mask};
    }

    void add_instance() {
        const NodeId node = pick(keys(plain.nodes), random);
        const MeshId mesh = pick(keys(plain.mesh_boxes), random);
        const InstanceId instance = scene.add_instance(node, mesh).value();
        REQUIRE(!plain.instances.contains(instance));
        plain.instances[instance] = {node, mesh, ~0u};
    }

    void edit_node(NodeId node) {
        switch (random() % 8) {
            case 0: {
                std::set<NodeId> below, expected;
                std::set<InstanceId> on, expected_on;
                scene.visit_subtree(
                    node,
                    [&](NodeId n) {
                        CHECK((n == node || below.contains(scene.parent_of(n))));
                        CHECK(below.insert(n).second);
                    },
                    [&](InstanceId i) { CHECK(on.insert(i).second); });
                for (const auto& entry : plain.nodes)
                    if (plain.is_below(entry.first, node)) expected.insert(entry.first);
                for (const auto& [i, instance] : plain.instances)
                    if (plain.is_below(instance.node, node)) expected_on.insert(i);
                CHECK(below == expected);
                CHECK(on == expected_on);
                REQUIRE(scene.remove_node(node).has_value());
                plain.remove_node(node);
                break;
            }
            case 1:
                plain.nodes[node].mask = static_cast<std::uint32_t>(random());
                REQUIRE(scene.set_layer_mask(node, plain.nodes[node].mask).has_value());
                break;
            case 2:
            case 3:
            case 4: {
                const NodeId parent = random() % 5 == 0 ? kNone : pick(keys(plain.nodes), random);
                const bool cycle = parent != kNone && plain.is_below(parent, node);
                const auto result = scene.set_parent(node, parent);
                CHECK(result.has_value() == !cycle);
                if (cycle) CHECK(error_of(result).code == ErrorCode::invalid_argument);
                if (!cycle) plain.nodes[node].parent = parent;
                break;
            }
            default:
                plain.nodes[node].local = transform();
                REQUIRE(scene.set_local(node, plain.nodes[node].local).has_value());
        }
    }

    void edit_instance(InstanceId instance) {
        switch (random() % 3) {
            case 0:
                REQUIRE(scene.remove_instance(instance).has_value());
                plain.remove_instance(instance);
                break;
            case 1:
                plain.instances[instance].mesh = pick(keys(plain.mesh_boxes), random);
                REQUIRE(scene.set_instance_mesh(instance, plain.instances[instance].mesh).has_value());
                break;
            default:
                plain.instances[instance].mask = static_cast<std::uint32_t>(random());
                REQUIRE(scene.set_instance_layers(instance, plain.instances[instance].mask).has_value());
        }
    }

    void edit_mesh(MeshId mesh) {
        const TriangleMesh shape = tetrahedron(static_cast<float>(number(0.5, 2.0)));
        bool used = false;
        for (const auto& [id, instance] : plain.instances) used = used || instance.mesh == mesh;
        switch (random() % 3) {
            case 0:
                REQUIRE(scene.replace_mesh(mesh, shape).has_value());
                break;
            case 1:
                REQUIRE(scene.set_vertices(mesh, shape.positions).has_value());
                break;
            default:
                if (plain.mesh_boxes.size() == 1) return;
                CHECK(scene.remove_mesh(mesh).has_value() == !used);
                if (!used) plain.mesh_boxes.erase(mesh);
                add_mesh();
                return;
        }
        plain.mesh_boxes[mesh] = scene.mesh_box(mesh);
    }

    void edit() {
        const auto what = random() % 100;
        if (what < 25 || plain.nodes.empty())
            add_node();
        else if (what < 55)
            add_instance();
        else if (what < 80)
            edit_node(pick(keys(plain.nodes), random));
        else if (what < 97 && !plain.instances.empty())
            edit_instance(pick(keys(plain.instances), random));
        else
            edit_mesh(pick(keys(plain.mesh_boxes), random));
    }

    void update_and_compare(Executor& executor) {
        const std::vector<Obb> boxes = list(scene.world_boxes());
        std::map<InstanceId, std::uint32_t> masks;
        for (const auto& [id, instance] : plain.instances) masks[id] = scene.layer_masks()[id];
        scene.update(executor);
        Ids moved, relayered;
        for (auto& [id, instance] : plain.instances) {
            const auto answer = plain.answer(instance);
            const Obb& box = scene.world_boxes()[id];
            const Obb expected = answer.box ? *answer.box : boxes[id];
            CHECK(std::memcmp(&box, &expected, sizeof box) == 0);
            CHECK(scene.layer_masks()[id] == answer.mask);
            if (instance.is_new || answer.mask != masks[id]) relayered.push_back(id);
            if (plain.settle(instance, answer, boxes[id], box)) moved.push_back(id);
        }
        CHECK(list(scene.moved_instances()) == moved);
        CHECK(list(scene.relayered_instances()) == relayered);
        CHECK(list(scene.removed_instances()) == Ids(plain.removed.begin(), plain.removed.end()));
        plain.removed.clear();
        for (InstanceId i = 0; i < scene.instance_count(); ++i) {
            CHECK(scene.is_removed(i) == !plain.instances.contains(i));
            if (scene.is_removed(i)) CHECK(scene.layer_masks()[i] == 0);
        }
        for (NodeId n = 0; n < scene.node_count(); ++n) CHECK(scene.is_node_removed(n) == !plain.nodes.contains(n));
    }
};

}  // namespace crofton::scene::edit_test
