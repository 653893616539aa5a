// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/core/recovery.hpp>
#include <crofton/fit/fit.hpp>
#include <utility>

#include <crofton/geometry/valid_transform.hpp>
#include "scene_checks.hpp"

namespace crofton::scene {

Result<void> Scene::set_local(NodeId node, const Transform& local) {
    State& s = *state_;
    if (!is_node(s.nodes, node)) return check_node(s.nodes, node);
    if (!is_valid(local)) return validate(local, node);
    s.locals[node] = local;
    s.mark_dirty(node);
    return {};
}

Result<void> Scene::set_local(std::span<const NodeId> nodes, std::span<const Transform> locals) {
    State& s = *state_;
    if (nodes.size() != locals.size())
        return fail(ErrorCode::invalid_argument, locals.size(),
                    {"scene: ", nodes.size(), " nodes and ", locals.size(), " transforms, give as many of each"});
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_node(s.nodes, nodes[i]) && is_valid(locals[i])) continue;
        Result<void> good = check_node(s.nodes, nodes[i]);
        if (good) good = validate(locals[i], i);
        return fail(good.error().code, i, {good.error().message, " (entry ", i, ", node ", nodes[i], ")"});
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        s.locals[nodes[i]] = locals[i];
        s.mark_dirty(nodes[i]);
    }
    return {};
}

Result<void> Scene::set_layer_mask(NodeId node, std::uint32_t layer_mask) {
    State& s = *state_;
    if (auto known = check_node(s.nodes, node); !known) return known;
    s.nodes[node].own_mask = layer_mask;
    s.mark_dirty(node);
    return {};
}

// Whoever is below a node comes after it in the topological order. So the way up from the parent ends where it has
// passed the node's position. A parent that comes first needs no look at its ancestors.
Result<void> Scene::set_parent(NodeId node, NodeId parent) {
    State& s = *state_;
    if (auto known = check_node(s.nodes, node); !known) return known;
    if (parent != kNone)
        if (auto known = check_node(s.nodes, parent, "parent node"); !known) return known;
    if (s.nodes[node].parent == parent) return {};
    const std::uint32_t position = s.nodes[node].position;
    for (NodeId a = parent; a != kNone && s.nodes[a].position >= position; a = s.nodes[a].parent)
        if (a == node)
            return fail(ErrorCode::invalid_argument, node,
                        {"scene: node ", parent, " is node ", node, " or below it, so it cannot be its parent"});
    s.unlink_from_parent(node);
    s.link_to_parent(node, parent);
    if (parent != kNone && s.nodes[parent].position > position) {
        s.list_subtree(node, s.nodes_scratch);
        for (const NodeId moved : s.nodes_scratch) {
            s.dirty.erase(s.nodes[moved].position);
            s.order.remove_at(s.nodes[moved].position);
        }
        for (const NodeId moved : s.nodes_scratch) s.append_to_order(moved);
    }
    s.mark_dirty(node);
    return {};
}

Result<void> Scene::set_instance_mesh(InstanceId instance, MeshId mesh) {
    State& s = *state_;
    if (auto known = check_instance(s.instances, instance); !known) return known;
    if (auto known = check_mesh(s.meshes, mesh); !known) return known;
    s.unlink_from_mesh(instance);
    s.link_to_mesh(instance, mesh);
    s.touched.insert(instance);
    s.instances[instance].is_moved = true;
    return {};
}

Result<void> Scene::set_instance_layers(InstanceId instance, std::uint32_t layer_mask) {
    State& s = *state_;
    if (auto known = check_instance(s.instances, instance); !known) return known;
    s.instances[instance].own_mask = layer_mask;
    s.touched.insert(instance);
    return {};
}

Result<void> Scene::replace_mesh(MeshId mesh, TriangleMesh replacement, const Obb* box) {
    return detail::recover([&]() -> Result<void> {
        State& s = *state_;
        if (auto known = check_mesh(s.meshes, mesh); !known) return known;
        auto made = make_record(std::move(replacement), mesh_name(mesh), box, s.options.criterion);
        if (!made) return made.error();
        made->revision = ++s.last_revision;
        made->first_instance = s.meshes[mesh].first_instance;
        s.meshes[mesh] = std::move(*made);
        s.touch_instances_of(mesh);
        return {};
    });
}

Result<void> Scene::set_vertices(MeshId mesh, std::span<const glm::vec3> positions) {
    State& s = *state_;
    if (auto known = check_mesh(s.meshes, mesh); !known) return known;
    MeshRecord& record = s.meshes[mesh];
    if (positions.size() != record.mesh.positions.size())
        return fail(ErrorCode::invalid_argument, positions.size(),
                    {"scene: mesh ", mesh, " has ", record.mesh.positions.size(), " vertices, not ", positions.size(),
                     "; replace_mesh takes any number"});
    auto box = fit::fit_oriented(positions, record.box.axes);
    if (!box) return box.error();
    std::copy(positions.begin(), positions.end(), record.mesh.positions.begin());
    record.box = *box;
    record.revision = ++s.last_revision;
    record.polygon.reset();
    s.touch_instances_of(mesh);
    return {};
}

Result<void> Scene::remove_instance(InstanceId instance) {
    State& s = *state_;
    if (auto known = check_instance(s.instances, instance); !known) return known;
    const Instance& i = s.instances[instance];
    InstanceId& from_before =
        i.previous_on_node == kNone ? s.nodes[i.node].first_instance : s.instances[i.previous_on_node].next_on_node;
    from_before = i.next_on_node;
    if (i.next_on_node != kNone) s.instances[i.next_on_node].previous_on_node = i.previous_on_node;
    s.release_instance(instance);
    return {};
}

Result<void> Scene::remove_node(NodeId node) {
    State& s = *state_;
    if (auto known = check_node(s.nodes, node); !known) return known;
    s.unlink_from_parent(node);
    s.list_subtree(node, s.nodes_scratch);
    for (const NodeId removed : s.nodes_scratch) s.release_node(removed);
    return {};
}

Result<void> Scene::remove_mesh(MeshId mesh) {
    State& s = *state_;
    if (auto known = check_mesh(s.meshes, mesh); !known) return known;
    if (const InstanceId user = s.meshes[mesh].first_instance; user != kNone)
        return fail(ErrorCode::invalid_argument, mesh,
                    {"scene: mesh ", mesh, " is used by instance ", user,
                     "; remove its instances first or give them another mesh"});
    (void)std::exchange(s.meshes[mesh], MeshRecord());  // an assignment alone would keep the name's memory
    s.free_meshes.push_back(mesh);
    return {};
}

}  // namespace crofton::scene
