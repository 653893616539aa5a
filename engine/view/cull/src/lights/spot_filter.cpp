// SPDX-License-Identifier: MIT
// The distance of two convex bodies by their support points (Gilbert, Johnson, Keerthi 1988). Let A be the set of all
// differences of a point of the froxel and one of the light. A plane that all of A is beyond, seen from the origin, by
// more than η proves that they are apart. A tetrahedron of A that contains the sphere of radius η around the origin
// proves that they meet.
#include "lights/spot_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <crofton/geometry/closest_points.hpp>
#include <crofton/geometry/orthonormal_frame.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace crofton::cull {
namespace {

constexpr int kMostRounds = 48;

// The point of the froxel farthest along m, relative to the apex.
glm::dvec3 froxel_support(const FroxelCell& cell, const glm::dvec3& apex, const glm::dvec3& m) {
    glm::dvec3 best(0.0);
    double farthest = -std::numeric_limits<double>::infinity();
    for (const double w : {cell.low, cell.high}) {
        glm::dvec3 corner;
        for (int axis = 0; axis < 2; ++axis) {
            const int side = m[axis] > 0.0;
            corner[axis] = cell.slope[axis][side] * w + cell.start[axis][side] - apex[axis];
        }
        corner.z = w - apex.z;
        if (const double at = glm::dot(corner, m); at > farthest) {
            farthest = at;
            best = corner;
        }
    }
    return best;
}

// A light's support points. What of a direction is across the axis is taken along two fixed directions. Where there is
// little, taking away what is along the axis would leave nothing but rounding.
class SpotSupport {
  public:
    explicit SpotSupport(const KernelLight& spot)
        : spot_(spot), axis_(spot.axis[0], spot.axis[1], spot.axis[2]), across_(orthonormal_frame(axis_)) {}

    [[nodiscard]] const glm::dvec3& axis() const { return axis_; }

    // The point of the light farthest along m, relative to the apex.
    [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& m) const {
        const double along = glm::dot(m, axis_), p = glm::dot(m, across_[0]), q = glm::dot(m, across_[1]);
        const double across = std::sqrt(p * p + q * q);
        if (across * spot_.cosine <= along * spot_.sine) return spot_.radius / std::max(glm::length(m), 1e-300) * m;
        if (along * spot_.cosine + across * spot_.sine <= 0.0) return glm::dvec3(0.0);
        const glm::dvec3 side = p * across_[0] + q * across_[1];
        return spot_.radius * (spot_.cosine * axis_ + spot_.sine / std::max(across, 1e-300) * side);
    }

  private:
    const KernelLight& spot_;
    glm::dvec3 axis_;
    std::array<glm::dvec3, 2> across_;
};

double largest_of(const glm::dvec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

// How deep within the tetrahedron the origin lies, or less; negative outside, and where that is not certain. Let E and
// F be the largest components of two edges, and u = 2^-53. A component of their normal is off by 8 u E F: four
// roundings of two products. So its product with a point p is off by less than 3 · 8 u E F |p| and, by its own sums, 3
// u · 6 E F |p|. That is 42 u E F |p|, of which 64 u are taken. The normal's length is off by 14 u E F. In a thin
// tetrahedron it is much less than E F, and none of this small.
double depth_of_origin(const glm::dvec3 (&points)[4], double eta) {
    double depth = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 &a = points[(i + 1) % 4], &b = points[(i + 2) % 4], &c = points[(i + 3) % 4];
        const glm::dvec3 normal = glm::cross(b - a, c - a), up = points[i] - a;
        const double length = glm::length(normal), side = glm::dot(normal, up);
        const double error = 0x1p-47 * largest_of(b - a) * largest_of(c - a);
        if (!(std::fabs(side) > error * largest_of(up))) return -1.0;
        const double towards = side > 0.0 ? -glm::dot(normal, a) : glm::dot(normal, a);
        depth = std::min(depth, (towards - error * (largest_of(a) + eta)) / length);
    }
    return depth;
}

}  // namespace

Answer filter_spot(const KernelLight& spot, const FroxelCell& cell, double eta) {
    const glm::dvec3 apex(spot.at[0], spot.at[1], spot.at[2]);
    const SpotSupport farthest_of_spot(spot);
    const auto support = [&](const glm::dvec3& m) {  // of A, towards −m
        return froxel_support(cell, apex, -m) - farthest_of_spot(m);
    };
    const glm::dvec3 first = support(-farthest_of_spot.axis());
    glm::dvec3 points[4] = {first, first, first, first}, nearest = first;
    for (int round = 0; round < kMostRounds; ++round) {
        const double square = glm::dot(nearest, nearest);
        if (!(square > 0.0)) return Answer::unknown;
        points[3] = support(nearest);
        const double bound = glm::dot(nearest, points[3]), length = std::sqrt(square);
        if (bound > eta * length) return Answer::no;
        if (depth_of_origin(points, eta) > eta) return Answer::yes;
        // The nearest point of the new faces; the origin lies behind the old one or in it.
        Triangle best{points[0], points[1], points[2]};
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; ++i) {
            const Triangle face{points[i], points[(i + 1) % 3], points[3]};
            const glm::dvec3 at = closest_on_triangle(glm::dvec3(0.0), face);
            if (const double distance = glm::dot(at, at); distance < least) {
                least = distance;
                nearest = at;
                best = face;
            }
        }
        std::copy_n(best.begin(), 3, points);
    }
    return Answer::unknown;
}

}  // namespace crofton::cull
