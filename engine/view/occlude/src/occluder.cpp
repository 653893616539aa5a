// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/occlude/occluder.hpp>
#include <string>
#include <utility>

#include "exact_turn.hpp"
#include "occluder_storage.hpp"

namespace crofton::occlude {
namespace {

Result<Occluder> occluder_of(const Obb& box, std::uint64_t item) {
    if (auto valid = validate(box, item); !valid) return valid.error();
    for (int k = 0; k < 3; ++k)
        if (box.half_extents[k] == 0.0f)
            return fail(ErrorCode::degenerate, item, "occluder: the box is flat; give a polygon as a surface");
    Occluder occluder;
    occluder.box = box;
    return occluder;
}

Result<Occluder> occluder_of(ShapeId shape, const Transform& transform, std::uint64_t item) {
    if (auto valid = validate(transform, item); !valid) return valid.error();
    const int turn = sign_of_determinant(transform.linear);
    if (turn == 0)
        return fail(ErrorCode::degenerate, item, "occluder: the transform flattens it; choose another scale");
    Occluder occluder;
    occluder.shape = shape;
    occluder.transform = transform;
    occluder.mirrored = turn < 0;
    return occluder;
}

}  // namespace

OccluderSet::OccluderSet() : data_(Owner<Data>::make()) {}
OccluderSet::~OccluderSet() = default;
OccluderSet::OccluderSet(OccluderSet&&) noexcept = default;
OccluderSet& OccluderSet::operator=(OccluderSet&&) noexcept = default;

Result<ShapeId> OccluderSet::Data::add(Result<Shape> shape) {
    if (!shape) return std::move(shape.error());
    if (!free_shapes.empty()) {
        const ShapeId id = free_shapes.back();
        free_shapes.pop_back();
        shapes[id] = std::move(*shape);
        shape_uses[id] = 0;
        return id;
    }
    shapes.push_back(std::move(*shape));
    shape_uses.push_back(0);
    return static_cast<ShapeId>(shapes.size() - 1);
}

Result<OccluderId> OccluderSet::Data::add(Result<Occluder> occluder) {
    if (!occluder) return std::move(occluder.error());
    if (occluder->shape != kNone) ++shape_uses[occluder->shape];
    if (first_free != kNone) {
        const OccluderId id = first_free;
        first_free = occluders[id].next_free;
        occluders[id] = *occluder;
        return id;
    }
    occluders.push_back(*occluder);
    return static_cast<OccluderId>(occluders.size() - 1);
}

Result<void> OccluderSet::Data::replace(OccluderId id, Result<Occluder> occluder) {
    if (!occluder) return std::move(occluder.error());
    occluder->enabled = occluders[id].enabled;
    occluders[id] = *occluder;
    return {};
}

Result<void> OccluderSet::Data::check(OccluderId id) const {
    if (id >= occluders.size() || occluders[id].removed)
        return fail(ErrorCode::out_of_range, id, {"occluder: ", id, " is not in the set"});
    return {};
}

Result<void> OccluderSet::Data::check_shape(ShapeId id) const {
    if (id >= shapes.size() || shape_uses[id] == kNone)
        return fail(ErrorCode::out_of_range, id, {"occluder: there is no shape ", id});
    return {};
}

// Returns the id of the next occluder, for error messages.
std::uint64_t OccluderSet::Data::next_id() const {
    return first_free == kNone ? occluders.size() : first_free;
}

Result<ShapeId> OccluderSet::add_convex(std::span<const glm::vec3> points) {
    return data_->add(convex_shape(points));
}
Result<ShapeId> OccluderSet::add_mesh(const TriangleMesh& mesh) {
    return data_->add(closed_shape(mesh));
}
Result<ShapeId> OccluderSet::add_surface(const TriangleMesh& surface, Sides sides) {
    return data_->add(surface_shape(surface, sides));
}

Result<OccluderId> OccluderSet::place(const Obb& box) {
    return data_->add(occluder_of(box, data_->next_id()));
}
Result<OccluderId> OccluderSet::place(ShapeId shape, const Transform& transform) {
    if (auto known = data_->check_shape(shape); !known) return known.error();
    return data_->add(occluder_of(shape, transform, data_->next_id()));
}

Result<void> OccluderSet::move(OccluderId occluder, const Obb& box) {
    if (auto valid = data_->check(occluder); !valid) return valid;
    if (data_->occluders[occluder].shape != kNone)
        return fail(ErrorCode::invalid_argument, occluder, "occluder: it has a shape; give a transform");
    return data_->replace(occluder, occluder_of(box, occluder));
}
Result<void> OccluderSet::move(OccluderId occluder, const Transform& transform) {
    if (auto valid = data_->check(occluder); !valid) return valid;
    const ShapeId shape = data_->occluders[occluder].shape;
    if (shape == kNone) return fail(ErrorCode::invalid_argument, occluder, "occluder: it is a box; give a box");
    return data_->replace(occluder, occluder_of(shape, transform, occluder));
}
Result<void> OccluderSet::set_enabled(OccluderId occluder, bool enabled) {
    if (auto valid = data_->check(occluder); !valid) return valid;
    data_->occluders[occluder].enabled = enabled;
    return {};
}

Result<void> OccluderSet::remove(OccluderId occluder) {
    if (auto valid = data_->check(occluder); !valid) return valid;
    Occluder& removed = data_->occluders[occluder];
    if (removed.shape != kNone) --data_->shape_uses[removed.shape];
    removed = {};
    removed.removed = true;
    removed.enabled = false;
    removed.next_free = data_->first_free;
    data_->first_free = occluder;
    return {};
}

Result<void> OccluderSet::remove_shape(ShapeId shape) {
    if (auto known = data_->check_shape(shape); !known) return known;
    if (data_->shape_uses[shape] != 0)
        return fail(ErrorCode::invalid_argument, shape, "occluder: occluders have this shape; remove them first");
    data_->shapes[shape] = {};
    data_->shape_uses[shape] = kNone;
    data_->free_shapes.push_back(shape);
    return {};
}

std::size_t OccluderSet::size() const {
    return data_->occluders.size();
}
std::size_t OccluderSet::shape_count() const {
    return data_->shapes.size();
}
void OccluderSet::clear() {
    data_->occluders.clear();
    data_->shapes.clear();
    data_->shape_uses.clear();
    data_->free_shapes.clear();
    data_->first_free = kNone;
}

}  // namespace crofton::occlude
