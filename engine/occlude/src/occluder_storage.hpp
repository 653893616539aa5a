// SPDX-License-Identifier: MIT
// What an OccluderSet holds, for those that draw it.
#pragma once
#include <crofton/occlude/occluder.hpp>

#include "shape.hpp"

namespace crofton::occlude {

struct Occluder {
    ShapeId shape = kNone;  // kNone: the box
    bool enabled = true;
    bool mirrored = false;  // the transform is a reflection
    Obb box;
    scene::Transform transform;
};

struct OccluderSet::Data {
    Vector<Shape> shapes;
    Vector<Occluder> occluders;
};

struct OccluderStorage {
    [[nodiscard]] static std::span<const Shape> shapes(const OccluderSet& set) { return set.data_->shapes; }
    [[nodiscard]] static std::span<const Occluder> occluders(const OccluderSet& set) { return set.data_->occluders; }
};

}  // namespace crofton::occlude
