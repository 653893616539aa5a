// SPDX-License-Identifier: MIT
// World's objects: adding, changing and removing them.
#include <algorithm>
#include <cmath>
#include <crofton/core/recovery.hpp>
#include <string>

#include "bound_rules.hpp"
#include "for_each_pair.hpp"
#include "require_ok.hpp"
#include "world_state.hpp"

namespace crofton {
namespace {

Result<void> validate(const Bound& bound, std::uint64_t item) {
    return world::validate(bound, item, "world: an object needs a mesh, a bound or a shape");
}

}  // namespace

Bound::Bound(const Aabb& aligned) : kind(BoundKind::aligned_box), box(obb_of(aligned)) {}

Bound::Bound(const Sphere& sphere) : kind(BoundKind::sphere), radius(sphere.radius) {
    box.center = sphere.center;
    // A little more than the float's rounding, which is 2^-150 at most where floats are subnormal.
    const double enough = sphere.radius > 0.0 ? sphere.radius * (1.0 + 0x1p-22) + 0x1p-149 : sphere.radius;
    box.half_extents = glm::vec3(static_cast<float>(enough));
}

Result<void> World::State::check(ObjectHandle object, std::uint64_t item) const {
    if (table.contains(object)) return {};
    if (world::is_region_index(object.index)) return regions.refuse_change(object, item);
    return world::refuse("object", object.index, object.generation, table.generations.view(), table.first_generation,
                         item);
}

StagedChange& World::State::stage(std::uint32_t object) {
    std::uint32_t& entry = table.objects.edit(object).staged;
    if (entry == kNoIndex) {
        entry = static_cast<std::uint32_t>(staged.size());
        staged.emplace_back();
        staged.back().object = object;
    }
    return staged[entry];
}

// What hangs on the object's node: its mesh, or a point that stands for none.
Result<scene::MeshId> World::State::mesh_of(const ObjectDescription& description) {
    if (!description.mesh.is_null()) {
        if (auto known = check(description.mesh, kNoItem); !known) return known.error();
        return description.mesh.index;
    }
    if (point != scene::kNone) return point;
    TriangleMesh mesh;
    mesh.positions = {glm::vec3(0.0f)};
    mesh.indices = {0, 0, 0};
    const auto added = scene.add_mesh(std::move(mesh));
    if (!added) return added;
    shapes.set_mesh(*added, false);
    shapes.note(*added);
    return point = *added;
}

// The instance of an object with a mesh or a shape alone, on the node that was given or on one of its own.
Result<void> World::State::attach_mesh(world::Object& object, const ObjectDescription& description) {
    const auto mesh = mesh_of(description);
    if (!mesh) return mesh.error();
    scene::NodeId node = scene::kNone;
    if (!description.node.is_null()) {
        if (auto known = check(description.node, kNoItem); !known) return known;
        node = description.node.index;
    }
    const Transform local = description.transform.value_or(Transform());
    if (description.shape != nullptr) {
        if (auto valid = crofton::validate(local, kNoItem); !valid) return valid;
        const Transform world = node == scene::kNone ? local : world_to_be(node) * local;
        if (auto scales = world::ObjectShapes::check(*description.shape, world.linear, kNoItem); !scales) return scales;
    }
    if (node == scene::kNone || description.transform) {
        const auto own = scene.add_node(node, local);
        if (!own) return own.error();
        node = object.own_node = *own;
    }
    const auto instance = scene.add_instance(node, *mesh);
    if (!instance) return instance.error();
    object.instance = *instance;
    return scene.set_instance_layers(*instance, description.layers);
}

Result<ObjectHandle> World::add(const ObjectDescription& description) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    world::Object object;
    object.layers = description.layers;
    object.collides_with = description.collides_with;
    object.occludes = description.occludes;
    object.only_occludes = description.only_occludes;
    object.shown = !description.hidden;
    const bool has_mesh = !description.mesh.is_null(), has_bound = description.bound.kind != BoundKind::none;
    const bool hangs = has_mesh || (!has_bound && description.shape != nullptr);
    if (has_mesh && has_bound)
        return fail(ErrorCode::invalid_argument, kNoItem, "world: an object has a mesh or a bound, not both");
    if (has_bound && (description.transform || !description.node.is_null()))
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "world: a bound is given in the world's coordinates, without node and transform");
    if (!has_mesh && description.only_occludes)
        return fail(ErrorCode::invalid_argument, kNoItem,
                    "world: an object that only occludes needs a mesh with occluders");
    const auto item = s.index.add(description.layers);
    if (!item) return item.error();
    if (auto valid = hangs ? s.attach_mesh(object, description) : validate(description.bound, kNoItem); !valid) {
        s.index.remove(*item);
        return valid.error();
    }
    s.table.add(*item, object, description.user);
    StagedChange& change = s.stage(*item);
    change.has_bound = !hangs;
    change.bound = description.bound;
    if (hangs) {
        if (s.object_of_instance.size() <= object.instance)
            s.object_of_instance.resize(object.instance + std::size_t{1}, kNoIndex);
        s.object_of_instance[object.instance] = *item;
    }
    if (description.shape != nullptr) world::require_ok(set_shape(s.table.handle(*item), description.shape));
    return s.table.handle(*item);
}

Result<void> World::add(Strided<ObjectDescription> descriptions, std::span<ObjectHandle> objects) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (descriptions.size() != objects.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "world: there must be as many handles as descriptions");
    state_->make_room(objects.size());
    Result<void> first;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        auto added = add(descriptions[i]);
        objects[i] = added ? *added : ObjectHandle();
        if (added || !first) continue;
        added.error().item = i;
        first = added.error();
    }
    return first;
}

Result<void> World::reserve(std::size_t objects) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return detail::recover([&] { return state_->reserve(objects); });
}

Result<void> World::State::reserve(std::size_t objects) {
    if (auto reserved = index.reserve(objects); !reserved) return reserved;
    table.reserve(objects);
    if (options.pairs) finder.reserve(objects);
    return {};
}

void World::State::make_room(std::size_t objects) {
    table.make_room(objects);
    // Twice the room at least, so that many calls for few objects copy little.
    if (staged.size() + objects > staged.capacity())
        staged.reserve(std::max(staged.size() + objects, 2 * staged.capacity()));
}

void World::State::mark_removed(std::uint32_t object) {
    table.remove(object);
    movers.forget(object);
    removed.push_back(object);
    note_removal();
}

Result<void> World::remove(ObjectHandle handle) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    if (auto known = s.check(handle, handle.index); !known) return known;
    const world::Object& object = s.table.objects[handle.index];
    s.mark_removed(handle.index);
    if (object.own_node != kNoIndex) return s.scene.remove_node(object.own_node);
    if (object.instance != kNoIndex) return s.scene.remove_instance(object.instance);
    return {};
}

Result<void> World::State::set_transform(ObjectHandle handle, const Transform& transform, std::uint64_t item) {
    if (auto known = check(handle, item); !known) return known;
    const world::Object& object = table.objects[handle.index];
    if (object.own_node == kNoIndex)
        return fail(ErrorCode::invalid_argument, item,
                    object.instance == kNoIndex ? "world: the object is a bound: set_bound moves it"
                                                : "world: the object has its node's transform: move the node, or add "
                                                  "the object with a transform");
    return set_local(object.own_node, transform, item);
}

Result<void> World::set_transform(ObjectHandle object, const Transform& transform) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return state_->set_transform(object, transform, object.index);
}

Result<void> World::set_transforms(Strided<ObjectHandle> objects, Strided<Transform> transforms) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return for_each_pair(objects, transforms, [&](ObjectHandle object, const Transform& transform, std::size_t i) {
        return state_->set_transform(object, transform, i);
    });
}

Result<void> World::State::set_bound(ObjectHandle object, const Bound& bound, std::uint64_t item) {
    if (auto known = check(object, item); !known) return known;
    if (table.objects[object.index].instance != kNoIndex)
        return fail(ErrorCode::invalid_argument, item, "world: the object has no bound: set_transform moves it");
    if (auto valid = validate(bound, item); !valid) return valid;
    if (stage_box_of_mover(object.index, bound.kind, bound.box, bound.radius)) return {};
    StagedChange& change = stage(object.index);
    change.has_bound = true;
    change.bound = bound;
    movers.forget(object.index);  // until the update, boxes go among the changes too
    return {};
}

// The short way, without an entry among the changes. False where it does not lead: the box is staged nowhere then.
bool World::State::stage_box_of_mover(std::uint32_t id, BoundKind kind, const Obb& box, double radius) {
    const world::Object& object = table.objects[id];
    if (object.kind != kind || object.radius != radius) return false;
    if (object_shapes.has(id)) {
        Bound bound(box);
        bound.kind = kind;
        bound.radius = radius;
        if (object_shapes.is_grown(id) || !object_shapes.fits(id, bound)) return false;
    }
    if (object.staged != kNoIndex && staged[object.staged].has_bound) return false;
    return index.stage_box(id, box);
}

Result<void> World::set_bound(ObjectHandle object, const Bound& bound) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    return state_->set_bound(object, bound, object.index);
}

Result<void> World::set_bounds(Strided<ObjectHandle> objects, Strided<Obb> boxes) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (objects.size() != boxes.size()) return fail_sizes();
    State& s = *state_;
    constexpr std::size_t kAtOnce = 128;  // are checked, and then found in the cache
    Result<void> first;
    for (std::size_t begin = 0; begin < boxes.size(); begin += kAtOnce) {
        const std::size_t end = std::min(begin + kAtOnce, boxes.size());
        std::uint32_t entries[kAtOnce];
        const std::size_t movers = s.movers.list_entries(objects, boxes, begin, end, entries);
        const std::size_t staged = s.index.stage_movers({entries, movers}, &boxes[begin], boxes.stride());
        for (std::size_t i = begin + staged; i < end; ++i) {
            auto set = s.set_bound(objects[i], boxes[i], i);
            if (!set && first) first = std::move(set);
        }
    }
    return first;
}

Result<void> World::set_mesh(ObjectHandle object, MeshHandle mesh) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    if (auto known = s.check(object, object.index); !known) return known;
    if (auto known = s.check(mesh, mesh.index); !known) return known;
    const std::uint32_t instance = s.table.objects[object.index].instance;
    if (instance == kNoIndex)
        return fail(ErrorCode::invalid_argument, object.index, "world: the object is a bound and takes no mesh");
    if (s.is_shape_alone(s.table.objects[object.index]))
        return fail(ErrorCode::invalid_argument, object.index, "world: the object was added without a mesh");
    s.stage(object.index);
    return s.scene.set_instance_mesh(instance, mesh.index);
}

Result<void> World::set_shape(ObjectHandle object, const convex::Shape* shape) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    State& s = *state_;
    if (auto known = s.check(object, object.index); !known) return known;
    const std::uint32_t id = object.index, instance = s.table.objects[id].instance;
    if (shape == nullptr && s.is_shape_alone(s.table.objects[id]))
        return fail(ErrorCode::invalid_argument, id,
                    "world: the object has nothing besides its shape: remove the object, or set another shape");
    if (shape != nullptr && instance != kNoIndex) {
        const glm::dmat3 linear = s.world_to_be(s.scene.node_of(instance)).linear;
        if (auto scales = world::ObjectShapes::check(*shape, linear, id); !scales) return scales;
    }
    s.mesh_shapes += shape != nullptr && instance != kNoIndex ? 1 : 0;
    s.object_shapes.set(id, shape);
    s.shape_contacts.note(id);
    s.movers.forget(id);  // until the update
    s.pair_changes.objects.push_back(id);
    if (shape != nullptr && instance != kNoIndex && s.index.has_box(id))
        (void)s.object_shapes.scale(id, s.scene.world(s.scene.node_of(instance)).linear);  // told by the next update
    return {};
}

Result<void> World::set_hidden(ObjectHandle object, bool hidden) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (world::is_region_index(object.index)) return state_->regions.set_hidden(object, hidden);
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.objects.edit(object.index).shown = !hidden;
    state_->stage(object.index);
    return {};
}

Result<void> World::set_layers(ObjectHandle object, std::uint32_t layers) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(object, object.index); !known) return known;
    world::Object& changed = state_->table.objects.edit(object.index);
    if (changed.instance != kNoIndex) return state_->scene.set_instance_layers(changed.instance, layers);
    changed.layers = layers;
    state_->stage(object.index);
    return {};
}

Result<void> World::set_collides_with(ObjectHandle object, std::uint32_t layers) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.objects.edit(object.index).collides_with = layers;
    state_->pair_changes.objects.push_back(object.index);
    return {};
}

Result<void> World::set_user(ObjectHandle object, std::uint64_t user) {
    if (auto outside = state_->check_outside(); !outside) return outside.error();
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.users.set(object.index, user);
    state_->pair_changes.objects.push_back(object.index);
    state_->pair_changes.renamed = true;
    return {};
}

}  // namespace crofton
