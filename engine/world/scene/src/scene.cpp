// SPDX-License-Identifier: MIT
#include <algorithm>
#include <crofton/core/error.hpp>
#include <crofton/core/recovery.hpp>
#include <new>
#include <utility>

#include "scene_checks.hpp"

namespace crofton::scene {
namespace {

// An id for a new item: one given back, or the next of all arrays, which `grow` lengthens by one.
template <class Grow>
std::uint32_t take_id(Vector<std::uint32_t>& free, std::size_t count, Grow grow) {
    if (free.empty()) {
        grow();
        return static_cast<std::uint32_t>(count);
    }
    const std::uint32_t id = free.back();
    free.pop_back();
    return id;
}

// So that the next element needs no memory. Grows as push_back would.
template <class... Arrays>
void reserve_one(Arrays&... arrays) {
    const auto reserve = [](auto& array) {
        if (array.size() == array.capacity()) array.reserve(std::max<std::size_t>(8, 2 * array.size()));
    };
    (reserve(arrays), ...);
}

}  // namespace

Scene::Scene(const SceneOptions& options) : state_(new (detail::allocate(sizeof(State), alignof(State))) State) {
    CROFTON_ASSERT(measure::validate(options.criterion).has_value(), "the criterion's weights are invalid");
    state_->options = options;
}
void Scene::Release::operator()(State* state) const {
    state->~State();
    detail::release(state, sizeof(State), alignof(State));
}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

Result<MeshId> Scene::add_mesh(TriangleMesh mesh, std::string_view name, const Obb* box) {
    return detail::recover([&]() -> Result<MeshId> {
        State& s = *state_;
        if (auto room = check_room(s.meshes, s.free_meshes, "meshes"); !room) return room.error();
        auto record = make_record(std::move(mesh), name, box, s.options.criterion);
        if (!record) return record.error();
        reserve_one(s.meshes);
        const MeshId id = take_id(s.free_meshes, s.meshes.size(), [&] { s.meshes.emplace_back(); });
        record->revision = ++s.last_revision;
        s.meshes[id] = std::move(*record);
        return id;
    });
}

Result<MeshId> Scene::add_polygon(PlanarPolygon polygon, std::span<const std::array<std::uint32_t, 3>> triangles,
                                  std::string_view name) {
    return detail::recover([&]() -> Result<MeshId> {
        auto mesh = to_mesh(polygon, triangles);
        if (!mesh) return mesh.error();
        auto id = add_mesh(std::move(*mesh), name);
        if (id) state_->meshes[*id].polygon = std::move(polygon);
        return id;
    });
}

Result<NodeId> Scene::add_node(NodeId parent, const Transform& local, std::uint32_t layer_mask, std::string_view name) {
    return detail::recover([&]() -> Result<NodeId> {
        State& s = *state_;
        if (auto room = check_room(s.nodes, s.free_nodes, "nodes"); !room) return room.error();
        if (parent != kNone)
            if (auto known = check_node(s.nodes, parent, "parent node"); !known) return known.error();
        if (auto valid = validate(local, s.free_nodes.empty() ? s.nodes.size() : s.free_nodes.back()); !valid)
            return valid.error();
        // All that needs memory comes first: without any, the scene stays as it was.
        String own_name(name);
        reserve_one(s.nodes, s.locals, s.worlds, s.node_names);
        s.order.reserve_one();
        s.dirty.resize(s.order.size() + 1);
        const NodeId id = take_id(s.free_nodes, s.nodes.size(), [&] {
            s.nodes.emplace_back();
            s.locals.emplace_back();
            s.worlds.emplace_back();
            s.node_names.emplace_back();
        });
        s.nodes[id].own_mask = layer_mask;
        s.locals[id] = local;
        s.node_names[id] = std::move(own_name);
        s.link_to_parent(id, parent);
        s.append_to_order(id);
        s.mark_dirty(id);
        return id;
    });
}

Result<InstanceId> Scene::add_instance(NodeId node, MeshId mesh) {
    return detail::recover([&]() -> Result<InstanceId> {
        State& s = *state_;
        if (auto room = check_room(s.instances, s.free_instances, "instances"); !room) return room.error();
        if (auto known = check_node(s.nodes, node); !known) return known.error();
        if (auto known = check_mesh(s.meshes, mesh); !known) return known.error();
        reserve_one(s.instances, s.boxes, s.masks);
        s.touched.resize(s.instances.size() + 1);
        const InstanceId id = take_id(s.free_instances, s.instances.size(), [&] {
            s.instances.emplace_back();
            s.boxes.emplace_back();
            s.masks.push_back(0);
            s.touched.resize(s.instances.size());
        });
        s.boxes[id] = Obb();
        Instance& instance = s.instances[id];
        instance = Instance();
        instance.node = node;
        instance.next_on_node = std::exchange(s.nodes[node].first_instance, id);
        if (instance.next_on_node != kNone) s.instances[instance.next_on_node].previous_on_node = id;
        s.link_to_mesh(id, mesh);
        s.touched.insert(id);
        return id;
    });
}

std::size_t Scene::node_count() const {
    return state_->nodes.size();
}
std::size_t Scene::mesh_count() const {
    return state_->meshes.size();
}
std::size_t Scene::instance_count() const {
    return state_->instances.size();
}
bool Scene::is_removed(InstanceId instance) const {
    return state_->instances[instance].node == kRemoved;
}
bool Scene::is_node_removed(NodeId node) const {
    return state_->nodes[node].position == kRemoved;
}
bool Scene::is_mesh_removed(MeshId mesh) const {
    return state_->meshes[mesh].revision == 0;
}
const TriangleMesh& Scene::mesh(MeshId mesh) const {
    return state_->meshes[mesh].mesh;
}
const PlanarPolygon* Scene::polygon(MeshId mesh) const {
    const auto& polygon = state_->meshes[mesh].polygon;
    return polygon ? &*polygon : nullptr;
}
const Obb& Scene::mesh_box(MeshId mesh) const {
    return state_->meshes[mesh].box;
}
std::string_view Scene::mesh_name(MeshId mesh) const {
    return state_->meshes[mesh].name;
}
std::uint64_t Scene::mesh_revision(MeshId mesh) const {
    return state_->meshes[mesh].revision;
}
NodeId Scene::node_of(InstanceId instance) const {
    return state_->instances[instance].node;
}
MeshId Scene::mesh_of(InstanceId instance) const {
    return state_->instances[instance].mesh;
}
NodeId Scene::parent_of(NodeId node) const {
    return state_->nodes[node].parent;
}
std::string_view Scene::node_name(NodeId node) const {
    return state_->node_names[node];
}
void Scene::visit_subtree(NodeId root, FunctionRef<void(NodeId)> on_node,
                          FunctionRef<void(InstanceId)> on_instance) const {
    const State& s = *state_;
    NodeId at = root;
    for (;;) {
        on_node(at);
        for (InstanceId i = s.nodes[at].first_instance; i != kNone; i = s.instances[i].next_on_node) on_instance(i);
        if (s.nodes[at].first_child != kNone) {
            at = s.nodes[at].first_child;
            continue;
        }
        while (at != root && s.nodes[at].next_sibling == kNone) at = s.nodes[at].parent;
        if (at == root) return;
        at = s.nodes[at].next_sibling;
    }
}
const Transform& Scene::local(NodeId node) const {
    return state_->locals[node];
}
const Transform& Scene::world(NodeId node) const {
    return state_->worlds[node];
}
std::span<const Obb> Scene::world_boxes() const {
    return state_->boxes;
}
std::span<const std::uint32_t> Scene::layer_masks() const {
    return state_->masks;
}
std::span<const InstanceId> Scene::moved_instances() const {
    return state_->moved;
}
std::span<const InstanceId> Scene::relayered_instances() const {
    return state_->relayered;
}
std::span<const InstanceId> Scene::removed_instances() const {
    return state_->removed;
}

}  // namespace crofton::scene
