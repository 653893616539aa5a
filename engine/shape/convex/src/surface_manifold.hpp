// SPDX-License-Identifier: MIT
// Contacts of a convex shape with the triangles of a surface.
#pragma once
#include <optional>

#include "edge_rule.hpp"
#include "gather.hpp"
#include "manifold_list.hpp"

namespace crofton::convex {

// Where a triangle pushes a shape. By the rule: along the least deep direction, unless the rule for inner edges forbids
// it; then along its face what lies above it. To one side: a triangle of two sides does so as if it had only the side
// on which the shape's middle is of the surface. Always: what merely meets it, too, is pushed
// along its face.
enum class Push : std::uint8_t { by_rule, to_one_side, always };

// One surface and one convex shape, asked triangle by triangle.
class SurfaceContacts {
  public:
    SurfaceContacts(const NearSurface& surface, const ShapeAtPose& shape, double margin);

    // The contact points of one triangle, along `normal`, from the triangle to the shape. No points where it does not
    // touch. `left_out`: the two meet, and the rule for inner edges leaves no point.
    struct Contact {
        glm::dvec3 normal;
        GatheredPoints points;
        bool left_out;
        double depth;  // how deep the two are along the normal, which no point exceeds; infinite where that is unknown
    };
    // Push::to_one_side: where the rule has found the sides of the shape's middle.
    void ask(const NearTriangle& triangle, std::uint32_t index, EdgeRule& rule, Push push, Contact& contact) const;

    // Of the shape, in the surface's frame.
    [[nodiscard]] glm::dvec3 middle() const { return Pair::local(surface_.pose.rotation, middle_); }
    // Far more than what rounding and searches leave open of distances.
    [[nodiscard]] double doubt() const { return 1e-6 * size_; }

  private:
    // How the two touch along the least deep direction; false: they do not. Points that come with it go to `contact`.
    enum class Found : std::uint8_t { nothing, touch, points };
    void find_points(const NearTriangle& triangle, std::uint32_t index, EdgeRule& rule, Push push,
                     Contact& contact) const;
    [[nodiscard]] Found find(const PlacedTriangle& t, const Shape& triangle, Touch& touch, Contact& contact) const;
    [[nodiscard]] Found find_on_half_space(const Shape& triangle, Contact& contact) const;
    void gather_patches_along(const PlacedTriangle& t, Gatherer& gatherer, const glm::dvec3& normal, Patch& on_triangle,
                              Patch& on_shape) const;
    void gather(const PlacedTriangle& t, const Shape* triangle, Touch& touch, Contact& contact) const;
    void gather_along_face(const PlacedTriangle& t, bool front, Contact& contact) const;
    void add_deepest_above(const NearTriangle& near, const PlacedTriangle& t, bool front, Contact& contact) const;

    const NearSurface& surface_;
    const ShapeAtPose& shape_;
    Gathering gathering_;
    double size_;
    glm::dvec3 middle_;
    std::optional<BoxTouch> box_;
    std::optional<SegmentTouch> segment_;
};

}  // namespace crofton::convex
