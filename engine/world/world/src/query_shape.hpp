// SPDX-License-Identifier: MIT
// The shapes of queries, and the shapes of objects that they are tested against.
#pragma once
#include <algorithm>
#include <crofton/collide/bound_contacts.hpp>
#include <crofton/collide/narrow_phase.hpp>
#include <crofton/convex/query.hpp>
#include <crofton/world/answers.hpp>
#include <optional>

namespace crofton::world {

// A shape and its pose. Without a pose it overlaps nothing.
struct QueryShape {
    convex::Shape shape;
    std::optional<RigidTransform> pose;

    // Requires a pose.
    [[nodiscard]] convex::ShapeAtPose placed() const { return {shape, *pose}; }
};

// A box whose axes are off by more than poses may be is replaced by the smallest box around it along the nearest
// orthonormal axes.
[[nodiscard]] QueryShape shape_of(const Obb& box);
[[nodiscard]] QueryShape shape_of(const Sphere& sphere);
[[nodiscard]] QueryShape shape_of(const collide::Capsule& capsule);

// Returns which triangle a part of the shape is; kNoTriangle for convex ones.
[[nodiscard]] std::uint32_t triangle_of(const convex::Shape& shape, const convex::PartId& part);

// From a probe to an object.
struct Gap {
    collide::Distance distance;
    std::uint32_t triangle = kNoTriangle, child = 0;  // of the object
};

inline void sort_by_object(Vector<ObjectRef>& found) {
    std::sort(found.begin(), found.end(),
              [](const ObjectRef& a, const ObjectRef& b) { return a.object.index < b.object.index; });
}

}  // namespace crofton::world
