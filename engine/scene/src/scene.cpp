#include <crofton/core/assert.hpp>
#include <crofton/fit/fit.hpp>
#include <utility>

#include "scene_state.hpp"

namespace crofton::scene {
namespace {

constexpr std::size_t kMaxItems = std::size_t{1} << 31;

template <class T>
Result<void> check_room(const Vector<T>& items, const char* what) {
    if (items.size() < kMaxItems) return {};
    return fail(ErrorCode::out_of_range, items.size(), std::string("scene: more than 2^31 ") + what);
}

Result<void> check_id(std::uint32_t id, std::size_t count, const char* what) {
    if (id < count) return {};
    return fail(ErrorCode::out_of_range, id,
                std::string("scene: ") + what + " " + std::to_string(id) + " does not exist, there are " +
                    std::to_string(count));
}

Result<MeshRecord> make_record(TriangleMesh mesh, std::string name, const measure::Criterion& criterion) {
    if (mesh.indices.empty() || mesh.positions.empty())
        return fail(ErrorCode::empty, kNoItem, "mesh: it has no triangles" + (name.empty() ? "" : " (" + name + ")"));
    if (auto valid = validate(mesh); !valid) return tl::unexpected(valid.error());
    auto box = fit::fit_obb(std::span<const glm::vec3>(mesh.positions), fit::FitOptions{.criterion = criterion});
    if (!box) return tl::unexpected(box.error());
    MeshRecord record;
    record.mesh = std::move(mesh);
    record.box = *box;
    record.name = std::move(name);
    return record;
}

}  // namespace

Scene::Scene(const SceneOptions& options) : state_(std::make_unique<State>()) {
    CROFTON_ASSERT(measure::validate(options.criterion).has_value(), "the criterion's weights are invalid");
    state_->options = options;
}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

Result<MeshId> Scene::add_mesh(TriangleMesh mesh, std::string name) {
    if (auto room = check_room(state_->meshes, "meshes"); !room) return tl::unexpected(room.error());
    auto record = make_record(std::move(mesh), std::move(name), state_->options.criterion);
    if (!record) return tl::unexpected(record.error());
    state_->meshes.push_back(std::move(*record));
    return static_cast<MeshId>(state_->meshes.size() - 1);
}

Result<MeshId> Scene::add_polygon(PlanarPolygon polygon, std::span<const std::array<std::uint32_t, 3>> triangles,
                                  std::string name) {
    auto mesh = to_mesh(polygon, triangles);
    if (!mesh) return tl::unexpected(mesh.error());
    auto id = add_mesh(std::move(*mesh), std::move(name));
    if (id) state_->meshes[*id].polygon = std::make_unique<PlanarPolygon>(std::move(polygon));
    return id;
}

Result<NodeId> Scene::add_node(NodeId parent, const Transform& local, std::uint32_t layer_mask, std::string name) {
    State& s = *state_;
    if (auto room = check_room(s.nodes, "nodes"); !room) return tl::unexpected(room.error());
    if (parent != kNone)
        if (auto known = check_id(parent, s.nodes.size(), "parent node"); !known) return tl::unexpected(known.error());
    if (auto valid = validate(local, s.nodes.size()); !valid) return tl::unexpected(valid.error());
    const NodeId id = static_cast<NodeId>(s.nodes.size());
    Node node;
    node.local = local;
    node.parent = parent;
    node.own_mask = layer_mask;
    if (parent != kNone) node.next_sibling = std::exchange(s.nodes[parent].first_child, id);
    s.nodes.push_back(node);
    s.node_names.push_back(std::move(name));
    s.mark_dirty(id);
    return id;
}

Result<InstanceId> Scene::add_instance(NodeId node, MeshId mesh) {
    State& s = *state_;
    if (auto room = check_room(s.instances, "instances"); !room) return tl::unexpected(room.error());
    if (auto known = check_id(node, s.nodes.size(), "node"); !known) return tl::unexpected(known.error());
    if (auto known = check_id(mesh, s.meshes.size(), "mesh"); !known) return tl::unexpected(known.error());
    const InstanceId id = static_cast<InstanceId>(s.instances.size());
    Instance instance;
    instance.node = node;
    instance.mesh = mesh;
    instance.next_on_node = std::exchange(s.nodes[node].first_instance, id);
    s.instances.push_back(instance);
    s.boxes.emplace_back();
    s.masks.push_back(0);
    s.added_instances.push_back(id);
    return id;
}

Result<void> Scene::set_local(NodeId node, const Transform& local) {
    if (auto known = check_id(node, state_->nodes.size(), "node"); !known) return known;
    if (auto valid = validate(local, node); !valid) return valid;
    state_->nodes[node].local = local;
    state_->mark_dirty(node);
    return {};
}

Result<void> Scene::set_layer_mask(NodeId node, std::uint32_t layer_mask) {
    if (auto known = check_id(node, state_->nodes.size(), "node"); !known) return known;
    state_->nodes[node].own_mask = layer_mask;
    state_->mark_dirty(node);
    return {};
}

Result<void> Scene::remove_instance(InstanceId instance) {
    State& s = *state_;
    if (auto known = check_id(instance, s.instances.size(), "instance"); !known) return known;
    if (s.instances[instance].removed)
        return fail(ErrorCode::invalid_argument, instance,
                    "scene: instance " + std::to_string(instance) + " was removed before");
    s.instances[instance].removed = true;
    s.masks[instance] = 0;
    InstanceId* link = &s.nodes[s.instances[instance].node].first_instance;
    while (*link != instance) link = &s.instances[*link].next_on_node;
    *link = s.instances[instance].next_on_node;
    return {};
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
    return state_->instances[instance].removed;
}
const TriangleMesh& Scene::mesh(MeshId mesh) const {
    return state_->meshes[mesh].mesh;
}
const PlanarPolygon* Scene::polygon(MeshId mesh) const {
    return state_->meshes[mesh].polygon.get();
}
const Obb& Scene::mesh_box(MeshId mesh) const {
    return state_->meshes[mesh].box;
}
const std::string& Scene::mesh_name(MeshId mesh) const {
    return state_->meshes[mesh].name;
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
const std::string& Scene::node_name(NodeId node) const {
    return state_->node_names[node];
}
const Transform& Scene::local(NodeId node) const {
    return state_->nodes[node].local;
}
const Transform& Scene::world(NodeId node) const {
    return state_->nodes[node].world;
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

}  // namespace crofton::scene
