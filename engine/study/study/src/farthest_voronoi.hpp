// SPDX-License-Identifier: MIT
// The farthest-point Voronoi diagram of a convex polygon's corners, edge by edge.
#pragma once
#include <crofton/core/memory.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace crofton::study {

// Centres of circles through corners p and q that contain all corners: middle + t·normal for t in [begin, end], radius
// √(half² + t²), with `half` half the distance of p and q. An end may be infinite.
struct VoronoiEdge {
    glm::dvec2 middle{0.0};
    glm::dvec2 normal{0.0};
    double half = 0.0;
    double begin = 0.0;
    double end = 0.0;
};

// `corners` strictly convex and counter-clockwise, at least two. 2n − 3 edges, in O(n log n) (Skyum, "A simple
// algorithm for computing the smallest enclosing circle", 1991). Rounding may misplace the ends of edges where four
// corners are concyclic up to rounding; every circle an edge names then misses a corner by rounding at most.
[[nodiscard]] Vector<VoronoiEdge> farthest_voronoi(std::span<const glm::dvec2> corners);

}  // namespace crofton::study
