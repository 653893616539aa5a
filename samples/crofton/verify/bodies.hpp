// SPDX-License-Identifier: MIT
// Convex bodies for the claims' random trials: slow and plain tests of what meets what, independent of the engine's.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include <crofton/geometry/box.hpp>
#include <crofton/measure/measure.hpp>
#include <crofton/sampling/sampling.hpp>

namespace crofton::cli {

// The hull of `corners`; `faces` are convex polygons of corner numbers, `normals` and `edges` the directions that can
// separate (both may be empty for segments and flat bodies), `radius` grows it (for spheres: one corner).
struct Body {
    std::vector<glm::dvec3> corners;
    std::vector<std::vector<std::uint32_t>> faces;
    std::vector<glm::dvec3> normals;
    std::vector<glm::dvec3> edges;
    double radius = 0.0;
};

[[nodiscard]] Body box_body(const glm::dvec3& half_extents);  // around the origin
[[nodiscard]] Body sphere_body(double radius);
[[nodiscard]] Body segment_body(double length);
[[nodiscard]] Body flat_body(std::vector<glm::dvec3> corners);  // a convex polygon
// Half-tangents and depths: eye at the origin, looking along −z. Orthographic: `tan_x`, `tan_y` are half extents.
[[nodiscard]] Body frustum_body(double tan_x, double tan_y, double near, double far, bool perspective);
[[nodiscard]] measure::IntrinsicVolumes frustum_volumes(double tan_x, double tan_y, double near, double far,
                                                        bool perspective);  // of the same
[[nodiscard]] Body moved(const Body& body, const RigidTransform& motion);
[[nodiscard]] double radius_about_center(const Body& body);  // of a sphere around center_of(body)
[[nodiscard]] glm::dvec3 center_of(const Body& body);

// All motions of `moving` that can hit `fixed`: the middle of the fixed one's sphere lies in the moving one's own box,
// grown by that sphere's radius. The measure of an event is its share of uniform trials × measure().
class Placements {
  public:
    Placements(const Body& moving, const Body& fixed);
    [[nodiscard]] RigidTransform motion(const std::array<double, 6>& u) const;
    [[nodiscard]] double measure() const;

  private:
    Aabb range_;
    glm::dvec3 middle_;
};

// By separating axes; a sphere by its distance. At most one of them may be a sphere.
[[nodiscard]] bool meet(const Body& a, const Body& b);
// True iff every corner of `inner` lies behind all faces of `outer`.
[[nodiscard]] bool holds(const Body& outer, const Body& inner);

// The same in the plane, for convex polygons (counter-clockwise) and segments (two points).
using Figure = std::vector<glm::dvec2>;
[[nodiscard]] inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}
[[nodiscard]] bool meet(const Figure& a, const Figure& b);
[[nodiscard]] bool holds(const Figure& outer, const Figure& inner);
[[nodiscard]] Figure moved(const Figure& figure, const sampling::PlanarMotion& motion);

// The mean of independent numbers, with its standard error.
class Mean {
  public:
    void add(double x) {
        ++count_;
        const double d = x - mean_;
        mean_ += d / static_cast<double>(count_);
        squares_ += d * (x - mean_);
    }
    [[nodiscard]] double value() const { return mean_; }
    [[nodiscard]] double standard_error() const {
        const double n = static_cast<double>(count_);
        return count_ < 2 ? std::nan("") : std::sqrt(squares_ / (n * (n - 1.0)));
    }

  private:
    std::uint64_t count_ = 0;
    double mean_ = 0.0, squares_ = 0.0;
};

// Uniform motions of a large query, only those whose boundary passes near the origin, each with the weight that makes
// the mean of weight · [event] the measure of the event, for events that need the boundary within `radius` of the
// origin: a uniform point of the boundary is put on a uniform point of that sphere (disc), and the weight is sphere ·
// boundary / boundary inside the sphere.
struct Anchored {
    Body body;
    double weight = 0.0;
};
[[nodiscard]] Anchored anchored(const Body& query, double radius, const std::array<double, 8>& u);
struct AnchoredFigure {
    Figure figure;
    double weight = 0.0;
};
[[nodiscard]] AnchoredFigure anchored(const Figure& query, double radius, const std::array<double, 4>& u);

}  // namespace crofton::cli
