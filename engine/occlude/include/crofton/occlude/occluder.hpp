// SPDX-License-Identifier: MIT
// What hides other things: boxes, convex bodies, surfaces and closed meshes, where they stand.
#pragma once
#include <crofton/core/error.hpp>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/scene/transform.hpp>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

namespace crofton::occlude {

using ShapeId = std::uint32_t;
using OccluderId = std::uint32_t;

// From where a surface hides what is behind it: from the side on which its triangles are counter-clockwise, as a
// renderer that culls back faces draws it; or from either.
enum class Sides : std::uint8_t { front, both };

// Shapes, each given once, and occluders: shapes in places. An occluder must lie within what is drawn, and must be
// opaque: then what it hides is hidden in the picture. Of a body its front counts alone, as far as it lies beyond the
// near plane: an eye inside of it sees through it. Const functions may run on any number of threads at once; the
// others need the set for themselves.
class OccluderSet {
  public:
    OccluderSet();
    ~OccluderSet();
    OccluderSet(OccluderSet&&) noexcept;
    OccluderSet& operator=(OccluderSet&&) noexcept;

    // Shapes, in their own coordinates. Errors leave the set as it was: non_finite and out_of_range (item: the point,
    // or what validate(TriangleMesh) says), degenerate (flat, or no triangle with an area), invalid_argument (open:
    // item is a triangle at the hole; inside out).

    // The convex hull of the points; flat sets are refused. Costs least to draw, beside boxes.
    [[nodiscard]] Result<ShapeId> add_convex(std::span<const glm::vec3> points);
    // A closed mesh: after equal positions are taken for one vertex, each edge has as many triangles that go along it
    // as such that go against it; its volume is positive. Any number of closed pieces.
    [[nodiscard]] Result<ShapeId> add_mesh(const TriangleMesh& mesh);
    // Any triangles, open or not, none of which need be in one plane: a polygon as triangulated, a terrain, a wall.
    // A T-junction is a gap to the rule for covered pixels: it costs a row of pixels there.
    [[nodiscard]] Result<ShapeId> add_surface(const TriangleMesh& surface, Sides sides);

    // Occluders. A box, as it is; errors: as validate(Obb), and degenerate for a half extent of 0.
    [[nodiscard]] Result<OccluderId> place(const Obb& box);
    // A shape in a place. Errors: as scene::validate; a shape that is not there; degenerate for a linear part of
    // determinant 0. A reflection turns no shape inside out.
    [[nodiscard]] Result<OccluderId> place(ShapeId shape, const scene::Transform& transform);
    // Moves an occluder. Errors as above leave it where it was; invalid_argument where it is of the other kind.
    [[nodiscard]] Result<void> move(OccluderId occluder, const Obb& box);
    [[nodiscard]] Result<void> move(OccluderId occluder, const scene::Transform& transform);
    // An occluder that is off hides nothing. All are on at first.
    [[nodiscard]] Result<void> set_enabled(OccluderId occluder, bool enabled);

    // Ids of what is removed are given out again, latest first. Errors: not in the set (out_of_range); a shape that
    // occluders have (invalid_argument).
    [[nodiscard]] Result<void> remove(OccluderId occluder);
    [[nodiscard]] Result<void> remove_shape(ShapeId shape);

    [[nodiscard]] std::size_t size() const;         // ids are below it, removed ones included
    [[nodiscard]] std::size_t shape_count() const;  // likewise
    void clear();                                   // occluders and shapes; keeps the memory

  private:
    friend struct OccluderStorage;
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace crofton::occlude
