// SPDX-License-Identifier: MIT
// The triangles of surfaces near a shape, and the internal-edge rule for their contacts.
#pragma once
#include <span>

#include "triangle_touch.hpp"

namespace crofton::convex {

// A mesh or a height field, alone or within a compound.
struct NearSurface {
    RigidTransform pose;
    const Shape* shape;  // the mesh or the field
    std::uint32_t child;
};
struct NearTriangle {
    Triangle corners;
    std::uint32_t triangle, surface;  // indices: of the surface's triangle, of the list of surfaces
};

// The rule: a contact's normal belongs to the surface iff no triangle around the vertices on which it stands rises
// above them. Triangles near the shape that share a vertex are found by a hash of its place, made when first asked for.
// A neighbor need not be near the shape: where a shape dips into a triangle beside one of its edges, the way out may
// lead across the edge, though the shape ends before it. So if no listed neighbor rises, and the point of touch is not
// within what was searched, the surface is asked for all of them.
class EdgeRule {
  public:
    // For these triangles, all that touch the box around the shape's core, grown by its radius. Both stay unchanged
    // until the next call.
    void start(std::span<const NearTriangle> triangles, const ShapeAtPose& shape);
    // Whether a triangle that shares the vertices of `index` that are farthest along the normal rises above them. The
    // point of touch lies on the triangle, around the surface's origin.
    [[nodiscard]] bool points_into_neighbor(std::uint32_t index, const NearSurface& surface, const glm::dvec3& normal,
                                            const glm::dvec3& touch);
    // Whether the triangle's nearest point to the center of a ball is surely at an edge or a vertex, along a direction
    // by which the rule leaves the triangle out. All are in the surface's frame, which is rigid to 1e-6. Takes a
    // quarter of the time that it takes to find the touch and to ask the rule.
    struct Ball {
        glm::dvec3 center;
        double radius, doubt;  // distances that are within `doubt` of 0 or of the radius tell nothing
    };
    [[nodiscard]] bool surely_leaves_out(std::uint32_t index, const Ball& ball);
    // Finds the side of a surface on which a point lies, of triangles that are one surface. Of those that are connected
    // over edges the nearest one tells.
    void find_sides(std::uint32_t begin, std::uint32_t end, const glm::dvec3& point);
    // 1: the point lies where the triangle's front is, -1: where its back is, 0: the triangle has no neighbors.
    [[nodiscard]] int side(std::uint32_t index) const { return side_[index]; }

  private:
    void list_corners();
    [[nodiscard]] bool is_within_search(const glm::dvec3& point) const;
    void find_side_of_piece(std::uint32_t first, const glm::dvec3& point);
    void add_neighbors_to_piece(std::uint32_t index);
    [[nodiscard]] std::size_t slot_of(const glm::dvec3& vertex) const;

    std::span<const NearTriangle> triangles_;
    const ShapeAtPose* shape_ = nullptr;
    bool listed_ = false;
    Vector<std::uint32_t> first_, next_;  // chains of corners: triangle · 3 + corner
    Vector<std::int8_t> side_;            // by triangle
    Vector<std::uint32_t> piece_;         // triangles that are connected
};

// A direction is across an edge, and a neighbour not above a vertex, up to this sine.
inline constexpr double kFlatSine = 1e-3;

}  // namespace crofton::convex
