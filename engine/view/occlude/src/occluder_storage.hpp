// SPDX-License-Identifier: MIT
// The data of an OccluderSet, for drawing it.
#pragma once
#include <crofton/core/paged_vector.hpp>
#include <crofton/occlude/occluder.hpp>

#include "shape.hpp"

namespace crofton::occlude {

struct Occluder {
    ShapeId shape = kNone;         // kNone: the box
    OccluderId next_free = kNone;  // of one that is removed
    bool enabled = true;
    bool removed = false;
    bool mirrored = false;  // the transform is a reflection
    Obb box;
    Transform transform;
};

struct OccluderSet::Data {
    using Occluders = PagedVector<Occluder, 256>;
    Vector<Shape> shapes;
    Vector<std::uint32_t> shape_uses;  // occluders of each shape; kNone: the shape is removed
    Occluders occluders;
    Vector<ShapeId> free_shapes;
    OccluderId first_free = kNone;

    Result<ShapeId> add(Result<Shape> shape);
    Result<OccluderId> add(Result<Occluder> occluder);
    Result<void> replace(OccluderId id, Result<Occluder> occluder);
    [[nodiscard]] Result<void> check(OccluderId id) const;
    [[nodiscard]] Result<void> check_shape(ShapeId id) const;
    [[nodiscard]] std::uint64_t next_id() const;
};

struct OccluderStorage {
    [[nodiscard]] static std::span<const Shape> shapes(const OccluderSet& set) { return set.data_->shapes; }
    [[nodiscard]] static const OccluderSet::Data::Occluders& occluders(const OccluderSet& set) {
        return set.data_->occluders;
    }
};

}  // namespace crofton::occlude
