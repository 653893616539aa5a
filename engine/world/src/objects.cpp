// Objects: adding, changing, removing.
#include <cmath>
#include <string>

#include "world_state.hpp"

namespace crofton {
namespace {

Result<void> validate(const Bound& bound, std::uint64_t item) {
    if (bound.kind == BoundKind::none)
        return fail(ErrorCode::invalid_argument, item, "world: an object needs a mesh or a bound");
    if (bound.kind == BoundKind::ball && !(bound.radius >= 0.0))
        return fail(std::isnan(bound.radius) ? ErrorCode::non_finite : ErrorCode::invalid_argument, item,
                    "ball: the radius is negative or NaN");
    return crofton::validate(bound.box, item);
}

}  // namespace

Bound::Bound(const Aabb& aligned) : kind(BoundKind::aligned_box), box(obb_of(aligned)) {}

Bound::Bound(const Sphere& ball) : kind(BoundKind::ball), radius(ball.radius) {
    box.center = ball.center;
    // A little more than the float's rounding.
    box.half_extents = glm::vec3(static_cast<float>(ball.radius * (1.0 + 0x1p-22)));
}

Result<void> World::State::check(ObjectHandle object, std::uint64_t item) const {
    if (table.contains(object)) return {};
    if (object.index >= table.objects.size())
        return fail(ErrorCode::stale_handle, item, "world: the handle names no object of this world");
    return fail(ErrorCode::stale_handle, item,
                "world: object " + std::to_string(object.index) + " of generation " +
                    std::to_string(object.generation) + " has been removed");
}

StagedChange& World::State::stage(std::uint32_t object) {
    std::uint32_t& entry = table.objects[object].staged;
    if (entry == kNoIndex) {
        entry = static_cast<std::uint32_t>(staged.size());
        staged.emplace_back();
        staged.back().object = object;
    }
    return staged[entry];
}

Result<ObjectHandle> World::add(const ObjectDescription& description) {
    State& s = *state_;
    if (auto valid = validate(description.bound, kNoItem); !valid) return tl::unexpected(valid.error());
    const auto item = s.index.add(description.layers);
    if (!item) return tl::unexpected(item.error());
    world::Object object;
    object.layers = description.layers;
    object.collides_with = description.collides_with;
    s.table.add(*item, object, description.user);
    StagedChange& change = s.stage(*item);
    change.has_bound = true;
    change.bound = description.bound;
    return s.table.handle(*item);
}

Result<void> World::remove(ObjectHandle object) {
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.remove(object.index);
    state_->removed.push_back(object.index);
    return {};
}

Result<void> World::State::set_bound(ObjectHandle object, const Bound& bound, std::uint64_t item) {
    if (auto known = check(object, item); !known) return known;
    if (auto valid = validate(bound, item); !valid) return valid;
    StagedChange& change = stage(object.index);
    change.has_bound = true;
    change.bound = bound;
    return {};
}

Result<void> World::set_bound(ObjectHandle object, const Bound& bound) {
    return state_->set_bound(object, bound, object.index);
}

Result<void> World::set_bounds(Strided<ObjectHandle> objects, Strided<Obb> boxes) {
    if (objects.size() != boxes.size())
        return fail(ErrorCode::invalid_argument, kNoItem, "world: as many boxes as objects are needed");
    Result<void> first;
    for (std::size_t i = 0; i < objects.size(); ++i)
        if (auto set = state_->set_bound(objects[i], boxes[i], i); !set && first) first = std::move(set);
    return first;
}

Result<void> World::set_hidden(ObjectHandle object, bool hidden) {
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.objects[object.index].shown = !hidden;
    state_->stage(object.index);
    return {};
}

Result<void> World::set_layers(ObjectHandle object, std::uint32_t layers) {
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.objects[object.index].layers = layers;
    state_->stage(object.index);
    return {};
}

Result<void> World::set_collides_with(ObjectHandle object, std::uint32_t layers) {
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.objects[object.index].collides_with = layers;
    state_->pairs_changed = true;
    return {};
}

Result<void> World::set_user(ObjectHandle object, std::uint64_t user) {
    if (auto known = state_->check(object, object.index); !known) return known;
    state_->table.names.users[object.index] = user;
    state_->pairs_changed = true;
    return {};
}

}  // namespace crofton
