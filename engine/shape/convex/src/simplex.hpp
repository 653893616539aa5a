// SPDX-License-Identifier: MIT
// At most four corners of the difference body, and the point of their hull that is nearest to the origin.
#pragma once
#include <algorithm>

#include "pair.hpp"

namespace crofton::convex {

struct Simplex {
    Corner corner[4];
    double weight[4];
    int count = 0;
    bool inside = false;      // the origin seems to lie within the tetrahedron
    glm::dvec3 nearest{0.0};  // Σ weight · w, of a triangle by its normal: a better direction where it is small
    Simplex() = default;
    Simplex(const Simplex& other) { *this = other; }
    Simplex& operator=(const Simplex& other) {  // what is in use alone
        std::copy(other.corner, other.corner + other.count, corner);
        std::copy(other.weight, other.weight + other.count, weight);
        count = other.count;
        inside = other.inside;
        nearest = other.nearest;
        return *this;
    }
    void add(const Corner& next) { corner[count++] = next; }
};

// Σ weight · w: a point of the hull, up to rounding of the corners, whatever the weights.
[[nodiscard]] inline glm::dvec3 witness(const Simplex& s) {
    glm::dvec3 sum(0.0);
    for (int i = 0; i < s.count; ++i) sum += s.weight[i] * s.corner[i].w;
    return sum;
}

// Keeps the corners whose face holds the nearest point, with their weights. Faces are tried one by one, with no case
// distinctions that rounding could lead astray: those with the last corner alone, unless `all`.
void reduce(Simplex& simplex, bool all);

// A determinant of three corners is off by less than this. The corners are off by 11u of the size, which gives 34u ·
// size · longest², where `longest` is the length of the longest. The roundings are below 16u · longest³, and no corner
// is longer than the size.
[[nodiscard]] inline double determinant_error(double size, double longest_squared) {
    return 0x1p-47 * size * longest_squared;
}

// Whether the origin certainly lies strictly within the tetrahedron.
[[nodiscard]] bool certainly_inside(const Simplex& simplex, double size);

}  // namespace crofton::convex
