// SPDX-License-Identifier: MIT
// The direction, depth and place in which two shapes touch. Manifolds start from it.
#pragma once
#include "clip.hpp"
#include "simplex.hpp"

namespace crofton::convex {

struct Touch {
    glm::dvec3 normal{0.0};           // unit, from a to b
    double depth = 0.0;               // with roundings; negative: a gap
    glm::dvec3 on_a{0.0}, on_b{0.0};  // deepest points of the cores, around a's origin
    bool known = false;               // the features below; else `simplex` tells
    Feature feature_a{}, feature_b{};
    int vertices_a[4], vertices_b[4], vertex_count = 0;  // of polytopes, whose hull holds the deepest points
};

// False if the shapes are farther apart than `margin`.
[[nodiscard]] bool find_touch(const Pair& pair, double margin, PairCache* cache, Touch& touch);

enum class Warm : std::uint8_t { unknown, apart, touching };

// The touch at the face that the cache names, if that is proven to be the least deep within `kept` of the size, or the
// shapes to be farther apart than the margin. Then `clipped` holds the patches' common part. kKeptDepth is for a face
// that stays; kSameDepth for one that is a guess.
inline constexpr double kKeptDepth = 1e-4, kSameDepth = 1e-12;
[[nodiscard]] Warm touch_at_face(const ShapeAtPose& a, const ShapeAtPose& b, const Pair& pair, double margin,
                                 const PairCache& cache, double kept, Touch& touch, Clipped& clipped);

}  // namespace crofton::convex
