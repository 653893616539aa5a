// SPDX-License-Identifier: MIT
// The bound by which an instance is culled: what `crofton frames --bounds` chooses between.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/scene/scene.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace crofton::pipeline {

enum class BoundsKind : std::uint8_t { sphere, aabb, obb_volume, obb_area, obb_perimeter, obb_frustum };

[[nodiscard]] Result<BoundsKind> bounds_kind_from(const std::string& name);  // "sphere", "aabb", "obb-volume", …
[[nodiscard]] const char* to_string(BoundsKind kind);

// The criterion by which the scene fits its boxes for this kind; `camera` is the frustum in use. Errors: for
// obb_frustum, a camera whose frustum has no finite measures.
[[nodiscard]] Result<measure::Criterion> criterion_for(BoundsKind kind, const Camera& camera);

// The bound of every instance in world coordinates, kept up to date. For boxes of the scene's own kind these are the
// scene's world boxes; AABBs and spheres are taken around the mesh's vertices, so that no kind is handicapped by
// another's gaps. Where those would leave the range of coordinates the scene's boxes stand in their place.
class Bounds {
  public:
    Bounds(const scene::Scene& scene, BoundsKind kind);

    [[nodiscard]] BoundsKind kind() const { return kind_; }
    // By instance. For spheres: the boxes around them, which a tree can hold; spheres() then decides.
    [[nodiscard]] std::span<const Obb> boxes() const;
    [[nodiscard]] std::span<const Sphere> spheres() const { return spheres_; }  // empty for other kinds

    // After scene.update(): recomputes the bounds of scene.moved_instances().
    void update();

  private:
    void recompute(scene::InstanceId instance);

    const scene::Scene& scene_;
    BoundsKind kind_;
    std::vector<Sphere> mesh_spheres_;  // in each mesh's own frame
    std::vector<Sphere> spheres_;
    std::vector<Obb> boxes_;
};

}  // namespace crofton::pipeline
