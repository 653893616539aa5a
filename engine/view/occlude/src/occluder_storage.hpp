// SPDX-License-Identifier: MIT
// The data of an OccluderSet, for drawing it.
#pragma once
#include <crofton/occlude/occluder.hpp>

#include "shape.hpp"

namespace crofton::occlude {

struct Occluder {
    ShapeId shape = kNone;  // kNone: the box
    bool enabled = true;
    bool removed = false;
    bool mirrored = false;  // the transform is a reflection
    Obb box;
    Transform transform;
};

struct OccluderSet::Data {
    Vector<Shape> shapes;
    Vector<std::uint32_t> shape_uses;  // occluders of each shape; kNone: the shape is removed
    Vector<Occluder> occluders;
    Vector<ShapeId> free_shapes;
    Vector<OccluderId> free_occluders;

    Result<ShapeId> add(Result<Shape> shape);
    Result<OccluderId> add(Result<Occluder> occluder);
    Result<void> replace(OccluderId id, Result<Occluder> occluder);
    [[nodiscard]] Result<void> check(OccluderId id) const;
    [[nodiscard]] Result<void> check_shape(ShapeId id) const;
    [[nodiscard]] std::uint64_t next_id() const;
};

struct OccluderStorage {
    [[nodiscard]] static std::span<const Shape> shapes(const OccluderSet& set) { return set.data_->shapes; }
    [[nodiscard]] static std::span<const Occluder> occluders(const OccluderSet& set) { return set.data_->occluders; }
};

}  // namespace crofton::occlude
