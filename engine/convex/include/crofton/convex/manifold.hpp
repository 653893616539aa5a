// SPDX-License-Identifier: MIT
// Where two convex bodies touch: points a physics step can hold on to from frame to frame.
#pragma once
#include <compare>
#include <crofton/convex/query.hpp>

namespace crofton::convex {

// A vertex, edge or face of a body. Of hulls the indices are the hull's. Of boxes: a vertex is a corner number; edge 4k
// + j runs along axis k; face 2k + s is across axis k, on the + side for s = 1. Of a triangle: edge k leads from corner
// k to the next, the face is 0. Of capsules: the ends are vertices 0 and 1, the side is edge 0. Of cylinders and cones:
// face 0 is the lower disc, 1 the upper; a disc's rim is edges 0 to 7 (lower) and 8 to 15, an eighth of a turn each,
// its vertices alike; 16 is the edge of the side, and its ends are vertices 16 (lower) and 17. Half-spaces: face 0.
enum class FeatureKind : std::uint8_t { vertex, edge, face };
struct Feature {
    FeatureKind kind;
    std::uint16_t index;
    auto operator<=>(const Feature&) const = default;
};

struct ContactPoint {
    glm::dvec3 position{0.0};  // midway between the surfaces, in the world
    double depth = 0.0;        // along the normal; negative: a gap
    Feature on_a{}, on_b{};    // the same for as long as the same features touch: the point's id
};

struct Manifold {
    glm::dvec3 normal{0.0};  // unit, from a to b
    double depth = 0.0;      // of the deepest point
    int count = 0;           // 0 when the bodies are farther apart than the margin
    ContactPoint points[8];
};

struct ManifoldOptions {
    double margin = 0.0;  // ≥ 0: points with a gap of up to this are told, too, with negative depth
    int max_points = 4;   // in [1, 8]: the deepest, and those that keep most of the area
};

// The normal is that of `penetration` or `distance`, and the manifold as deep. The faces that look along it are clipped
// against each other (Sutherland, Hodgman); the deepest point is among the points. Bodies that meet, as `intersects`
// tells, have one point at least. With a cache the face of the frame before stays the contact's while its normal is
// proven to be the least deep within 1e-4 of the pair's size; normal and depth are then those of that face.
// Points are off by 1e-9 of the pair's size, by 1e-5 where a hull's face is not quite flat (HullOptions).
[[nodiscard]] Manifold contact_manifold(const Placed& a, const Placed& b, const ManifoldOptions& options = {},
                                        PairCache* cache = nullptr);

}  // namespace crofton::convex
