// SPDX-License-Identifier: MIT
// The shapes of objects: their poses, and the boxes that contain them.
#pragma once
#include <crofton/convex/query.hpp>
#include <crofton/scene/scene.hpp>
#include <memory>
#include <optional>

#include "object_table.hpp"
#include "scaled_shape.hpp"
#include "spatial_index.hpp"

namespace crofton::world {

// A shape as its object's transform scales it, and where it stands; without a pose it overlaps nothing.
struct PlacedShape {
    std::optional<convex::Shape> own;
    std::unique_ptr<ScaledShape> scaled;
    std::optional<RigidTransform> pose;

    [[nodiscard]] const convex::Shape& shape() const { return scaled ? scaled->shape() : *own; }
};

class ObjectShapes {
  public:
    void set(std::uint32_t object, const convex::Shape* shape);  // nullptr: none
    void forget(std::uint32_t object);                           // it is gone, or another
    // Takes out an object's shape, without its pose. The object has none then. Requires that it has one.
    [[nodiscard]] PlacedShape take(std::uint32_t object);

    [[nodiscard]] bool has(std::uint32_t object) const { return is_known(object) && entries_[object]->own; }
    // As its object's transform scales it.
    [[nodiscard]] const convex::Shape& shape(std::uint32_t object) const {
        const Entry& entry = *entries_[object];
        return entry.scaled ? entry.scaled->shape() : *entry.own;
    }
    // As it was set.
    [[nodiscard]] const convex::Shape& own_shape(std::uint32_t object) const { return *entries_[object]->own; }
    // Where it stands as of the last update. `box` is the object's.
    [[nodiscard]] std::optional<RigidTransform> pose_of(std::uint32_t id, const Object& object, const Obb& box,
                                                        const scene::Scene& scene) const;
    [[nodiscard]] std::size_t count() const { return count_; }
    // Objects whose shapes have no bounds: they are in no box, and every query asks them.
    [[nodiscard]] std::span<const std::uint32_t> unbounded() const { return unbounded_; }
    [[nodiscard]] bool is_unbounded(std::uint32_t object) const { return has(object) && !shape(object).is_bounded(); }

    // Whether the object's box is larger than the bound that it was given.
    [[nodiscard]] bool is_grown(std::uint32_t object) const {
        return is_known(object) && entries_[object]->given.kind != BoundKind::none;
    }
    [[nodiscard]] const Bound& given(std::uint32_t object) const { return entries_[object]->given; }
    // A box in the shape's frame covers the shape if it has these half extents, at least; −1: any does.
    [[nodiscard]] glm::vec3 least_half_extents(std::uint32_t object) const;
    // Whether an object with this bound covers its shape with it. Quick; false where that is not sure.
    [[nodiscard]] bool fits(std::uint32_t object, const Bound& bound) const;

    // Objects whose shapes were set, or taken away, since the last update.
    [[nodiscard]] std::span<const std::uint32_t> fresh() const { return fresh_; }
    void forget_fresh() { fresh_.clear(); }

    // Scales the shape as the object's transform does now. Error: it does not; then the shape stands nowhere.
    Result<void> scale(std::uint32_t object, const glm::dmat3& linear);
    // Whether an object may have the transform.
    [[nodiscard]] static Result<void> check(const convex::Shape& shape, const glm::dmat3& linear, std::uint64_t item);

    // The bound, or the box that covers it and the shape; what was given is kept while that is larger.
    [[nodiscard]] Bound cover(std::uint32_t object, const Bound& bound);
    // Of an object with a mesh: its box in the scene, or one that covers the shape as well. `alone`: one around the
    // shape only, if it has bounds.
    [[nodiscard]] Obb cover(std::uint32_t object, scene::InstanceId instance, const scene::Scene& scene, bool alone);
    // The object's box, or a larger one that covers what is within `margin` of the shape.
    [[nodiscard]] Obb collider_box(std::uint32_t id, const Object& object, const Obb& box, const scene::Scene& scene,
                                   double margin) const;

  private:
    struct Entry {
        std::optional<convex::Shape> own;
        std::unique_ptr<ScaledShape> scaled;  // none: the transform is rigid
        SplitMap map;                         // of the scaled shape
        bool nowhere = false;                 // the transform does not scale the shape
        Bound given;                          // where it is not the object's box
        // Of a mesh: the box in its frame around it and the shape, made for this revision; is it more than the mesh's?
        Obb around_mesh;
        std::uint64_t mesh_revision = 0;
        bool exceeds_mesh = false;
    };
    void list_unbounded(std::uint32_t object);
    [[nodiscard]] bool is_known(std::uint32_t object) const { return object < entries_.size() && entries_[object]; }

    Vector<Owner<Entry>> entries_;  // by object; none, unless the object has or had a shape
    std::size_t count_ = 0;         // shapes
    Vector<std::uint32_t> unbounded_, fresh_;
};

// Half extents in float that are at least these, grown by `rounding`.
[[nodiscard]] glm::vec3 rounded_up(const glm::dvec3& half, double rounding);
// A bound's frame, as a rotation.
[[nodiscard]] RigidTransform frame_of(BoundKind kind, const Obb& box);
// Around the shape, in its frame.
[[nodiscard]] Obb box_around(const convex::Shape& shape, const RigidTransform& pose);
// Around the box, and what is within `margin` of the shape's bounds.
[[nodiscard]] Obb box_around(const Obb& box, const convex::Shape& shape, const RigidTransform& pose, double margin);
// The same where the box contains the shape. A box that is hardly larger than the shape is widened by the margin.
[[nodiscard]] Obb box_with_margin(const Obb& box, const convex::Shape& shape, const RigidTransform& pose,
                                  double margin);

}  // namespace crofton::world
