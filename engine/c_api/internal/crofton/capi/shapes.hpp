// SPDX-License-Identifier: MIT
// Shapes, as the functions of several sources see them.
#pragma once
#include <crofton/capi/modules.h>

#include <crofton/convex/query.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <memory>
#include <optional>

#include <crofton/capi/call.hpp>
#include <crofton/capi/convert.hpp>
#include <crofton/capi/growing.hpp>

namespace crofton::capi {

// A shape with all that it is a view of. Whoever uses the shape shares it, so that handles may go in any order.
struct ShapeData {
    std::optional<convex::Shape> shape;
    std::optional<convex::Hull> hull;
    std::optional<mesh::MeshTree> mesh;
    std::optional<convex::HeightField> field;
    std::optional<convex::Compound> compound;
    Vector<std::shared_ptr<const ShapeData>> parts;  // that it is made of
};
using SharedShape = std::shared_ptr<const ShapeData>;

}  // namespace crofton::capi

struct crofton_shape {
    static constexpr std::uint32_t kKind = 0x43724f10;
    crofton::capi::Header header;
    crofton::capi::SharedShape data;
};

namespace crofton::capi {

static_assert(sizeof(crofton_tracked_point) == sizeof(convex::TrackedPoint) &&
              offsetof(crofton_tracked_point, normal) == offsetof(convex::TrackedPoint, normal) &&
              offsetof(crofton_tracked_point, began) == offsetof(convex::TrackedPoint, began) &&
              offsetof(crofton_tracked_point, memory) == offsetof(convex::TrackedPoint, memory));
static_assert(offsetof(crofton_tracked_point, depth) == offsetof(convex::ContactPoint, depth) &&
              offsetof(crofton_tracked_point, on_b) == offsetof(convex::ContactPoint, on_b) &&
              offsetof(crofton_tracked_point, part_a) == offsetof(convex::ContactPoint, part_a) &&
              offsetof(crofton_tracked_point, part_b) == offsetof(convex::ContactPoint, part_b) &&
              offsetof(crofton_feature, index) == offsetof(convex::Feature, index));
static_assert(sizeof(crofton_shape_point) == sizeof(convex::ContactPoint) &&
              offsetof(crofton_shape_point, depth) == offsetof(convex::ContactPoint, depth) &&
              offsetof(crofton_shape_point, on_b) == offsetof(convex::ContactPoint, on_b) &&
              offsetof(crofton_shape_point, part_b) == offsetof(convex::ContactPoint, part_b));
static_assert(sizeof(convex::PairCache) <= sizeof(crofton_pair_cache) &&
              alignof(convex::PairCache) <= alignof(crofton_pair_cache));
static_assert(sizeof(crofton_motion) == sizeof(convex::Motion) &&
              offsetof(crofton_motion, pivot) == offsetof(convex::Motion, pivot));

// A shape that may be asked, and where it stands, for the length of a call.
class PlacedShape {
  public:
    PlacedShape(const crofton_placed* placed, const char* function) : use_(placed ? placed->shape : nullptr, function) {
        status_ = use_.failed() ? use_.status() : set(*placed, function);
    }
    [[nodiscard]] crofton_status status() const { return status_; }
    [[nodiscard]] convex::ShapeAtPose placed() const { return {*shape_, pose_}; }
    [[nodiscard]] const convex::Shape& shape() const { return *shape_; }
    [[nodiscard]] const RigidTransform& pose() const { return pose_; }

  private:
    crofton_status set(const crofton_placed& placed, const char* function) {
        CROFTON_CHECK(check_pointer(placed.pose, function));
        const Transform given = to_transform(*placed.pose);
        pose_ = {given.linear, given.translation};
        shape_ = &*placed.shape->data->shape;
        return status_of(convex::validate_pose(pose_), function);
    }

    SharedUse use_;
    crofton_status status_;
    const convex::Shape* shape_ = nullptr;
    RigidTransform pose_;
};

// Two shapes that may be asked.
class PlacedPair {
  public:
    PlacedPair(const crofton_placed* a, const crofton_placed* b, const char* function)
        : first_(a, function), second_(b, function) {}
    // The first's, where both have failed.
    [[nodiscard]] crofton_status status() const {
        return first_.status() != CROFTON_OK ? first_.status() : second_.status();
    }
    [[nodiscard]] convex::ShapeAtPose first() const { return first_.placed(); }
    [[nodiscard]] convex::ShapeAtPose second() const { return second_.placed(); }

  private:
    PlacedShape first_, second_;
};

// Both may be null: a shape that rests, a time of 1.
[[nodiscard]] convex::Motion to_motion(const crofton_motion* motion);
[[nodiscard]] crofton_status to_manifold_options(const crofton_manifold_options* options, const char* function,
                                                 convex::ManifoldOptions& result);
[[nodiscard]] crofton_status to_cast_options(const crofton_cast_options* options, const char* function,
                                             convex::CastOptions& result);

}  // namespace crofton::capi
