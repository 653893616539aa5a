// SPDX-License-Identifier: MIT
// Decides in exact arithmetic whether two polytopes overlap, and which of their corners are nearest.
#pragma once
#include "simplex.hpp"

namespace crofton::convex {

struct ExactNearest {
    bool meet = false;
    Simplex simplex;         // of the nearest point; weights within 1e-14, `nearest` 0 if they meet
    glm::dvec3 normal{0.0};  // along the shortest way from a to b, within 1e-14; 0 if they meet
};

// The algorithm of Gilbert, Johnson and Keerthi on numbers without rounding. Each round the nearest point comes
// strictly nearer, so that no simplex comes twice and the last one is right. Starts from the corners of `start`. With
// `nearest` false it stops as soon as a plane parts the shapes. Both cores are polytopes.
[[nodiscard]] ExactNearest exact_nearest(const Pair& pair, const Simplex& start, bool nearest);

// The side of the polytope's core on which the half-space's boundary is: whether they meet, exactly.
[[nodiscard]] bool meets_half_space(const ShapeAtPose& polytope, const ShapeAtPose& half_space);

// n = u × v exactly, then rounded and scaled to length about 1; for edges a_i a_j and b_k b_l of the two shapes.
[[nodiscard]] glm::dvec3 exact_edge_normal(const Pair& pair, int i, int j, int k, int l);

}  // namespace crofton::convex
