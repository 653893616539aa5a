// Uniform random lines through a region: no point and no direction is preferred (theory.md section 6).
#pragma once
#include <array>
#include <crofton/core/memory.hpp>
#include <crofton/geometry/aabb.hpp>
#include <crofton/geometry/line.hpp>
#include <crofton/geometry/obb.hpp>
#include <crofton/geometry/sphere.hpp>
#include <crofton/geometry/triangle_mesh.hpp>
#include <crofton/sampling/random.hpp>
#include <cstdint>
#include <glm/vec3.hpp>

namespace crofton::sampling {

// The motion-invariant measure of the lines that meet a convex body of this surface area: π·area/2 (lines without
// direction). Of N uniform lines through a convex body A, the expected number through a convex B inside it is
// N·F_B/F_A, and of crossings with any surface of area S inside it 2·N·S/F_A: N·S/(2πR²) for the ball.
[[nodiscard]] double measure_of_lines(double surface_area);

// (a) Through two independent uniform points of the sphere; starts at one and points to the other.
[[nodiscard]] Line line_through_two_sphere_points(const Sphere& ball, const std::array<double, 4>& u);

// (b) A uniform direction through a uniform point of the orthogonal disc through the centre.
[[nodiscard]] Line line_through_disc(const Sphere& ball, const std::array<double, 4>& u);

// (c) A bundle of parallel lines: a uniform direction, one line in each cell of a square grid of cell area Δ in the
// plane orthogonal to it, uniform in its cell, the grid itself turned and shifted at random; appended to `lines` are
// those that meet the ball: πR²/Δ on average. A surface of area S inside the ball expects S/(2Δ) crossings per bundle.
// Requires cell_area > 0 and at most 2^31 cells across the ball's shadow.
void append_line_bundle(const Sphere& ball, double cell_area, Random& random, Vector<Line>& lines);

// (d) From a uniform point of a box's surface inward, cosine-weighted. Starts on the surface.
// Requires a box of at least two positive extents.
[[nodiscard]] Line line_from_box(const Aabb& box, const std::array<double, 5>& u);
[[nodiscard]] Line line_from_box(const Obb& box, const std::array<double, 5>& u);

// (d) for any convex polytope, as a closed triangle mesh seen counter-clockwise from outside: the tighter the body, the
// fewer lines miss what is inside it. Convexity is the caller's promise.
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
