// SPDX-License-Identifier: MIT
// A shape under a transform that is not rigid.
#pragma once
#include <crofton/convex/shape.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/mesh/mesh_tree.hpp>
#include <glm/mat3x3.hpp>
#include <memory>
#include <optional>

namespace crofton::world {

// A linear map as rotation · rest. Where the images of the axes are orthogonal within 1e-6, `rest` is diagonal but for
// that, and `sides` are its diagonal; a map that mirrors has a negative first side.
struct SplitMap {
    glm::dmat3 rotation{1.0}, rest{1.0};
    glm::dvec3 sides{1.0};
    bool orthogonal = true;
    bool uniform = true;  // the sides agree within 1e-5
};
[[nodiscard]] SplitMap split(const glm::dmat3& linear);

// Whether the map is a uniform scale and a rotation, within 1e-6; 0 is none.
[[nodiscard]] bool is_similarity(const glm::dmat3& linear);

// The image of a shape, in a frame that turns with the map, with what the shape is a view of. Numbers are rounded to
// float where shapes have floats. Any convex shape, field or compound may be scaled uniformly. What has vertices and no
// rounding takes any map: triangles, hulls, meshes; a box becomes a hull where its sides do not stay orthogonal.
// Cylinders and cones may be scaled along their axes and across, fields along their axes.
class ScaledShape {
  public:
    // Errors: a kind that has no image of its kind under the map (unsupported); numbers out of range. Their item is
    // `item`.
    [[nodiscard]] static Result<std::unique_ptr<ScaledShape>> make(const convex::Shape& shape, const SplitMap& map,
                                                                   std::uint64_t item);

    [[nodiscard]] const convex::Shape& shape() const { return *shape_; }

  private:
    [[nodiscard]] Result<void> make_points(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> make_round(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> make_mesh(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> make_field(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> make_compound(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> make(const convex::Shape& shape, const SplitMap& map);
    [[nodiscard]] Result<void> take(Result<convex::Shape> made);

    std::optional<convex::Shape> shape_;
    std::unique_ptr<convex::Hull> hull_;
    std::unique_ptr<mesh::MeshTree> mesh_;
    std::unique_ptr<convex::HeightField> field_;
    std::unique_ptr<convex::Compound> compound_;
    Vector<std::unique_ptr<ScaledShape>> children_;
};

}  // namespace crofton::world
