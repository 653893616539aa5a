// SPDX-License-Identifier: MIT
// A body under a transform that is not rigid.
#pragma once
#include <crofton/convex/body.hpp>
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

// The image of a body, in a frame that turns with the map, with what the body is a view of. Numbers are rounded to
// float where bodies have floats. Any convex body, field or compound may be scaled uniformly. What has vertices and no
// rounding takes any map: triangles, hulls, meshes; a box becomes a hull where its sides do not stay orthogonal.
// Cylinders and cones may be scaled along their axes and across, fields along their axes.
class ScaledBody {
  public:
    // Errors: a kind that has no image of its kind under the map (unsupported); numbers out of range. Their item is
    // `item`.
    [[nodiscard]] static Result<std::unique_ptr<ScaledBody>> make(const convex::Body& body, const SplitMap& map,
                                                                  std::uint64_t item);

    [[nodiscard]] const convex::Body& body() const { return *body_; }

  private:
    [[nodiscard]] Result<void> make_points(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> make_round(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> make_mesh(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> make_field(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> make_compound(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> make(const convex::Body& body, const SplitMap& map);
    [[nodiscard]] Result<void> take(Result<convex::Body> made);

    std::optional<convex::Body> body_;
    std::unique_ptr<convex::Hull> hull_;
    std::unique_ptr<mesh::MeshTree> mesh_;
    std::unique_ptr<convex::HeightField> field_;
    std::unique_ptr<convex::Compound> compound_;
    Vector<std::unique_ptr<ScaledBody>> children_;
};

}  // namespace crofton::world
