// SPDX-License-Identifier: MIT
// Uniform random lines through a region: no place and no direction is preferred (theory.md section 6). The directions'
// signs are uniform too unless a function says otherwise.
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/box.hpp>
#include <crofton/geometry/mesh.hpp>
#include <crofton/geometry/shapes.hpp>
#include <crofton/sampling/random.hpp>
#include <cstdint>
#include <glm/vec3.hpp>

namespace crofton::sampling {

// The motion-invariant measure of the lines, without direction, that meet a convex body of this surface area: π·area/2.
// Of N uniform lines through a convex body A, N·F_B/F_A are expected to meet a convex B inside it. They are expected to
// cross a surface of area S inside it 2·N·S/F_A times: N·S/(2πR²) for a sphere.
[[nodiscard]] double measure_of_lines(double surface_area);

// (a) Through two independent uniform points of the sphere; starts at one and points to the other.
[[nodiscard]] Line line_through_two_sphere_points(const Sphere& ball, const std::array<double, 4>& u);

// (b) A uniform direction through a uniform point of the orthogonal disc through the centre.
[[nodiscard]] Line line_through_disc(const Sphere& ball, const std::array<double, 4>& u);

// (c) A bundle of parallel lines: a uniform direction, and a square grid of cell area Δ in the plane orthogonal to it,
// turned and shifted at random. Each cell has one line, uniform in it. Appends those that meet the ball, πR²/Δ on
// average. A surface of area S inside the ball is expected to be crossed S/(2Δ) times by a bundle.
// Requires cell_area > 0 and at most 2^31 cells across the ball's projection.
void append_line_bundle(const Sphere& ball, double cell_area, Random& random, Vector<Line>& lines);

// (d) From a uniform point of a box's surface inward, cosine-weighted. Starts on the surface.
// Requires a box of at least two positive extents.
[[nodiscard]] Line line_from_box(const Aabb& box, const std::array<double, 5>& u);
[[nodiscard]] Line line_from_box(const Obb& box, const std::array<double, 5>& u);

// (d) for a convex polytope, given by a closed triangle mesh, counter-clockwise from outside. The tighter the body, the
// fewer lines miss what is inside it. Convexity is not checked.
class LinesFromHull {
  public:
    // Errors: as validate(TriangleMesh); empty, or no area at all.
    [[nodiscard]] static Result<LinesFromHull> make(const TriangleMesh& hull);
    [[nodiscard]] Line operator()(const std::array<double, 5>& u) const;
    [[nodiscard]] double area() const { return cumulative_area_.back(); }

  private:
    struct Face {
        glm::dvec3 corner, first_edge, second_edge, inward_normal;
    };
    Vector<Face> faces_;
    Vector<double> cumulative_area_;
};

}  // namespace crofton::sampling
