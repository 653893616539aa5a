// SPDX-License-Identifier: MIT
// A scene that is changed by bytes, a fuzzer's or a test's, with a plain model of it.
#pragma once
#include <crofton/scene/scene.hpp>
#include <oracle/plain_scene.hpp>
#include <set>

#include "shapes.hpp"

namespace crofton::fuzz {

class LivingScene {
  public:
    explicit LivingScene(Shapes& in) {
        add_mesh(in);
        add_mesh(in);
    }

    void change(Shapes& in) {
        const unsigned kind = in.below(12);
        if (kind < 3 || plain.nodes.empty()) return add_node(in);
        if (kind < 6) return add_instance(in);
        if (kind < 9) return change_node(in);
        if (kind < 11 && !plain.instances.empty()) return change_instance(in);
        change_mesh(in);
    }

    // Updates, and compares all that the scene says with the model.
    void settle(Executor& executor = serial_executor()) {
        const std::vector<Obb> before(scene.world_boxes().begin(), scene.world_boxes().end());
        std::map<scene::InstanceId, std::uint32_t> masks;
        for (const auto& [id, instance] : plain.instances) masks[id] = scene.layer_masks()[id];
        scene.update(executor);
        std::vector<scene::InstanceId> moved, relayered;
        for (auto& [id, instance] : plain.instances) {
            const auto answer = plain.answer(instance);
            const Obb expected = answer.box ? *answer.box : before[id];
            const Obb& box = scene.world_boxes()[id];
            demand(std::memcmp(&box, &expected, sizeof box) == 0, "an instance's box");
            demand(scene.layer_masks()[id] == answer.mask, "an instance's layers");
            if (instance.is_new || answer.mask != masks[id]) relayered.push_back(id);
            if (plain.settle(instance, answer, before[id], box)) moved.push_back(id);
        }
        const auto same = [](auto list, const auto& expected) {
            return std::equal(list.begin(), list.end(), expected.begin(), expected.end());
        };
        demand(same(scene.moved_instances(), moved), "what has moved");
        demand(same(scene.relayered_instances(), relayered), "what has other layers");
        demand(same(scene.removed_instances(), plain.removed), "what was removed");
        plain.removed.clear();
        for (scene::InstanceId i = 0; i < scene.instance_count(); ++i) {
            demand(scene.is_removed(i) == !plain.instances.contains(i), "whether an instance is there");
            demand(!scene.is_removed(i) || scene.layer_masks()[i] == 0, "the layers of what is not there");
        }
        for (scene::NodeId n = 0; n < scene.node_count(); ++n)
            demand(scene.is_node_removed(n) == !plain.nodes.contains(n), "whether a node is there");
    }

    scene::Scene scene;
    crofton::testing::PlainScene plain;

  private:
    static Transform transform(Shapes& in) {
        Transform result{in.rotation(), in.point()};
        const unsigned kind = in.below(6);
        if (kind == 0) result.linear = glm::dmat3(0.0);
        if (kind == 1) result.linear *= in.grid();
        if (kind == 2)
            for (int k = 0; k < 3; ++k) result.linear[k] *= in.grid();
        if (kind == 3) result.linear[1] = in.direction();
        if (kind == 4 && in.below(4) == 0) result.linear *= in.flag() ? 1e13 : 1e-14;
        return result;
    }
    template <class Map>
    static std::uint32_t pick(Shapes& in, const Map& map) {
        return std::next(map.begin(), in.byte() % static_cast<std::ptrdiff_t>(map.size()))->first;
    }

    void add_mesh(Shapes& in) {
        const auto mesh = scene.add_mesh(in.mesh(6, 4), in.flag() ? "mesh" : "");
        demand(mesh.has_value(), "add_mesh");
        plain.mesh_boxes[*mesh] = scene.mesh_box(*mesh);
    }
    void add_node(Shapes& in) {
        const scene::NodeId parent = plain.nodes.empty() || in.below(4) == 0 ? scene::kNone : pick(in, plain.nodes);
        const Transform local = transform(in);
        const std::uint32_t mask = in.layers();
        const auto node = scene.add_node(parent, local, mask, in.flag() ? "node" : "");
        demand(node.has_value() && !plain.nodes.contains(*node), "add_node");
        plain.nodes[*node] = {parent, local, mask};
    }
    void add_instance(Shapes& in) {
        const scene::NodeId node = pick(in, plain.nodes);
        const scene::MeshId mesh = pick(in, plain.mesh_boxes);
        const auto instance = scene.add_instance(node, mesh);
        demand(instance.has_value() && !plain.instances.contains(*instance), "add_instance");
        plain.instances[*instance] = {node, mesh, ~0u};
    }
    void visit_all_below(scene::NodeId node) const {
        std::set<scene::NodeId> below, expected;
        std::set<scene::InstanceId> on, expected_on;
        scene.visit_subtree(
            node,
            [&](scene::NodeId n) {
                demand(n == node || below.contains(scene.parent_of(n)), "parents before children");
                demand(below.insert(n).second, "a node once");
            },
            [&](scene::InstanceId i) { demand(on.insert(i).second, "an instance once"); });
        for (const auto& entry : plain.nodes)
            if (plain.is_below(entry.first, node)) expected.insert(entry.first);
        for (const auto& [i, instance] : plain.instances)
            if (plain.is_below(instance.node, node)) expected_on.insert(i);
        demand(below == expected && on == expected_on, "all below a node");
    }
    void change_node(Shapes& in) {
        const scene::NodeId node = pick(in, plain.nodes);
        switch (in.below(5)) {
            case 0:
                visit_all_below(node);
                demand(scene.remove_node(node).has_value(), "remove_node");
                return plain.remove_node(node);
            case 1:
                plain.nodes[node].mask = in.layers();
                return demand(scene.set_layer_mask(node, plain.nodes[node].mask).has_value(), "set_layer_mask");
            case 2: {
                const scene::NodeId parent = in.below(4) == 0 ? scene::kNone : pick(in, plain.nodes);
                const bool cycle = parent != scene::kNone && plain.is_below(parent, node);
                demand(scene.set_parent(node, parent).has_value() == !cycle, "set_parent");
                if (!cycle) plain.nodes[node].parent = parent;
                return;
            }
            default:
                plain.nodes[node].local = transform(in);
                demand(scene.set_local(node, plain.nodes[node].local).has_value(), "set_local");
        }
    }
    void change_instance(Shapes& in) {
        const scene::InstanceId instance = pick(in, plain.instances);
        switch (in.below(3)) {
            case 0:
                demand(scene.remove_instance(instance).has_value(), "remove_instance");
                return plain.remove_instance(instance);
            case 1:
                plain.instances[instance].mesh = pick(in, plain.mesh_boxes);
                plain.instances[instance].has_other_mesh = true;
                return demand(scene.set_instance_mesh(instance, plain.instances[instance].mesh).has_value(),
                              "set_instance_mesh");
            default:
                plain.instances[instance].mask = in.layers();
                demand(scene.set_instance_layers(instance, plain.instances[instance].mask).has_value(),
                       "set_instance_layers");
        }
    }
    void change_mesh(Shapes& in) {
        const scene::MeshId mesh = pick(in, plain.mesh_boxes);
        bool used = plain.mesh_boxes.size() == 1;
        for (const auto& [id, instance] : plain.instances) used = used || instance.mesh == mesh;
        if (!used) {
            demand(scene.remove_mesh(mesh).has_value(), "remove_mesh");
            plain.mesh_boxes.erase(mesh);
            return add_mesh(in);
        }
        if (in.flag()) {
            demand(scene.replace_mesh(mesh, in.mesh(6, 4)).has_value(), "replace_mesh");
        } else {
            auto positions = scene.mesh(mesh).positions;
            for (glm::vec3& p : positions) p = glm::vec3(in.point());
            demand(scene.set_vertices(mesh, positions).has_value(), "set_vertices");
        }
        plain.mesh_boxes[mesh] = scene.mesh_box(mesh);
        for (auto& [id, instance] : plain.instances) instance.has_other_mesh |= instance.mesh == mesh;
    }
};

}  // namespace crofton::fuzz
