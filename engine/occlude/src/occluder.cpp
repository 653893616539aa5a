// SPDX-License-Identifier: MIT
#include <cmath>
#include <crofton/occlude/occluder.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <utility>

#include "occluder_storage.hpp"

namespace crofton::occlude {
namespace {

Result<Occluder> occluder_of(const Obb& box, std::uint64_t item) {
    if (auto valid = validate(box, item); !valid) return tl::unexpected(valid.error());
    for (int k = 0; k < 3; ++k)
        if (box.half_extents[k] == 0.0f)
            return fail(ErrorCode::degenerate, item, "occluder: the box is flat; give a polygon to add_surface");
    Occluder occluder;
    occluder.box = box;
    return occluder;
}

Result<Occluder> occluder_of(ShapeId shape, const scene::Transform& transform, std::uint64_t item) {
    if (auto valid = scene::validate(transform, item); !valid) return tl::unexpected(valid.error());
    const double determinant = glm::determinant(transform.linear);
    if (!(determinant != 0.0))
        return fail(ErrorCode::degenerate, item, "occluder: the transform flattens it; choose another scale");
    Occluder occluder;
    occluder.shape = shape;
    occluder.transform = transform;
    occluder.mirrored = determinant < 0.0;
    return occluder;
}

}  // namespace

OccluderSet::OccluderSet() : data_(std::make_unique<Data>()) {}
OccluderSet::~OccluderSet() = default;
OccluderSet::OccluderSet(OccluderSet&&) noexcept = default;
OccluderSet& OccluderSet::operator=(OccluderSet&&) noexcept = default;

namespace {

Result<ShapeId> append(Vector<Shape>& shapes, Result<Shape> shape) {
    if (!shape) return tl::unexpected(std::move(shape.error()));
    shapes.push_back(std::move(*shape));
    return static_cast<ShapeId>(shapes.size() - 1);
}

Result<OccluderId> append(Vector<Occluder>& occluders, Result<Occluder> occluder) {
    if (!occluder) return tl::unexpected(std::move(occluder.error()));
    occluders.push_back(*occluder);
    return static_cast<OccluderId>(occluders.size() - 1);
}

Result<void> replace(Vector<Occluder>& occluders, OccluderId id, Result<Occluder> occluder) {
    if (!occluder) return tl::unexpected(std::move(occluder.error()));
    occluder->enabled = occluders[id].enabled;
    occluders[id] = *occluder;
    return {};
}

Result<void> check(const Vector<Occluder>& occluders, OccluderId id) {
    if (id >= occluders.size())
        return fail(ErrorCode::out_of_range, id, "occluder: " + std::to_string(id) + " is not in the set");
    return {};
}

}  // namespace

Result<ShapeId> OccluderSet::add_convex(std::span<const glm::vec3> points) {
    return append(data_->shapes, convex_shape(points));
}
Result<ShapeId> OccluderSet::add_mesh(const TriangleMesh& mesh) {
    return append(data_->shapes, closed_shape(mesh));
}
Result<ShapeId> OccluderSet::add_surface(const TriangleMesh& surface, Sides sides) {
    return append(data_->shapes, surface_shape(surface, sides));
}

Result<OccluderId> OccluderSet::place(const Obb& box) {
    return append(data_->occluders, occluder_of(box, data_->occluders.size()));
}
Result<OccluderId> OccluderSet::place(ShapeId shape, const scene::Transform& transform) {
    if (shape >= data_->shapes.size())
        return fail(ErrorCode::out_of_range, shape, "occluder: there is no shape " + std::to_string(shape));
    return append(data_->occluders, occluder_of(shape, transform, data_->occluders.size()));
}

Result<void> OccluderSet::move(OccluderId occluder, const Obb& box) {
    if (auto valid = check(data_->occluders, occluder); !valid) return valid;
    if (data_->occluders[occluder].shape != kNone)
        return fail(ErrorCode::invalid_argument, occluder, "occluder: it has a shape; give a transform");
    return replace(data_->occluders, occluder, occluder_of(box, occluder));
}
Result<void> OccluderSet::move(OccluderId occluder, const scene::Transform& transform) {
    if (auto valid = check(data_->occluders, occluder); !valid) return valid;
    const ShapeId shape = data_->occluders[occluder].shape;
    if (shape == kNone) return fail(ErrorCode::invalid_argument, occluder, "occluder: it is a box; give a box");
    return replace(data_->occluders, occluder, occluder_of(shape, transform, occluder));
}
Result<void> OccluderSet::set_enabled(OccluderId occluder, bool enabled) {
    if (auto valid = check(data_->occluders, occluder); !valid) return valid;
    data_->occluders[occluder].enabled = enabled;
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
}

}  // namespace crofton::occlude
