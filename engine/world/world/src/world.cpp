// SPDX-License-Identifier: MIT
#include <chrono>
#include <crofton/boxtree/box_tree.hpp>
#include <crofton/core/memory.hpp>
#include <utility>

#include "trace_zone.hpp"
#include "world_state.hpp"

namespace crofton {

World::World(const WorldOptions& options) : state_(Owner<State>::make(options)) {}
World::World(const WorldOptions& options, std::uint32_t first_generation)
    : state_(Owner<State>::make(options, first_generation)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

World::StateOwner::StateOwner(Owner<State> state) : state_(std::move(state)) {}
World::State* World::StateOwner::renew() {
    state_ = Owner<State>::make(WorldOptions{});
    return state_.get();
}
World::State* World::StateOwner::empty() {
    static State state{WorldOptions{}};
    return &state;
}

constinit thread_local const World::State::Call* World::State::Call::innermost_ = nullptr;

Result<void> World::State::check_outside() const {
    if (!Call::is_within(*this, false)) return {};
    return fail(ErrorCode::invalid_argument, kNoItem, "World: a callback of a view or update may not change the World");
}
Result<void> World::State::check_updated() const {
    if (!is_updating()) return {};
    return fail(ErrorCode::invalid_argument, kNoItem, "World: a callback of an update may not ask the World");
}

bool World::contains(ObjectHandle object) const {
    if (world::is_region_index(object.index)) return state_->regions.contains(object);
    return state_->table.contains(object);
}
bool World::contains(MeshHandle mesh) const {
    return state_->meshes.contains(mesh);
}
bool World::contains(NodeHandle node) const {
    return state_->nodes.contains(node);
}
std::size_t World::object_count() const {
    return state_->table.count + state_->regions.object_count();
}
const WorldStatistics& World::statistics() const {
    return state_->statistics;
}
const boxtree::BoxTree& World::tree() const {
    return state_->index.tree();
}
std::span<const ObjectPair> World::pairs() const {
    if (state_->is_updating()) return {};
    return state_->region_pairs.is_used() ? state_->region_pairs.pairs() : state_->own_pairs();
}
std::span<const Contact> World::contacts() const {
    const State& s = *state_;
    if (s.is_updating()) return {};
    return s.contact_list.get(s.region_pairs.is_used() ? s.region_pairs.contacts() : s.own_contacts(),
                              s.shape_contacts.contacts());
}

Result<RegionHandle> World::attach(const Region& region, const glm::dvec3& origin) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return state_->regions.attach(region, origin);
}
Result<void> World::detach(RegionHandle region) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return state_->regions.detach(region);
}
bool World::contains(RegionHandle region) const {
    return state_->regions.contains(region);
}

Result<ObjectHandle> World::object_in(RegionHandle region, std::uint32_t place) const {
    if (auto known = state_->regions.check(region); !known) return known.error();
    const world::Attachment& attachment = state_->regions.at(region);
    if (place >= attachment.size())
        return fail(ErrorCode::out_of_range, place, {"world: the region has ", attachment.size(), " objects"});
    return ObjectHandle{attachment.first + place, attachment.generation};
}

Result<RegionPlace> World::place_of(ObjectHandle object) const {
    const world::Regions& regions = state_->regions;
    if (regions.contains(object))
        return RegionPlace{regions.handle_of(object.index), object.index - regions.of(object.index).first};
    if (auto known = state_->check(object, object.index); !known) return known.error();
    return fail(ErrorCode::invalid_argument, object.index, "world: the object is of no region: World::add added it");
}

Result<std::uint64_t> World::user_of(ObjectHandle object) const {
    if (state_->regions.contains(object)) return state_->regions.ref(object.index).user;
    if (auto known = state_->check(object, object.index); !known) return known.error();
    return state_->table.users[object.index];
}

Result<Obb> World::box_of(ObjectHandle object) const {
    if (state_->regions.contains(object)) return state_->regions.box(object.index);
    if (auto known = state_->check(object, object.index); !known) return known.error();
    if (!state_->index.has_box(object.index))
        return fail(ErrorCode::empty, object.index,
                    "world: the object has no box before the first update after it was added");
    return state_->index.box(object.index);
}

Result<Transform> World::transform_of(ObjectHandle object) const {
    if (const world::Regions& regions = state_->regions; regions.contains(object)) {
        if (regions.has_transform(object.index)) return regions.transform(object.index);
        return fail(ErrorCode::invalid_argument, object.index, "world: the object is a bound and has no transform");
    }
    if (auto known = state_->check(object, object.index); !known) return known.error();
    const std::uint32_t instance = state_->table.objects[object.index].instance;
    if (instance == kNoIndex)
        return fail(ErrorCode::invalid_argument, object.index, "world: the object is a bound and has no transform");
    if (!state_->index.has_box(object.index))
        return fail(ErrorCode::empty, object.index,
                    "world: the object has no transform to the world before the first update after it was added");
    return state_->scene.world(state_->scene.node_of(instance));
}

void World::State::apply_changes() {
    for (std::size_t n = 0; n < removed.size(); ++n) {
        const std::uint32_t object = removed[n];
        index.fetch_ahead(n, removed.size(), [&](std::size_t later) { return removed[later]; });
        index.remove(object);
        shapes.forget(object);
        if (object_shapes.has(object)) pair_changes.objects.push_back(object);  // ground has no box among the others
        object_shapes.forget(object);
        shape_contacts.note(object);
        occluders.note(object);
    }
    removed.clear();
    for (std::size_t n = 0; n < staged.size(); ++n) {
        const StagedChange& change = staged[n];
        index.fetch_ahead(n, staged.size(), [&](std::size_t later) { return staged[later].object; });
        world::Object& object = table.objects.edit(change.object);
        object.staged = kNoIndex;
        if (!object.alive) continue;
        if (object.instance != kNoIndex) {
            object.mesh = scene.mesh_of(object.instance);
            refresh_visibility(change.object);
            pair_changes.objects.push_back(change.object);
            shape_contacts.note(change.object);
            continue;
        }
        index.set_layers(change.object, object.layers);
        index.set_shown(change.object, object.shown);
        if (!change.has_bound) continue;
        update_bound(change.object, change.bound);
    }
    staged.clear();
}

// The bound as given or, where the object's shape is larger, a box around both.
void World::State::update_bound(std::uint32_t id, const Bound& given) {
    const Bound bound = object_shapes.has(id) || object_shapes.is_grown(id) ? object_shapes.cover(id, given) : given;
    world::Object& object = table.objects.edit(id);
    if (object.kind != bound.kind || object.radius != bound.radius) {
        pair_changes.objects.push_back(id);
        shape_contacts.note(id);
    }
    object.kind = bound.kind;
    object.radius = bound.radius;
    rebound.push_back(id);
    index.set_box(id, bound.box);
}

Bound World::State::bound_of(std::uint32_t id) const {
    if (object_shapes.is_grown(id)) return object_shapes.given(id);
    Bound bound(index.box(id));
    bound.kind = table.objects[id].kind;
    bound.radius = table.objects[id].radius;
    return bound;
}

// After the scene's update, and the bounds that were set. Error: a transform that does not scale its object's shape.
Result<void> World::State::update_shapes() {
    Result<void> first;
    const auto update_mesh = [&](std::uint32_t id) {
        const scene::InstanceId instance = table.objects[id].instance;
        const Transform& world = scene.world(scene.node_of(instance));
        if (!object_shapes.has(id)) return index.set_box_of_moved(id, scene.world_boxes()[instance]);
        if (auto scaled = object_shapes.scale(id, world.linear); !scaled && first) first = std::move(scaled);
        index.set_box_of_moved(id, object_shapes.cover(id, instance, scene, is_shape_alone(table.objects[id])));
    };
    for (const std::uint32_t id : object_shapes.fresh()) {
        if (!table.objects[id].alive || !index.has_box(id)) continue;
        if (table.objects[id].instance == kNoIndex)
            update_bound(id, bound_of(id));
        else
            update_mesh(id);
    }
    object_shapes.forget_fresh();
    for (const scene::InstanceId instance : scene.moved_instances()) {
        update_mesh(object_of_instance[instance]);
        occluders.note(object_of_instance[instance]);
    }
    return first;
}

// An object with a mesh, after what decides it has changed.
void World::State::refresh_visibility(std::uint32_t id) {
    const world::Object& object = table.objects[id];
    index.set_shown(id, object.shown && !object.only_occludes && scene.layer_masks()[object.instance] != 0);
    occluders.note(id);
}

// Whose box has an entry in the list for set_bounds().
void World::State::note_movers() {
    const auto note = [&](std::uint32_t id) {
        const world::Object& object = table.objects[id];
        const bool is_box = object.alive && object.kind == BoundKind::box && !object_shapes.is_grown(id);
        movers.set(table.handle(id), is_box ? index.mover_entry(id) : kNoIndex, object_shapes.least_half_extents(id));
    };
    for (const std::uint32_t id : index.relisted_items()) note(id);
    for (const std::uint32_t id : rebound) note(id);
    rebound.clear();
}

// What the scene's nodes have moved.
Result<void> World::State::apply_scene(Executor& executor) {
    scene_changed = !staged.empty() || !removed.empty();
    const scene::UpdateStatistics updated = scene.update(executor);
    scene_changed |= updated.nodes_updated > 0 || !scene.moved_instances().empty() ||
                     !scene.relayered_instances().empty() || !scene.removed_instances().empty();
    statistics.nodes_updated = updated.nodes_updated;
    statistics.out_of_range = updated.instances_invalid;
    index.commit();
    apply_changes();
    for (const scene::InstanceId instance : scene.relayered_instances()) {
        const std::uint32_t object = object_of_instance[instance], layers = scene.layer_masks()[instance];
        refresh_visibility(object);
        if (layers != 0) index.set_layers(object, layers);
    }
    auto scaled = update_shapes();
    shapes.update(scene, executor);
    scene_changed |= mesh_clusters.update(scene, executor);
    return scaled;
}

// After the update in which many objects have come at once: the next ones bring few.
void World::State::release_scratch() {
    world::release(staged, removed, rebound, pair_changes.objects);
    table.finish();
    index.release_scratch();
    finder.release_scratch();
    shape_contacts.release_scratch();
}

Result<void> World::update(Executor& executor) {
    State& s = *state_;
    if (auto outside = s.check_outside(); !outside) return outside;
    const State::Call call(s, true);
    const TraceHooks& trace = s.options.trace;
    const world::TraceZone zone(trace, "World::update");
    s.statistics = {};
    const Result<void> scaled = [&] {
        const world::TraceZone part(trace, "update: transforms");
        return s.apply_scene(executor);
    }();
    const auto changes = [&] {
        const world::TraceZone part(trace, "update: tree and movers");
        return s.index.update(
            {.rebuild_budget = s.options.rebuild_budget, .updates_to_rest = s.options.updates_to_rest}, executor);
    }();
    s.note_movers();
    const bool regions_changed = s.regions.update();
    const bool occluders_changed = [&] {
        const world::TraceZone part(trace, "update: occluders");
        return s.update_occluders();
    }();
    Result<void> found;
    const bool changed = changes.boxes > 0 || s.pair_changes.any() || regions_changed;
    if (changed || s.scene_changed || occluders_changed) s.revision.update = world::next_revision();
    const auto start = std::chrono::steady_clock::now();
    if (s.options.pairs && changed) {
        const world::TraceZone part(trace, "update: pairs and contacts");
        const auto touch_shape = [&](const IdPair& pair, world::ShapeTouch& touch) { s.touch_shape(pair, touch); };
        found = s.finder.update(s.table, s.index, s.scene, s.shapes, s.object_shapes, s.pair_changes, touch_shape,
                                executor);
        s.ground.set_used(!s.object_shapes.unbounded().empty());
        if (s.ground.is_used()) s.update_ground();
        if (s.options.contacts && s.ground.is_used()) s.update_ground_contacts();
        found = s.update_region_pairs(std::move(found));
        if (s.region_pairs.is_used()) s.region_pairs.merge(s.own_pairs(), s.own_contacts());
        if (s.options.contacts) s.update_shape_contacts(executor);
    }
    if (!s.options.pairs || !s.options.contacts) s.shape_contacts.forget_changes();
    if (!changed) {
        s.finder.stay();
        s.ground.stay();
        s.shape_contacts.stay();
        s.region_pairs.stay();
        if (s.region_pairs.is_used()) s.region_pairs.merge(s.own_pairs(), s.own_contacts());
    }
    s.contact_list.note_update(changed);
    s.statistics.contacts_us =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    s.pair_changes.clear();
    s.table.settle();
    s.pair_changes.after_error = !found;
    world::trace_count(trace, "boxes changed", changes.boxes);
    const std::size_t ground_pairs = s.ground.is_used() ? s.ground.own_pairs().size() : 0;
    world::trace_count(trace, "pairs", s.finder.pair_count() + ground_pairs);
    s.statistics.objects = s.table.count + s.regions.object_count();
    s.statistics.resting = s.index.tree().item_count();
    s.statistics.moving = s.index.moving().size();
    s.statistics.boxes_changed = changes.boxes;
    s.statistics.tree_built = changes.tree_built;
    s.statistics.box_pairs_tested = changed ? s.finder.broadphase().bound_pairs : 0;
    if (changed) s.statistics.box_tests = s.finder.broadphase().boxes;
    s.statistics.shape_pairs_computed = s.options.pairs && s.options.contacts ? s.shape_contacts.computed() : 0;
    s.statistics.contact_pairs_tested = changed ? s.finder.tested_count() + ground_pairs : 0;
    if (changes.tree_built) s.release_scratch();
    return found ? scaled : found;
}

}  // namespace crofton
