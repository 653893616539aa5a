// SPDX-License-Identifier: MIT
#include "scene_state.hpp"

#include <crofton/fit/fit.hpp>
#include <utility>

namespace crofton::scene {

namespace {

// The box that the caller knows, or one that is fitted.
Result<Obb> box_of(const TriangleMesh& mesh, const Obb* known, const measure::Criterion& criterion) {
    if (known == nullptr)
        return fit::fit_obb(std::span<const glm::vec3>(mesh.positions), fit::FitOptions{.criterion = criterion});
    if (auto valid = validate(*known); !valid) return valid.error();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        if (!contains(*known, glm::dvec3(mesh.positions[i])))
            return fail(ErrorCode::invalid_argument, i,
                        {"mesh: its box does not contain vertex ", i, ": pass the box of this mesh, or nullptr"});
    return *known;
}

}  // namespace

Result<MeshRecord> make_record(TriangleMesh mesh, std::string_view name, const Obb* known_box,
                               const measure::Criterion& criterion) {
    if (mesh.indices.empty() || mesh.positions.empty())
        return fail(ErrorCode::empty, kNoItem,
                    {"mesh: it has no triangles", name.empty() ? "" : " (", name, name.empty() ? "" : ")"});
    if (auto valid = validate(mesh); !valid) return valid.error();
    const auto box = box_of(mesh, known_box, criterion);
    if (!box) return box.error();
    MeshRecord record;
    record.mesh = std::move(mesh);
    record.box = *box;
    record.name = name;
    return record;
}

void Scene::State::append_to_order(NodeId node) {
    if (order.wants_compaction()) compact_order();
    nodes[node].position = order.append(node);
    dirty.resize(order.size());
}

void Scene::State::compact_order() {
    order.compact([&](NodeId node, std::size_t from, std::size_t to) {
        nodes[node].position = static_cast<std::uint32_t>(to);
        if (from == to || !dirty.contains(from)) return;
        dirty.erase(from);
        dirty.insert(to);
    });
}

void Scene::State::link_to_parent(NodeId node, NodeId parent) {
    Node& n = nodes[node];
    n.parent = parent;
    if (parent == kNone) return;
    NodeId& first = nodes[parent].first_child;
    if (first == kNone) {
        first = n.previous_sibling = node;
        return;
    }
    NodeId& last = nodes[first].previous_sibling;
    n.previous_sibling = last;
    nodes[last].next_sibling = node;
    last = node;
}

void Scene::State::unlink_from_parent(NodeId node) {
    Node& n = nodes[node];
    if (n.parent == kNone) return;
    NodeId& first = nodes[n.parent].first_child;
    if (n.next_sibling != kNone)
        nodes[n.next_sibling].previous_sibling = n.previous_sibling;
    else
        nodes[first].previous_sibling = n.previous_sibling;
    (first == node ? first : nodes[n.previous_sibling].next_sibling) = n.next_sibling;
    n.parent = n.next_sibling = n.previous_sibling = kNone;
}

// Parents before children: down where there is a child, else on to the next sibling of the nearest ancestor with one.
void Scene::State::list_subtree(NodeId root, Vector<NodeId>& result) const {
    result.clear();
    for (NodeId at = root; at != kNone;) {
        result.push_back(at);
        if (nodes[at].first_child != kNone) {
            at = nodes[at].first_child;
            continue;
        }
        while (at != root && nodes[at].next_sibling == kNone) at = nodes[at].parent;
        at = at == root ? kNone : nodes[at].next_sibling;
    }
}

void Scene::State::link_to_mesh(InstanceId instance, MeshId mesh) {
    Instance& i = instances[instance];
    i.mesh = mesh;
    i.previous_of_mesh = kNone;
    i.next_of_mesh = std::exchange(meshes[mesh].first_instance, instance);
    if (i.next_of_mesh != kNone) instances[i.next_of_mesh].previous_of_mesh = instance;
}

void Scene::State::unlink_from_mesh(InstanceId instance) {
    const Instance& i = instances[instance];
    (i.previous_of_mesh == kNone ? meshes[i.mesh].first_instance : instances[i.previous_of_mesh].next_of_mesh) =
        i.next_of_mesh;
    if (i.next_of_mesh != kNone) instances[i.next_of_mesh].previous_of_mesh = i.previous_of_mesh;
}

void Scene::State::touch_instances_of(MeshId mesh) {
    for (InstanceId i = meshes[mesh].first_instance; i != kNone; i = instances[i].next_of_mesh) {
        touched.insert(i);
        instances[i].is_moved = true;
    }
}

// The node's list of instances is the caller's to mend.
void Scene::State::release_instance(InstanceId instance) {
    unlink_from_mesh(instance);
    if (!instances[instance].is_new) removed_since_update.push_back(instance);
    instances[instance] = Instance();
    masks[instance] = 0;
    touched.erase(instance);
    free_instances.push_back(instance);
}

// The links of its relatives are the caller's to mend.
void Scene::State::release_node(NodeId node) {
    for (InstanceId i = nodes[node].first_instance; i != kNone;) {
        const InstanceId next = instances[i].next_on_node;
        release_instance(i);
        i = next;
    }
    dirty.erase(nodes[node].position);
    order.remove_at(nodes[node].position);
    nodes[node] = Node();
    locals[node] = worlds[node] = Transform();
    (void)std::exchange(node_names[node], String());  // an assignment alone would keep its memory
    free_nodes.push_back(node);
}

}  // namespace crofton::scene
